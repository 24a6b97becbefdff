"""Between what the robot sees and the room: where it stands, by its odometry."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import Odometry

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class RobotPose:
    """Where the robot stands: x, y [m] and heading [rad] in the room, whose frame is that of its start."""

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0

    def moved(self, odometry: Odometry) -> RobotPose:
        """Give the pose after a movement."""
        x, y = self._origin + self._axes @ (odometry.advance_m, odometry.aside_m)
        return RobotPose(float(x), float(y), self.heading + odometry.turn_rad)

    def place(self, distance_m: float, bearing_rad: float) -> Floats:
        """Put what is seen at a distance and a bearing into the room: (2,) [m]."""
        angle = self.heading + bearing_rad
        return self._origin + distance_m * np.array([math.cos(angle), math.sin(angle)])

    def locate(self, place_m: Floats) -> Floats:
        """Express a place (2,) of the room in the robot's own frame: forward, to the left [m]."""
        return np.asarray(self._axes.T @ (place_m - self._origin), np.float64)

    def turned(self, covariance_m2: Floats) -> Floats:
        """Express a covariance (2, 2) of the room in the robot's own frame [m2]."""
        return np.asarray(self._axes.T @ covariance_m2 @ self._axes, np.float64)

    @property
    def _origin(self) -> Floats:
        return np.array([self.x, self.y])

    @property
    def _axes(self) -> Floats:
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        return np.array([[cosine, -sine], [sine, cosine]])
