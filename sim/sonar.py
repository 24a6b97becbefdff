"""The sonar ring: the nearest solid within each of 16 cones."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sim.bullet import Bullet
from sim.camera import Matrix, transform
from sim.config import SonarConfig

# x, y [m] and angle [deg] of each sonar: ARIA's parameter file peoplebot-sh.p, SonarUnit 0..15.
_UNITS = np.array(
    [
        (0.069, 0.136, 90.0),
        (0.114, 0.119, 50.0),
        (0.148, 0.078, 30.0),
        (0.166, 0.027, 10.0),
        (0.166, -0.027, -10.0),
        (0.148, -0.078, -30.0),
        (0.114, -0.119, -50.0),
        (0.069, -0.136, -90.0),
        (-0.157, -0.136, -90.0),
        (-0.203, -0.119, -130.0),
        (-0.237, -0.078, -150.0),
        (-0.255, -0.027, -170.0),
        (-0.255, 0.027, 170.0),
        (-0.237, 0.078, 150.0),
        (-0.203, 0.119, 130.0),
        (-0.157, 0.136, 90.0),
    ]
)
SONAR_POSITION_M = _UNITS[:, :2].copy()
SONAR_ANGLE_RAD = np.radians(_UNITS[:, 2])
_RAYS_ACROSS, _RAYS_HIGH = 5, 3


def cone_rays(cone_rad: float) -> NDArray[np.float64]:
    """(16, 15, 3) unit vectors that fill each sonar's cone, robot frame."""
    across = np.linspace(-0.5, 0.5, _RAYS_ACROSS) * cone_rad
    high = np.linspace(-0.5, 0.5, _RAYS_HIGH) * cone_rad * math.sqrt(0.5)
    yaw = (SONAR_ANGLE_RAD[:, None, None] + across[None, :, None]).repeat(_RAYS_HIGH, axis=2)
    pitch = np.broadcast_to(high, yaw.shape)
    rays = np.stack([np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)], axis=-1)
    return rays.reshape(len(_UNITS), -1, 3)


class SonarRing:
    """A ring of 16 sonars on a body, which they do not see.

    Each reads the distance to the nearest solid along 15 rays in its cone. Mirror-like reflection off walls
    at a slant, and echoes between sonars, are not modelled; drop-outs stand in for lost echoes.
    """

    def __init__(self, bullet: Bullet, config: SonarConfig, rng: np.random.Generator, owner: str) -> None:
        self._bullet = bullet
        self._config = config
        self._rng = rng
        self._owner = owner
        rays = cone_rays(config.cone_rad)
        self._starts = np.concatenate([SONAR_POSITION_M, np.full((len(_UNITS), 1), config.height_m)], axis=1)[
            :, None, :
        ].repeat(rays.shape[1], axis=1)
        self._ends = self._starts + rays * config.farthest_m

    def read(self, world_from_robot: Matrix) -> NDArray[np.float64]:
        """Read all sonars once.

        Args:
            world_from_robot: (4, 4) pose of the robot.

        Returns:
            (16,) [m] within nearest..farthest; farthest where nothing answers.
        """
        starts = transform(world_from_robot, self._starts).reshape(-1, 3)
        ends = transform(world_from_robot, self._ends).reshape(-1, 3)
        fraction, _ = self._bullet.cast_rays(starts, ends, ignore=self._owner)
        nearest = fraction.reshape(len(_UNITS), -1).min(axis=1)
        reading = nearest * self._config.farthest_m + self._rng.normal(0.0, self._config.noise_m, len(_UNITS))
        lost = (nearest >= 1.0) | (self._rng.random(len(_UNITS)) < self._config.drop_out)
        reading[lost] = self._config.farthest_m
        return np.clip(reading, self._config.nearest_m, self._config.farthest_m)
