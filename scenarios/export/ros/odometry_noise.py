"""How sure odometry is: the noise of the wheels' encoders, carried along the way."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.robot.robot_body import WHEEL_DISTANCE_M


class OdometryNoise:
    """Adds up what encoders miscount, to first order; slip of the wheels is none of it.

    Args:
        encoder_noise_m: [m] standard deviation of the way that a wheel's encoder counts on 1 m.
    """

    def __init__(self, encoder_noise_m: float) -> None:
        self._per_m = encoder_noise_m**2
        self._before: Planar | None = None
        self._covariance = np.zeros((3, 3))

    def carry(self, pose: Planar) -> NDArray[np.float64]:
        """Give the covariance (3, 3) of x, y [m] and heading [rad] at the next pose; at the first it is 0."""
        if self._before is not None:
            self._covariance = self._carried(self._before, pose)
        self._before = pose
        return self._covariance.copy()

    def _carried(self, before: Planar, pose: Planar) -> NDArray[np.float64]:
        turn = math.remainder(pose.heading - before.heading, math.tau)
        cos, sin = math.cos(before.heading + turn / 2.0), math.sin(before.heading + turn / 2.0)
        advance = (pose.x - before.x) * cos + (pose.y - before.y) * sin
        by_pose = np.array([[1.0, 0.0, -advance * sin], [0.0, 1.0, advance * cos], [0.0, 0.0, 1.0]])
        by_motion = np.array([[cos, -advance * sin / 2.0], [sin, advance * cos / 2.0], [0.0, 1.0]])
        of_wheels = np.array([[0.5, 0.5], [-1.0 / WHEEL_DISTANCE_M, 1.0 / WHEEL_DISTANCE_M]])
        ways = advance + np.array([-0.5, 0.5]) * turn * WHEEL_DISTANCE_M
        by_wheels = by_motion @ of_wheels
        carried: NDArray[np.float64] = by_pose @ self._covariance @ by_pose.T
        carried += by_wheels * (self._per_m * np.abs(ways)) @ by_wheels.T
        return carried
