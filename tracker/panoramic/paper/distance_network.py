"""The network that learns how far away a person is: three cues in, four hidden units, one distance out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput

Floats = NDArray[np.float64]

CUES: Final = 3
# Outputs that stand for the nearest and the farthest distance: a sigmoid never reaches 0 or 1.
_LOW, _HIGH = 0.1, 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class Lessons:
    """How the network is taught.

    The paper gives the hidden units and the rate, with which it did best. It gives neither how often the
    examples are gone through nor the first weights; ours are these.

    Attributes:
        hidden: units of the hidden layer.
        rate: by which each example's gradient changes the weights.
        epochs: how often all examples are gone through, each time in another order.
        first_weight: the first weights are drawn evenly between this and its negative.
    """

    hidden: int = 4
    rate: float = 0.3
    epochs: int = 2000
    first_weight: float = 0.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DistanceNetwork:
    """A trained network.

    Attributes:
        hidden: (units, 4) weights of the three scaled cues, and the bias.
        output: (units + 1,) weights of the hidden units, and the bias.
        cue_ranges: (3, 2) least and greatest of each cue [px] among the examples: 0 and 1 to the network.
        distance_range_m: nearest and farthest of the examples [m]: 0.1 and 0.9 to the network.
    """

    hidden: Floats
    output: Floats
    cue_ranges: Floats
    distance_range_m: tuple[float, float]

    def distance(self, cues: Floats) -> Floats:
        """Tell the distances (N,) [m] of people with these cues (N, 3) [px]."""
        units = _sigmoid(_with_bias(_scaled(cues, self.cue_ranges)) @ self.hidden.T)
        nearest, farthest = self.distance_range_m
        share = (_sigmoid(_with_bias(units) @ self.output) - _LOW) / (_HIGH - _LOW)
        return np.asarray(nearest + share * (farthest - nearest), np.float64)


def teach(
    cues: Floats, distances_m: Floats, rng: np.random.Generator, lessons: Lessons | None = None
) -> DistanceNetwork:
    """Teach a network online by backpropagation of the squared error.

    Args:
        cues: (N, 3) of the examples [px].
        distances_m: (N,) true distances [m].
        rng: draws the first weights and the order of the examples.
        lessons: how; as `Lessons` says if left out.

    Raises:
        BadInput: next to no examples, or all at one distance.

    Source: OMNIVIS 2003, section 4.4.
    """
    _check_examples(cues, distances_m)
    lessons = Lessons() if lessons is None else lessons
    ranges = np.stack([cues.min(axis=0), cues.max(axis=0)], axis=1)
    nearest, farthest = float(distances_m.min()), float(distances_m.max())
    inputs = _with_bias(_scaled(cues, ranges))
    targets = _LOW + (_HIGH - _LOW) * (distances_m - nearest) / (farthest - nearest)
    limit = lessons.first_weight
    hidden = rng.uniform(-limit, limit, (lessons.hidden, CUES + 1))
    output = rng.uniform(-limit, limit, lessons.hidden + 1)
    for _ in range(lessons.epochs):
        learn_in_order(inputs, targets, rng.permutation(len(inputs)), hidden, output, lessons.rate)
    return DistanceNetwork(
        hidden=hidden, output=output, cue_ranges=ranges, distance_range_m=(nearest, farthest)
    )


@njit(cache=True)
def learn_in_order(
    inputs: Floats,
    targets: Floats,
    order: NDArray[np.int64],
    hidden: Floats,
    output: Floats,
    rate: float,
) -> None:
    """Go once through the examples, and change the weights in place after each.

    Each change is the negative gradient of half the squared error, times the rate.
    """
    units = np.empty(len(hidden))
    for example in order:
        total = output[-1]
        for j in range(len(hidden)):
            units[j] = 1.0 / (1.0 + np.exp(-np.dot(hidden[j], inputs[example])))
            total += output[j] * units[j]
        reported = 1.0 / (1.0 + np.exp(-total))
        blame = (targets[example] - reported) * reported * (1.0 - reported)
        for j in range(len(hidden)):
            passed = blame * output[j] * units[j] * (1.0 - units[j])
            output[j] += rate * blame * units[j]
            hidden[j] += rate * passed * inputs[example]
        output[-1] += rate * blame


def _check_examples(cues: Floats, distances_m: Floats) -> None:
    if len(cues) < 10:
        raise BadInput(f"{len(cues)} examples of distances: at least 10 are needed; take more seeds")
    if np.ptp(distances_m) <= 0.0 or np.any(np.ptp(cues, axis=0) <= 0.0):
        raise BadInput("examples of distances: all are alike, so there is nothing to learn from them")


def _scaled(cues: Floats, ranges: Floats) -> Floats:
    return np.asarray((cues - ranges[:, 0]) / (ranges[:, 1] - ranges[:, 0]), np.float64)


def _with_bias(inputs: Floats) -> Floats:
    return np.hstack([inputs, np.ones((len(inputs), 1))])


def _sigmoid(x: Floats) -> Floats:
    return np.asarray(1.0 / (1.0 + np.exp(-x)), np.float64)
