"""Where somebody looks: how far head, neck and chest are turned for it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

# How far round one looks without turning the body, how fast, and what share of it which bone turns: ours.
_FARTHEST_RAD: Final = math.radians(100.0)
_RATE_RAD_S: Final = math.radians(200.0)
SHARES: Final[Mapping[str, float]] = {"chest": 0.2, "neck": 0.3, "head": 0.5}
_BEHIND_RAD: Final = math.radians(150.0)  # beyond which one keeps looking over the same shoulder


class Gaze:
    """How far a person looks to the left [rad], which follows what is to be looked at."""

    def __init__(self) -> None:
        self.left_rad = 0.0

    def update(self, dt_s: float, bearing_rad: float | None) -> None:
        """Turn towards a bearing from the body's front, positive left, or back to the front for None."""
        off = 0.0 if bearing_rad is None else math.remainder(bearing_rad, math.tau)
        if abs(off) > _BEHIND_RAD and self.left_rad:
            off = math.copysign(off, self.left_rad)
        wanted = min(max(off, -_FARTHEST_RAD), _FARTHEST_RAD)
        step = _RATE_RAD_S * dt_s
        self.left_rad += min(max(wanted - self.left_rad, -step), step)
