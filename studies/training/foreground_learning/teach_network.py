"""Teaching the network by backpropagation, with Adam."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.panoramic.foreground.layers import DILATIONS
from peopleboy.tracker.panoramic.foreground.mask_network import INPUTS, OUTPUTS, MaskNetwork

Linear = NDArray[np.float32]
Weights = dict[str, Linear]

UNITS: Final = 24
_RARE: Final = -3.0  # evidence that the last layer begins with, since few pixels are people


def first_network(rows: int, rng: np.random.Generator) -> MaskNetwork:
    """Draw a network that knows nothing, for images of so many rows of squares (He's initial weights)."""
    layers = len(DILATIONS)

    def drawn(*shape: int, inputs: int) -> Linear:
        return (rng.standard_normal(shape) * math.sqrt(2.0 / inputs)).astype(np.float32)

    return MaskNetwork(
        first=drawn(INPUTS, UNITS, inputs=INPUTS),
        rows=np.zeros((rows, UNITS), np.float32),
        between=drawn(layers, 9, UNITS, UNITS, inputs=9 * UNITS) * np.float32(0.5),
        biases=np.zeros((layers, UNITS), np.float32),
        last=drawn(UNITS + INPUTS, OUTPUTS, inputs=UNITS + INPUTS) * np.float32(0.1),
        bias=np.full(OUTPUTS, _RARE, np.float32),
    )


@dataclass(slots=True, kw_only=True, eq=False)
class Adam:
    """A network that is being taught.

    Source: D. Kingma, J. Ba, Adam: a method for stochastic optimization, ICLR 2015, algorithm 1.

    Attributes:
        network: as it is now.
        first, second: running means of gradients and of their squares.
        steps: taken so far.
    """

    network: MaskNetwork
    first: Weights = field(default_factory=dict)
    second: Weights = field(default_factory=dict)
    steps: int = 0

    def step(self, squares: Linear, people: Linear, rate: float) -> float:
        """Learn from images (N, R, C, INPUTS) and masks (N, R, C, OUTPUTS) of 0 and 1; tell the loss."""
        loss, slopes = loss_and_slopes(self.network, squares, people)
        self.steps += 1
        weights: Weights = {name: getattr(self.network, name) for name in slopes}
        for name, slope in slopes.items():
            first = 0.9 * self.first.get(name, np.float32(0.0)) + 0.1 * slope
            second = 0.999 * self.second.get(name, np.float32(0.0)) + 0.001 * slope**2
            self.first[name], self.second[name] = first, second
            size = np.sqrt(second / (1.0 - 0.999**self.steps)) + 1e-8
            weights[name] = (weights[name] - rate / (1.0 - 0.9**self.steps) * first / size).astype(np.float32)
        self.network = MaskNetwork(**weights)
        return loss


def loss_and_slopes(network: MaskNetwork, squares: Linear, people: Linear) -> tuple[float, Weights]:
    """Tell the mean cross entropy [nat] over all pixels, and its gradient by all weights."""
    number = network.rows.shape[1]
    layer = np.maximum(squares @ network.first + network.rows[:, None], 0.0)
    layers, grown, seen = [layer], [], []
    for weights, bias, dilation in zip(network.between, network.biases, DILATIONS, strict=True):
        seen.append(_neighbours(layer, dilation))
        grown.append(np.maximum(seen[-1] @ weights.reshape(-1, number) + bias, 0.0))
        layer = layer + grown[-1]
        layers.append(layer)
    ends = np.concatenate([layer, squares], axis=-1)
    evidence = ends @ network.last + network.bias
    loss = float(np.mean(np.logaddexp(0.0, evidence) - people * evidence))
    blame = ((1.0 / (1.0 + np.exp(-evidence)) - people) / people.size).astype(np.float32)
    slopes = {"last": _products(ends, blame), "bias": blame.sum(axis=(0, 1, 2))}
    passed = blame @ network.last[:number].T
    between, biases = [], []
    for k in reversed(range(len(DILATIONS))):
        inner = passed * (grown[k] > 0.0)
        between.append(_products(seen[k], inner).reshape(9, number, number))
        biases.append(inner.sum(axis=(0, 1, 2)))
        passed = passed + _gathered(inner @ network.between[k].reshape(-1, number).T, DILATIONS[k])
    inner = passed * (layers[0] > 0.0)
    slopes |= {"between": np.stack(between[::-1]), "biases": np.stack(biases[::-1])}
    slopes |= {"first": _products(squares, inner), "rows": inner.sum(axis=(0, 2))}
    return loss, slopes


def _products(inputs: Linear, blame: Linear) -> Linear:
    return inputs.reshape(-1, inputs.shape[-1]).T @ blame.reshape(-1, blame.shape[-1])


def _neighbours(layer: Linear, dilation: int) -> Linear:
    """Put the nine squares that each one looks at beside each other: (N, R, C, 9 U)."""
    rows, columns = layer.shape[1:3]
    ring = np.pad(layer, ((0, 0), (0, 0), (dilation, dilation), (0, 0)), mode="wrap")
    padded = np.pad(ring, ((0, 0), (dilation, dilation), (0, 0), (0, 0)))
    return np.concatenate([padded[:, v : v + rows, u : u + columns] for v, u in _offsets(dilation)], axis=-1)


def _gathered(blame: Linear, dilation: int) -> Linear:
    """Pass blame (N, R, C, 9 U) back to the squares that were looked at: (N, R, C, U)."""
    images, rows, columns, inputs = blame.shape
    number = inputs // 9
    padded = np.zeros((images, rows + 2 * dilation, columns + 2 * dilation, number), np.float32)
    for k, (v, u) in enumerate(_offsets(dilation)):
        padded[:, v : v + rows, u : u + columns] += blame[..., k * number : (k + 1) * number]
    inner = padded[:, dilation:-dilation]
    inner[:, :, dilation : 2 * dilation] += inner[:, :, -dilation:]
    inner[:, :, -2 * dilation : -dilation] += inner[:, :, :dilation]
    return inner[:, :, dilation:-dilation]


def _offsets(dilation: int) -> list[tuple[int, int]]:
    return [(dilation * (k // 3), dilation * (k % 3)) for k in range(9)]
