"""Evolution strategy with recombination and cumulative step-size adaptation."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Weights = NDArray[np.float64]  # (N,)
Judge = Callable[[int, Sequence[Weights]], Sequence[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Generation:
    """Result of a generation.

    Attributes:
        number: from 0 on.
        mean: (N,) mean of the next generation, the current best estimate.
        spread: standard deviation of the next generation's weights.
        scores: scores of this generation's members, in the order of drawing.
    """

    number: int
    mean: Weights
    spread: float
    scores: tuple[float, ...]


def evolve(
    start: Weights, spread: float, judge: Judge, rng: np.random.Generator, *, members: int, generations: int
) -> Iterator[Generation]:
    """Maximise a score by recombining the better half of each generation, weighted by rank.

    Source: N. Hansen, The CMA Evolution Strategy: A Tutorial, 2016, equations 39, 40, 43, 44 and 49 with the
    covariance left at identity, for which a few hundred scores are too few.

    Args:
        start: (N,) initial mean.
        spread: standard deviation of the first generation's weights.
        judge: function that returns the scores of a generation's members, given the generation's number; all
            members should be evaluated under the same conditions.
        rng: draws members.
        members: number of members per generation.
        generations: number of generations.
    """
    size, mean = len(start), start.copy()
    ranks = math.log((members + 1) / 2.0) - np.log(np.arange(1, members // 2 + 1))
    shares = ranks / ranks.sum()
    effective = 1.0 / float((shares**2).sum())
    memory = (effective + 2.0) / (size + effective + 5.0)
    damping = 1.0 + 2.0 * max(0.0, math.sqrt((effective - 1.0) / (size + 1.0)) - 1.0) + memory
    usual = math.sqrt(size) * (1.0 - 1.0 / (4.0 * size) + 1.0 / (21.0 * size**2))
    path = np.zeros(size)
    for number in range(generations):
        steps = rng.normal(size=(members, size))
        scores = tuple(judge(number, [mean + spread * step for step in steps]))
        best = np.argsort(scores)[::-1][: len(shares)]
        step = shares @ steps[best]
        mean = mean + spread * step
        path = (1.0 - memory) * path + math.sqrt(memory * (2.0 - memory) * effective) * step
        spread *= math.exp(memory / damping * (float(np.linalg.norm(path)) / usual - 1.0))
        yield Generation(number=number, mean=mean, spread=spread, scores=scores)
