"""Teaching the network of the second look: by backpropagation, with Adam."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.studies.second_look.looks import LookExamples
from peopleboy.tracker.proposals.crops import NUMBERS, SCORES, Planes, planes_of
from peopleboy.tracker.proposals.placing import OFFSETS
from peopleboy.tracker.proposals.second_look import LAYERS, SCALES, UNITS, USUAL, SecondLook, patches, shapes

Weights = dict[str, Planes]

SOMEBODY: Final = 0.35
"""IoU from which on a proposal is somebody."""
NOBODY: Final = 0.2
"""IoU up to which it is nobody; what is between is neither."""

_BATCH: Final = 64
_RATE: Final = 1.5e-3
_WARM_UP: Final = 200  # batches
_DECAY: Final = 3e-4  # of kernels, in a batch
_LEFT_OUT: Final = 0.4  # of units, in each batch others (Srivastava et al., JMLR 2014)
_STILL: Final = 0.15  # of crops, whose motion is not shown
_PLACES: Final = 0.5  # weight of where people are, beside whether
_FAR: Final = 2.0  # units from which on it does not matter how much farther off a place is (Huber)
_TOLD: Final = 200  # batches
_LAST: Final = 0.1  # weights of the last layer, beside He's


def first_weights(rng: np.random.Generator) -> Weights:
    """Draw a network that knows nothing (He et al., ICCV 2015): it says what the first look does."""
    weights: Weights = {}
    for name, shape in shapes().items():
        drawn = rng.standard_normal(shape) * math.sqrt(2.0 / shape[0]) if len(shape) > 1 else np.zeros(shape)
        weights[name] = drawn.astype(np.float32)
    weights["last"] *= np.float32(_LAST)
    weights["line"] = np.array([1.0, 0.0], np.float32)
    return weights


@dataclass(slots=True, kw_only=True, eq=False)
class Momentum:
    """Steps of a size of their own for each weight (Adam; Kingma and Ba, ICLR 2015, algorithm 1).

    Attributes:
        mean: running means of slopes.
        square: and of their squares.
        steps: taken so far.
    """

    mean: Weights = field(default_factory=dict)
    square: Weights = field(default_factory=dict)
    steps: int = 0

    def step(self, weights: Weights, slopes: Weights, rate: float) -> None:
        """Change weights; those of kernels also shrink."""
        self.steps += 1
        grown = rate * math.sqrt(1.0 - 0.999**self.steps) / (1.0 - 0.9**self.steps)
        for name, slope in slopes.items():
            mean = self.mean.setdefault(name, np.zeros_like(slope))
            square = self.square.setdefault(name, np.zeros_like(slope))
            mean += np.float32(0.1) * (slope - mean)
            square += np.float32(0.001) * (slope * slope - square)
            weights[name] -= np.float32(grown) * mean / (np.sqrt(square) + np.float32(1e-8))
            if weights[name].ndim > 1:
                weights[name] *= np.float32(1.0 - _DECAY * rate / _RATE)


def teach_network(
    looks: LookExamples, rng: np.random.Generator, *, rounds: int, say: Callable[[str], None]
) -> SecondLook:
    """Teach a network on what was proposed: each is seen once a round, in half of the batches mirrored.

    Raises:
        BadInput: there is too little to learn from.
    """
    batches = rounds * (len(looks.overlap) // _BATCH)
    if not batches:
        raise BadInput(f"{len(looks.overlap)} proposals, at least {_BATCH} are needed; take more worlds")
    weights, momentum = first_weights(rng), Momentum()
    total = np.zeros(2)
    for number, batch in enumerate(_batches(looks, rng, rounds), 1):
        rate = _RATE * min(1.0, number / _WARM_UP) * 0.5 * (1.0 + math.cos(math.pi * number / batches))
        slopes, losses = slopes_of(weights, batch, _varied(batch, rng), _kept(rng))
        momentum.step(weights, slopes, rate)
        total += losses
        if number % _TOLD == 0:
            say(f"{number} of {batches} batches: loss {total[0] / _TOLD:.3f}, places {total[1] / _TOLD:.3f}")
            total[:] = 0.0
    return SecondLook(weights)


def _batches(looks: LookExamples, rng: np.random.Generator, rounds: int) -> Iterator[LookExamples]:
    for _ in range(rounds):
        order = rng.permutation(len(looks.overlap))
        for begin in range(0, len(order) - _BATCH + 1, _BATCH):
            batch = looks.take(np.sort(order[begin : begin + _BATCH]))
            yield batch.mirrored() if rng.random() < 0.5 else batch


def _varied(looks: LookExamples, rng: np.random.Generator) -> Planes:
    """Give crops (N, 64, 48, 3) as the network sees them, some without motion."""
    planes = planes_of(looks.crops)
    planes[rng.random(len(planes)) < _STILL, ..., 1] = 0.0
    return planes


def _kept(rng: np.random.Generator) -> Planes:
    """Draw the units that a batch learns by, (64, 96), as much larger as others are missing."""
    is_kept = rng.random((_BATCH, UNITS)) >= _LEFT_OUT
    return (is_kept / (1.0 - _LEFT_OUT)).astype(np.float32)


def slopes_of(
    weights: Weights, batch: LookExamples, planes: Planes, kept: Planes
) -> tuple[Weights, NDArray[np.float64]]:
    """Give the slopes of the loss by weight, and the losses: whether, and where.

    Args:
        weights: of the network.
        batch: what is learned from.
        planes: its crops (N, 64, 48, 3) as the network sees them.
        kept: (N, 96) by what units are multiplied.
    """
    here, seen, shown = planes, [], []
    for layer, (side, stride, _) in enumerate(LAYERS):
        seen.append(patches(here, side, stride))
        here = np.maximum(seen[-1] @ weights[f"kernel{layer}"] + weights[f"bias{layer}"], np.float32(0.0))
        shown.append(here)
    flat = np.concatenate([here.reshape(len(here), -1), batch.numbers], axis=1)
    units = kept * np.maximum(flat @ weights["all"] + weights["all_bias"], np.float32(0.0))
    last = units @ weights["last"] + weights["last_bias"]
    slope, losses = _loss(last, batch)
    slopes = {"last": units.T @ slope, "last_bias": slope.sum(axis=0)}
    back = (slope @ weights["last"].T) * kept * (units > 0.0)
    slopes |= {"all": flat.T @ back, "all_bias": back.sum(axis=0)}
    back = (back @ weights["all"].T)[:, : flat.shape[1] - NUMBERS].reshape(here.shape)
    for layer in reversed(range(len(LAYERS))):
        side, stride, depth = LAYERS[layer]
        back = (back * (shown[layer] > 0.0)).reshape(-1, depth)
        wide = seen[layer].shape[-1]
        slopes[f"kernel{layer}"] = seen[layer].reshape(-1, wide).T @ back
        slopes[f"bias{layer}"] = back.sum(axis=0)
        if layer:
            back = (back @ weights[f"kernel{layer}"].T).reshape(seen[layer].shape)
            back = _unpatched(back, side, stride, shown[layer - 1].shape)
    return slopes, losses


def _loss(last: Planes, batch: LookExamples) -> tuple[Planes, NDArray[np.float64]]:
    count = np.float32(len(last))
    odds = last[:, 0] + SCORES * batch.numbers[:, 0]
    is_person = batch.overlap >= SOMEBODY
    counts = (is_person | (batch.overlap < NOBODY)).astype(np.float32)
    share = 1.0 / (1.0 + np.exp(-odds))
    goal = ((batch.offsets - USUAL[1:]) / SCALES[1:]).astype(np.float32)
    off = (last[:, 1:] - goal) * is_person[:, None]
    bent = np.clip(off, -_FAR, _FAR)
    slope = np.concatenate(
        [((share - is_person) * counts)[:, None], np.float32(_PLACES / OFFSETS) * bent], axis=1
    )
    likely = np.logaddexp(0.0, np.where(is_person, -odds, odds))
    whether = (likely * counts).sum() / max(counts.sum(), 1.0)
    where = np.abs(off).sum() / max(is_person.sum(), 1) / OFFSETS
    return (slope / count).astype(np.float32), np.array([whether, where], np.float64)


def _unpatched(back: Planes, side: int, stride: int, shape: tuple[int, ...]) -> Planes:
    """Add up at (N, H, W, C) what came back to each place that a kernel sees: the reverse of `patches`."""
    count, high, wide, depth = shape
    edge, (rows, columns) = side // 2, back.shape[1:3]
    padded = np.zeros((count, high + 2 * edge, wide + 2 * edge, depth), np.float32)
    for i in range(side):
        for j in range(side):
            part = back[..., (i * side + j) * depth : (i * side + j + 1) * depth]
            padded[:, i : i + stride * rows : stride, j : j + stride * columns : stride] += part
    return padded[:, edge : edge + high, edge : edge + wide]
