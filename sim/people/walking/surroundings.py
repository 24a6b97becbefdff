"""What guides a walker besides its script: people, robot and walls around it, and its own wishes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.walking.social_force import PlanarState

Array = NDArray[np.float64]


class Present(NamedTuple):
    """People who are there.

    Attributes:
        rows: of `motion`, by name.
        motion: (N, 4) where they are and how they move: x, y [m], and their velocities [m/s].
    """

    rows: Mapping[str, int]
    motion: Array


NOBODY: Final = Present({}, np.empty((0, 4)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """What a walker may have to give way to.

    Attributes:
        people: who is there, the walker as well.
        walker: its row among them; -1 if it is not there.
        robot: None if there is none.
        walls: (K, 4) [m] rectangles min_x, min_y, max_x, max_y.
    """

    people: Present
    walker: int
    robot: PlanarState | None
    walls: Array

    def find(self, face: tuple[float, float] | str) -> Array | None:
        """Position (2,) [m] of what a person turns to; None if it is not there."""
        if not isinstance(face, str):
            return np.array(face)
        if face == "robot":
            return None if self.robot is None else self.robot.position
        row = self.people.rows.get(face)
        return None if row is None else self.people.motion[row, :2]


ALONE: Final = Surroundings(people=NOBODY, walker=-1, robot=None, walls=np.empty((0, 4)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Wish:
    """What changes a person's script at an instant; the defaults change nothing.

    Attributes:
        goes_to: (2,) [m] where it goes in place of its way, giving way to all; None to keep to its way.
        stands: whether it stops where it is; its pauses stand still meanwhile.
        faces: (2,) [m] to what its body turns when it stands, and over the last steps to `goes_to`.
        looks_at: (2,) [m] to what its head turns; None for straight ahead.
        pace: share of the planned speed.
        clear_m: [m] how far its middle keeps away from the robot's; None for what is usual.
        heeds_robot: whether it makes way for the robot where it makes way at all.
        calls: whether it raises an arm and waves.
    """

    goes_to: Array | None = None
    stands: bool = False
    faces: Array | None = None
    gaze_at: Array | None = None
    pace: float = 1.0
    clear_m: float | None = None
    heeds_robot: bool = True
    calls: bool = False


AS_PLANNED: Final = Wish()
