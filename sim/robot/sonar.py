"""The sonar ring: the nearest solid within each of 16 cones."""

import math
from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.physics.physics_engine import Physics
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD, SONAR_POSITION_M
from peopleboy.sim.robot.robot_config import SonarConfig

CastRays: TypeAlias = Callable[[Matrix, Matrix], Matrix]
"""Maps starts and ends (G, R, 3) [m] of rays to the fractions (G, R) of their lengths at which they hit."""

_SONARS = len(SONAR_ANGLE_RAD)
# Rings of rays about a cone's axis: share of its half angle, and number of rays.
_RINGS = ((0.0, 1), (0.5, 6), (1.0, 8))
# Rays end this far above the floor, which reflects sound away from a sonar and gives no echo.
_CLEAR_OF_FLOOR_M = 0.03


def cone_rays(cone_rad: float) -> NDArray[np.float64]:
    """Return (16, 15, 3) unit vectors, robot frame, that fill each sonar's cone: axis and two rings."""
    around = [(share, math.tau * k / count) for share, count in _RINGS for k in range(count)]
    off, turn = np.array(around).T * [[cone_rad / 2.0], [1.0]]
    ahead, left, up = np.cos(off), np.sin(off) * np.cos(turn), np.sin(off) * np.sin(turn)
    cos, sin = np.cos(SONAR_ANGLE_RAD)[:, None], np.sin(SONAR_ANGLE_RAD)[:, None]
    return np.stack([ahead * cos - left * sin, ahead * sin + left * cos, np.tile(up, (_SONARS, 1))], -1)


class SonarRing:
    """A ring of 16 sonars on a body that they do not detect.

    Each reads the distance to the nearest solid along 15 rays in its cone, the floor aside. Specular
    reflection off oblique walls, and cross-talk between sonars, are not modelled; drop-outs represent lost
    echoes.

    Attributes:
        config: the settings.
        starts: (16, 3) [m] positions of the sonars, robot frame.
        ends: (240, 3) [m] ends of their rays, sonar by sonar.
        reach: (16, 15) [m] lengths of the rays.
    """

    def __init__(self, physics: Physics, config: SonarConfig, rng: np.random.Generator, owner: str) -> None:
        self._physics = physics
        self.config = config
        self._rng = rng
        self._owner = owner
        rays = cone_rays(config.cone_rad)
        middles = np.concatenate([SONAR_POSITION_M, np.full((_SONARS, 1), config.height_m)], axis=1)
        with np.errstate(divide="ignore"):
            to_floor = (config.height_m - _CLEAR_OF_FLOOR_M) / np.maximum(-rays[..., 2], 0.0)
        self.reach = np.minimum(config.farthest_m, to_floor)
        self.starts = middles
        self.ends = (middles[:, None, :] + rays * self.reach[..., None]).reshape(-1, 3)

    def read(self, world_from_robot: Matrix) -> NDArray[np.float64]:
        """Read all sonars once: (16,) [m], from a pose (4, 4) of the robot; see `read_rings`."""
        readings: Matrix = read_rings([self], world_from_robot[None], self._cast)[0]
        return readings

    def _cast(self, starts: Matrix, ends: Matrix) -> Matrix:
        return self._physics.cast_rays(starts[0], ends[0], ignore=self._owner)[0][None]

    def draw_noise(self, noise: NDArray[np.float64], chance: NDArray[np.float64]) -> None:
        """Fill (16,) with standard normal and (16,) with uniform noise for the next readings."""
        self._rng.standard_normal(out=noise)
        self._rng.random(out=chance)


def read_rings(rings: Sequence[SonarRing], world_from_robot: Matrix, cast: CastRays) -> NDArray[np.float64]:
    """Read the rings of G robots once; all have the same settings.

    Args:
        rings: sonar rings of the robots; each draws its own noise.
        world_from_robot: (G, 4, 4) poses of the robots.
        cast: casts the rays of all of them.

    Returns:
        (G, 16) [m] within nearest..farthest; farthest without an echo.
    """
    ring = rings[0]
    sonars, rays = ring.reach.shape
    turns, shifts = world_from_robot[:, :3, :3].transpose(0, 2, 1), world_from_robot[:, None, :3, 3]
    starts, ends = (points @ turns + shifts for points in (ring.starts, ring.ends))
    fraction = cast(starts.repeat(rays, axis=1), ends).reshape(-1, sonars, rays)
    nearest_m = np.where(fraction < 1.0, fraction * ring.reach, np.inf).min(axis=2)
    noise, chance = np.empty((2, len(rings), sonars))
    for row, each in enumerate(rings):
        each.draw_noise(noise[row], chance[row])
    reading = np.where(chance < ring.config.drop_out, np.inf, nearest_m + ring.config.noise_m * noise)
    return np.clip(reading, ring.config.nearest_m, ring.config.farthest_m)
