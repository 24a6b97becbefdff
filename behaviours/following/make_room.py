"""Backing off for somebody who has come so near that no camera shows who it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from peopleboy.behaviours.percept import Points


@dataclass(frozen=True, slots=True, kw_only=True)
class RoomConfig:
    """How much room is made.

    Attributes:
        ahead_m: [m] way ahead that is to be free ...
        half_width_m: [m] ... so far to either side.
        longest_s: [s] since the person was seen, after which the robot goes on otherwise.
        speed_m_s: [m/s] of backing off.
    """

    ahead_m: float = 2.2
    half_width_m: float = 0.6
    longest_s: float = 12.0
    speed_m_s: float = 0.4


def is_somebody_near(around: Points, config: RoomConfig) -> bool:
    """Tell whether something is close ahead.

    Args:
        around: (N, 2) [m] what the sonars hear, robot frame.
        config: how close.
    """
    x, y = around.T
    return bool(np.any((x > 0.0) & (x < config.ahead_m) & (np.abs(y) < config.half_width_m)))
