"""Obstacle avoidance by aiming past obstacles, so that the robot slides along walls and through doors."""

import math
from dataclasses import dataclass

import numpy as np

from peopleboy.behaviours.percept import Points

# Tested shares of the largest swerve in ascending order, and the weight of a radian of violation relative to
# one of swerve.
_AIMS = np.array(sorted(np.linspace(-1.0, 1.0, 101), key=abs))
_INSIST = 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class AvoidConfig:
    """Size and range of the swerve.

    Attributes:
        half_width_m: [m] half width of the free lane: half the hull, plus the guard's lateral clearance.
        reach_m: [m] obstacles farther from the robot's origin are ignored.
        fade_m: [m] part of the reach over which the swerve grows to its full size.
        widest_rad: [rad] largest swerve; the camera should keep the followed person in view.
    """

    half_width_m: float = 0.68
    reach_m: float = 1.4
    fade_m: float = 0.4
    widest_rad: float = math.radians(24.0)


# For a robot without a person to keep in view.
WIDELY = AvoidConfig(half_width_m=0.75, reach_m=1.7, fade_m=0.5, widest_rad=math.radians(75.0))


def swerve(bearing_rad: float, points: Points, config: AvoidConfig) -> float:
    """Return the angle next to the goal [rad, positive left] at which the lane ahead is free.

    An echo requires an aim at least asin(half width / distance) off its own direction. The aim minimises the
    largest violation, weighted against its angle to the goal; between equal echoes on both sides the aim is
    unchanged.

    Args:
        bearing_rad: [rad] direction of the goal relative to the robot's heading.
        points: (N, 2) [m] echoes, robot frame.
        config: size of the swerve.
    """
    distance = np.hypot(points[:, 0], points[:, 1])
    is_near = (points[:, 0] > 0.0) & (distance < config.reach_m)
    x, y, distance = points[is_near, 0], points[is_near, 1], distance[is_near]
    off_goal = np.arctan2(y, x) - bearing_rad
    spread = np.arcsin(np.minimum(config.half_width_m / np.maximum(distance, 1e-6), 1.0))
    grown = np.minimum((config.reach_m - distance) / config.fade_m, 1.0)
    aims = config.widest_rad * _AIMS
    wanted = np.maximum(spread - np.abs(off_goal - aims[:, None]), 0.0) * grown  # (K, N)
    cost = _INSIST * wanted.max(axis=1, initial=0.0) + np.abs(aims)
    return float(aims[np.argmin(cost)])


# Making room for a returning person, out of the way and far enough for the cameras to identify the person.


@dataclass(frozen=True, slots=True, kw_only=True)
class ClearanceConfig:
    """Settings of making room.

    Attributes:
        ahead_m: [m] free distance ahead required for a person who was near when last seen ...
        close_m: [m] ... and for any lost person ...
        half_width_m: [m] ... so far to either side.
        longest_s: [s] time since the last observation after which the robot stops making room.
        speed_m_s: [m/s] speed of backing off, and of leaving a narrow place.
        cramped_m: [m] distance from the origin within which an obstacle makes a place narrow ...
        close_by_m: [m] ... and the same after farthest_m, since a person may move along with the robot.
        free_m: [m] free distance ahead that leads out of a narrow place.
        farthest_m: [m] driven distance, see above.
    """

    ahead_m: float = 2.2
    close_m: float = 1.3
    half_width_m: float = 0.45
    longest_s: float = 12.0
    speed_m_s: float = 0.4
    cramped_m: float = 1.6
    close_by_m: float = 1.0
    free_m: float = 2.8
    farthest_m: float = 3.0


def is_person_near(around: Points, config: ClearanceConfig, *, was_near: bool) -> bool:
    """Return whether an obstacle is close ahead.

    Args:
        around: (N, 2) [m] echoes, robot frame.
        was_near: whether the person was near when it was last seen.
        config: distances.
    """
    return _is_taken(around, config.ahead_m if was_near else config.close_m, config.half_width_m)


def is_way_out(around: Points, config: ClearanceConfig, gone_m: float) -> bool:
    """Return whether the robot is in a narrow place, or next to a person, and faces a wide one.

    Args:
        around: (N, 2) [m] echoes, robot frame.
        config: distances.
        gone_m: [m] distance driven for this since the search began.
    """
    near_m = config.cramped_m if gone_m < config.farthest_m else config.close_by_m
    is_narrow = bool(np.any(np.hypot(*around.T) < near_m))
    return is_narrow and not _is_taken(around, config.free_m, config.half_width_m)


def _is_taken(around: Points, ahead_m: float, half_width_m: float) -> bool:
    x, y = around.T
    return bool(np.any((x > 0.0) & (x < ahead_m) & (np.abs(y) < half_width_m)))
