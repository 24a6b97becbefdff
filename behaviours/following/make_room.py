"""Making room for somebody who comes back: neither in the way, nor so near that no camera shows who it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from peopleboy.behaviours.percept import Points


@dataclass(frozen=True, slots=True, kw_only=True)
class RoomConfig:
    """How much room is made.

    Attributes:
        ahead_m: [m] way ahead that is to be free for somebody who was near when last seen ...
        close_m: [m] ... and for anybody who was lost ...
        half_width_m: [m] ... so far to either side.
        longest_s: [s] since the person was seen, after which the robot goes on otherwise.
        speed_m_s: [m/s] of backing off, and of driving out of a narrow place.
        cramped_m: [m] from the origin within which something makes a place narrow ...
        close_by_m: [m] ... and once the robot has gone for farthest_m: somebody may come along with it.
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


def is_somebody_near(around: Points, config: RoomConfig, *, was_near: bool) -> bool:
    """Tell whether something is close ahead.

    Args:
        around: (N, 2) [m] what the sonars hear, robot frame.
        was_near: whether the person was near when it was last seen.
        config: how close.
    """
    return _is_taken(around, config.ahead_m if was_near else config.close_m, config.half_width_m)


def is_way_out(around: Points, config: RoomConfig, gone_m: float) -> bool:
    """Tell whether the robot stands in a narrow place, or beside somebody, and heads for a wide one.

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
