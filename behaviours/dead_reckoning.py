"""Motion of the robot between two instants from wheel odometry: an arc at constant speeds."""

import math
from dataclasses import dataclass
from typing import Self

from peopleboy.behaviours.percept import Percept, Points
from peopleboy.geometry.pose2 import Pose2


@dataclass(frozen=True, slots=True)
class RobotMotion:
    """A short motion at constant speeds.

    Attributes:
        linear_m_s: [m/s] forward positive.
        angular_rad_s: [rad/s] left positive.
        step_s: [s] duration.
    """

    linear_m_s: float
    angular_rad_s: float
    step_s: float

    @classmethod
    def of(cls, percept: Percept, step_s: float) -> Self:
        """Return the motion for the wheels' current speeds, assumed constant over the last step_s [s]."""
        return cls(percept.linear_m_s, percept.angular_rad_s, step_s)

    @property
    def way_m(self) -> float:
        """Distance driven [m]."""
        return self.linear_m_s * self.step_s

    @property
    def turn_rad(self) -> float:
        """Rotation [rad]."""
        return self.angular_rad_s * self.step_s

    def carry(self, points: Points) -> Points:
        """Transform points (N, 2) [m] from the robot frame before the motion to that after it."""
        turn = self.turn_rad
        after = Pose2(self.way_m * math.cos(turn / 2.0), self.way_m * math.sin(turn / 2.0), turn)
        return after.points_to_local(points)
