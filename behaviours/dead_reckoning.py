"""How the robot moved between two instants, by its wheels: along an arc, at constant speeds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

from peopleboy.behaviours.percept import Percept, Points
from peopleboy.geometry.pose2 import Pose2


@dataclass(frozen=True, slots=True)
class RobotMotion:
    """A short drive at constant speeds.

    Attributes:
        linear_m_s: [m/s] forward positive.
        angular_rad_s: [rad/s] left positive.
        step_s: [s] how long it took.
    """

    linear_m_s: float
    angular_rad_s: float
    step_s: float

    @classmethod
    def of(cls, percept: Percept, step_s: float) -> Self:
        """Take the wheels' present speeds for those of the last step_s [s]."""
        return cls(percept.linear_m_s, percept.angular_rad_s, step_s)

    @property
    def way_m(self) -> float:
        """How far [m] it led."""
        return self.linear_m_s * self.step_s

    @property
    def turn_rad(self) -> float:
        """By how much [rad] it turned the robot."""
        return self.angular_rad_s * self.step_s

    def carry(self, points: Points) -> Points:
        """Express points (N, 2) [m] of the robot's frame before the drive in its frame after it."""
        turn = self.turn_rad
        after = Pose2(self.way_m * math.cos(turn / 2.0), self.way_m * math.sin(turn / 2.0), turn)
        return after.points_to_local(points)
