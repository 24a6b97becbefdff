"""What a person knows when it meets the robot, and from when to when it does."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.walking.free_way import is_free
from peopleboy.sim.people.walking.social_force import PlanarState

Array = NDArray[np.float64]

_FORGOTTEN_M: Final = 1.0  # so much farther than where it began an encounter ends
_ROOM_M: Final = 0.3  # that a person keeps from walls


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Situation:
    """A person and the robot at an instant.

    Attributes:
        at: (2,) [m] where the person is.
        heading: [rad] where its body faces.
        home: (2,) [m] the waypoint at which it is to be now; None on the way to the next one.
        is_walking: whether it is on its way to the next one.
        is_seated: whether it sits.
        robot: the robot's state.
        walls: (K, 4) [m] rectangles that nobody walks or sees through.
    """

    at: Array
    heading: float
    home: Array | None
    is_walking: bool
    is_seated: bool
    robot: PlanarState
    walls: Array

    @property
    def gap_m(self) -> float:
        """[m] from the person's middle to the robot's."""
        return math.dist(self.at, self.robot.position)

    @property
    def away(self) -> Array:
        """(2,) unit vector from the robot to the person; along x if both are in one place."""
        way = self.at - self.robot.position
        length = float(np.hypot(*way))
        return way / length if length > 1e-6 else np.array([1.0, 0.0])

    @property
    def is_in_sight(self) -> bool:
        """Whether nothing stands between the two."""
        return is_free(self.at, self.robot.position, self.walls)

    def can_go(self, place: Array) -> bool:
        """Whether the straight way to a place (2,) [m] is free."""
        return is_free(self.at, place, self.walls, _ROOM_M)


class Encounter:
    """Tells from instant to instant whether a person and the robot have met.

    They meet when the robot is near enough and in sight, and part when it is a metre farther off; what gets
    between them meanwhile does not part them.
    """

    def __init__(self, from_m: float) -> None:
        self._from_m = from_m
        self._is_on = False

    def update(self, now: Situation) -> bool:
        """Take in an instant, and tell whether the two have met."""
        gap_m = now.gap_m
        if self._is_on:
            self._is_on = gap_m <= self._from_m + _FORGOTTEN_M
        else:
            self._is_on = gap_m <= self._from_m and now.is_in_sight
        return self._is_on
