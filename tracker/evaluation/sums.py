"""Numerators and denominators that add up over sequences, and the percentages computed from them."""

import math
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.sequence import Ints


@dataclass(frozen=True, slots=True, eq=False)
class Sums:
    """A record of sums: adding two gives the record of both sequences combined."""

    def __add__(self, other: Self) -> Self:
        names = [field.name for field in fields(self)]
        return type(self)(*(getattr(self, name) + getattr(other, name) for name in names))


def percent(numerator: float, denominator: float) -> float:
    """Return the ratio in percent, at most 100; NaN (undefined) if the denominator is 0."""
    return min(100.0, 100.0 * numerator / denominator) if denominator else math.nan


def sum_by(group: Ints, values: Floats, groups: int) -> Floats:
    """Sum the values (N,) of each group: (groups,), given the group (N,) of each value."""
    # Without values, bincount returns integers.
    return np.bincount(group, values, groups).astype(np.float64)
