"""What is around somebody who walks: people, the robot, walls."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.walking.social_force import PlanarState

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """What a walker may have to give way to.

    Attributes:
        others: people by name.
        robot: None if there is none.
        walls: (K, 4) [m] rectangles min_x, min_y, max_x, max_y.
    """

    others: Mapping[str, PlanarState]
    robot: PlanarState | None
    walls: Array

    def find(self, face: tuple[float, float] | str) -> Array | None:
        """Position (2,) [m] of what somebody turns to; None if it is not there."""
        if not isinstance(face, str):
            return np.array(face)
        state = self.robot if face == "robot" else self.others.get(face)
        return None if state is None else state.position


ALONE = Surroundings(others={}, robot=None, walls=np.empty((0, 4)))
