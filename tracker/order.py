"""Who is in front of whom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cmp_to_key
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tracker.filter import View
from tracker.interaction import Regions
from tracker.person import Person


@dataclass(frozen=True, slots=True, eq=False)
class Figure:
    """A person as expected in this frame, before the image is measured.

    Attributes:
        person: as the last frame left it.
        state: (9,) where it should be by now.
        region: (4,) left, top, width, height [px] of that.
    """

    person: Person
    state: NDArray[np.float64]
    region: Regions


class Order(Protocol):
    """Compares two people whose regions overlap."""

    def __call__(self, one: Figure, other: Figure, view: View) -> float:
        """Tell who is in front: positive if the one is, negative if the other is; 0 if nobody knows."""
        ...


def lower_foot(one: Figure, other: Figure, view: View) -> float:  # noqa: ARG001
    """Take the one whose feet are lower in the image for the nearer one: both stand on one floor."""
    return one.person.foot - other.person.foot


def front_to_back(figures: Sequence[Figure], order: Order, view: View) -> tuple[Figure, ...]:
    """Sort people from front to back by pairwise comparison; who was born first wins a tie.

    Source: thesis, section 7.1.
    """

    def compare(one: Figure, other: Figure) -> int:
        lead = order(one, other, view)
        return int(np.sign(-lead)) if lead != 0 else one.person.id - other.person.id

    return tuple(sorted(figures, key=cmp_to_key(compare)))
