"""Runs of equal values in what is known frame by frame."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Span:
    """Frames from `start` up to but not including `end`, counted from 0, that have one value."""

    value: int
    start: int
    end: int

    @property
    def length(self) -> int:
        """Number of frames."""
        return self.end - self.start


def spans(values: Ints | Flags) -> list[Span]:
    """Cut a column (F,) into its longest runs of one value, in order."""
    if len(values) == 0:
        return []
    edges = [0, *(np.flatnonzero(np.diff(values.astype(np.int64))) + 1).tolist(), len(values)]
    return [Span(int(values[a]), a, b) for a, b in pairwise(edges)]


def settle(values: Ints, shortest: int) -> Ints:
    """Bridge the breaks in a column (F,) that are shorter than `shortest`, then forget runs that are: 0.

    Every run of a value other than 0 in the result has at least `shortest` frames.
    """
    settled = values.copy()
    for value in np.unique(values[values != 0]):
        at = np.flatnonzero(values == value)
        for before, after in pairwise(at.tolist()):
            if after - before <= shortest:
                settled[before:after] = value
    for span in spans(settled):
        if span.length < shortest:
            settled[span.start : span.end] = 0
    return settled


def between(values: Floats, starts: float, ends: float) -> Flags:
    """Tell (F,) where a column has risen above `starts` and not yet fallen below `ends`; NaN ends it."""
    inside = np.zeros(len(values), np.bool_)
    is_in = False
    for k, value in enumerate(values.tolist()):
        is_in = value >= ends if is_in else value > starts
        inside[k] = is_in
    return inside
