"""Who is in front of whom."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cmp_to_key
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.interaction import Regions
from peopleboy.tracker.thermal.particle_filter import FrameView
from peopleboy.tracker.thermal.tracked_person import TrackedPerson

FOOT_PX = 4.0  # [px] of 240 rows: difference of foot rows that counts 1
LOOKS = 12.0  # difference of squared distances of looks that counts 1
MOST = 4.0  # for which looks count at most
# Where it is not known whether people stand on one floor, or how well their feet are seen:
LOOSE_FOOT_PX = 12.0  # [px] of 240 rows
LOOSE_FOOT_MOST = 3.0
FIT = 0.03  # difference of the contours' fitness that counts 1
FIT_MOST = 6.0


@dataclass(frozen=True, slots=True, eq=False)
class ExpectedPerson:
    """A person as expected in this frame, before the image is measured.

    Attributes:
        person: as the last frame left it.
        state: (9,) where it should be by now.
        region: (4,) left, top, width, height [px] of that.
        unlikeness: squared distance of what is seen there from the person's looks; 0 where nothing is known.
        fit: how well the contour fits the image there, as if nobody were in front (equation 4.3).
    """

    person: TrackedPerson
    state: NDArray[np.float64]
    region: Regions
    unlikeness: float = 0.0
    fit: float = 0.0


class Order(Protocol):
    """Compares two people whose regions overlap."""

    def __call__(self, one: ExpectedPerson, other: ExpectedPerson, view: FrameView) -> float:
        """Tell who is in front: positive if the one is, negative if the other is; 0 if nobody knows."""
        ...


def lower_foot(one: ExpectedPerson, other: ExpectedPerson, view: FrameView) -> float:  # noqa: ARG001
    """Take the one whose feet are lower in the image for the nearer one: both stand on one floor."""
    return one.person.foot - other.person.foot


def likelier_front(one: ExpectedPerson, other: ExpectedPerson, view: FrameView) -> float:
    """Weigh up whose feet are lower and whose looks are seen where it is expected.

    Where two people overlap, the image shows the looks of the one in front; the one behind looks wrong.
    """
    lower = lower_foot(one, other, view) / (FOOT_PX * view.size)
    return lower + _clearer_appearance(one, other)


def plainer_contour(one: ExpectedPerson, other: ExpectedPerson, view: FrameView) -> float:
    """Weigh up whose contour is seen, whose looks, and whose feet are lower; none of them decides alone.

    The contour of the one in front is seen whole. On stairs and behind railings feet tell little.
    """
    lower = lower_foot(one, other, view) / (LOOSE_FOOT_PX * view.size)
    plainer = (one.fit - other.fit) / FIT
    return _at_most(lower, LOOSE_FOOT_MOST) + _at_most(plainer, FIT_MOST) + _clearer_appearance(one, other)


def _clearer_appearance(one: ExpectedPerson, other: ExpectedPerson) -> float:
    return _at_most((other.unlikeness - one.unlikeness) / LOOKS, MOST)


def _at_most(lead: float, most: float) -> float:
    return min(max(lead, -most), most)


def front_to_back(
    figures: Sequence[ExpectedPerson], order: Order, view: FrameView
) -> tuple[ExpectedPerson, ...]:
    """Sort people from front to back by pairwise comparison; who was born first wins a tie.

    Source: thesis, section 7.1.
    """

    def compare(one: ExpectedPerson, other: ExpectedPerson) -> int:
        lead = order(one, other, view)
        return int(np.sign(-lead)) if lead != 0 else one.person.id - other.person.id

    return tuple(sorted(figures, key=cmp_to_key(compare)))


ORDERS: Mapping[str, Order] = {"foot": lower_foot, "appearance": likelier_front, "contour": plainer_contour}
"""Ways to compare by name."""
