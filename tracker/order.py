"""Who is in front of whom."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cmp_to_key
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tracker.filter import View
from tracker.interaction import Regions
from tracker.person import Person

FOOT_PX = 4.0  # [px] of 240 rows: difference of foot rows that counts 1
LOOKS = 12.0  # difference of squared distances of looks that counts 1
MOST = 4.0  # for which looks count at most


@dataclass(frozen=True, slots=True, eq=False)
class Figure:
    """A person as expected in this frame, before the image is measured.

    Attributes:
        person: as the last frame left it.
        state: (9,) where it should be by now.
        region: (4,) left, top, width, height [px] of that.
        unlikeness: squared distance of what is seen there from the person's looks; 0 where nothing is known.
    """

    person: Person
    state: NDArray[np.float64]
    region: Regions
    unlikeness: float = 0.0


class Order(Protocol):
    """Compares two people whose regions overlap."""

    def __call__(self, one: Figure, other: Figure, view: View) -> float:
        """Tell who is in front: positive if the one is, negative if the other is; 0 if nobody knows."""
        ...


def lower_foot(one: Figure, other: Figure, view: View) -> float:  # noqa: ARG001
    """Take the one whose feet are lower in the image for the nearer one: both stand on one floor."""
    return one.person.foot - other.person.foot


def likelier_front(one: Figure, other: Figure, view: View) -> float:
    """Weigh up whose feet are lower and whose looks are seen where it is expected.

    Where two people overlap, the image shows the looks of the one in front; the one behind looks wrong.
    """
    lower = lower_foot(one, other, view) / (FOOT_PX * view.size)
    clearer = (other.unlikeness - one.unlikeness) / LOOKS
    return lower + min(max(clearer, -MOST), MOST)


def front_to_back(figures: Sequence[Figure], order: Order, view: View) -> tuple[Figure, ...]:
    """Sort people from front to back by pairwise comparison; who was born first wins a tie.

    Source: thesis, section 7.1.
    """

    def compare(one: Figure, other: Figure) -> int:
        lead = order(one, other, view)
        return int(np.sign(-lead)) if lead != 0 else one.person.id - other.person.id

    return tuple(sorted(figures, key=cmp_to_key(compare)))


ORDERS: Mapping[str, Order] = {"foot": lower_foot, "looks": likelier_front}
"""Ways to compare by name."""
