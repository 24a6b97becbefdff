"""How a sonar's beam hears a straight wall."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.behaviours.corridor.corridor_pose import Corridor
from peopleboy.behaviours.percept import Percept, Points, Ranges
from peopleboy.behaviours.sonar.sonar_ring import mounts

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class BeamConfig:
    """A sonar's beam.

    Attributes:
        half_cone_rad: [rad] half its opening; the echo comes from where in it the wall is nearest.
        reach_m: [m] a range beyond this is no echo.
        slant_rad: [rad] a beam that meets a wall more obliquely than this tells nothing.
    """

    half_cone_rad: float = math.radians(7.5)
    reach_m: float = 4.9
    slant_rad: float = math.radians(68.0)


def wall_distances(percept: Percept, normals_rad: Points, beam: BeamConfig) -> tuple[Points, Flags]:
    """Turn each reading into a distance [m] from the robot's origin to the wall, and tell whether it can.

    A beam whose axis is off the wall's normal by a hears the wall at distance / cos(a - half cone), or at its
    distance where the cone holds the normal.

    Args:
        percept: with the sonars' ranges.
        normals_rad: (K,) [rad] directions in the robot's frame in which a wall may lie.
        beam: the sonars' beams.

    Returns:
        (K, N) distances, and whether the beam can have heard that wall.
    """
    off = np.abs(np.angle(np.exp(1j * (percept.sonar_angle_rad - normals_rad[:, None]))))
    slant = np.maximum(off - beam.half_cone_rad, 0.0)
    facing = np.stack([np.cos(normals_rad), np.sin(normals_rad)])  # (2, K)
    distance = percept.sonar_m * np.cos(slant) + (mounts(percept.sonar_angle_rad) @ facing).T
    return distance, (slant < beam.slant_rad) & (percept.sonar_m < beam.reach_m)


def without_walls(percept: Percept, walls: Points, tolerance_m: float, beam: BeamConfig) -> Ranges:
    """Leave only what is in the way: ranges that a wall explains become infinite: (N,) [m].

    Args:
        percept: with the sonars' ranges.
        walls: (K, 2) direction [rad] in the robot's frame and distance [m] of each wall.
        tolerance_m: [m] an echo so little before a wall, or behind it, is the wall's.
        beam: the sonars' beams.
    """
    distance, _ = wall_distances(percept, walls[:, 0], beam)
    off = np.abs(np.angle(np.exp(1j * (percept.sonar_angle_rad - walls[:, :1]))))
    is_wall = (off < math.pi / 2.0) & (distance > walls[:, 1:] - tolerance_m)
    left: Ranges = np.where(is_wall.any(axis=0) | (percept.sonar_m >= beam.reach_m), np.inf, percept.sonar_m)
    return left


def side_walls(corridor: Corridor) -> Points:
    """Give direction [rad] and distance [m] of the left and the right wall: (2, 2), robot frame."""
    half = corridor.width_m / 2.0
    return np.array(
        [
            (math.pi / 2.0 - corridor.heading_rad, half - corridor.offset_m),
            (-math.pi / 2.0 - corridor.heading_rad, half + corridor.offset_m),
        ]
    )
