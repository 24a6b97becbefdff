"""Aim past what stands beside the way, so that the robot slides along walls and through doors."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from peopleboy.behaviours.percept import Points

# Shares of the largest swerve that are tried, the least first; and what a radian wanted weighs against one
# swerved.
_AIMS = np.array(sorted(np.linspace(-1.0, 1.0, 101), key=abs))
_INSIST = 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class AvoidConfig:
    """How far and how early the robot swerves.

    Attributes:
        half_width_m: [m] half of the lane to keep free: half the hull, and what the guard keeps beside it.
        reach_m: [m] obstacles farther from the robot's origin are of no concern yet.
        fade_m: [m] over this much of the reach the swerve grows to its full size.
        widest_rad: [rad] largest swerve; the camera should keep the followed person in view.
    """

    half_width_m: float = 0.68
    reach_m: float = 1.4
    fade_m: float = 0.4
    widest_rad: float = math.radians(24.0)


# For a robot that has nobody to keep in view.
WIDELY = AvoidConfig(half_width_m=0.75, reach_m=1.7, fade_m=0.5, widest_rad=math.radians(75.0))


def swerve(bearing_rad: float, points: Points, config: AvoidConfig) -> float:
    """Return how far beside the goal [rad, positive left] to aim, so that the lane ahead is free.

    An echo wants the aim off its own direction by asin(half width / distance). That aim is taken which leaves
    the least to be wanted, weighed against how far off the goal it is; between equal echoes on both sides the
    aim stays.

    Args:
        bearing_rad: [rad] direction of the goal from the robot's nose.
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


# Making room for a person who comes back: neither in the way, nor so near that no camera shows who it is.


@dataclass(frozen=True, slots=True, kw_only=True)
class ClearanceConfig:
    """How much room is made.

    Attributes:
        ahead_m: [m] way ahead that is to be free for a person who was near when last seen ...
        close_m: [m] ... and for anybody who was lost ...
        half_width_m: [m] ... so far to either side.
        longest_s: [s] since the person was seen, after which the robot goes on otherwise.
        speed_m_s: [m/s] of backing off, and of driving out of a narrow place.
        cramped_m: [m] from the origin within which something makes a place narrow ...
        close_by_m: [m] ... and once the robot has gone for farthest_m: a person may come along with it.
        free_m: [m] way ahead that leads out of it.
        farthest_m: [m] see above.
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
    """Return whether something is close ahead.

    Args:
        around: (N, 2) [m] what the sonars hear, robot frame.
        was_near: whether the person was near when it was last seen.
        config: how close.
    """
    return _is_taken(around, config.ahead_m if was_near else config.close_m, config.half_width_m)


def is_way_out(around: Points, config: ClearanceConfig, gone_m: float) -> bool:
    """Return whether the robot stands in a narrow place, or beside a person, and heads for a wide one.

    Args:
        around: (N, 2) [m] what the sonars hear, robot frame.
        config: how narrow, and how wide.
        gone_m: [m] way that it has gone for this since it began to search.
    """
    near_m = config.cramped_m if gone_m < config.farthest_m else config.close_by_m
    is_narrow = bool(np.any(np.hypot(*around.T) < near_m))
    return is_narrow and not _is_taken(around, config.free_m, config.half_width_m)


def _is_taken(around: Points, ahead_m: float, half_width_m: float) -> bool:
    x, y = around.T
    return bool(np.any((x > 0.0) & (x < ahead_m) & (np.abs(y) < half_width_m)))
