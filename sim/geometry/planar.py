"""Poses on the floor."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Planar:
    """Where something stands on the floor: x, y [m] and heading [rad], world frame."""

    x: float
    y: float
    heading: float

    def locate(self, place: tuple[float, float]) -> tuple[float, float]:
        """Express a place x, y [m] of the world in this pose's own frame: forward, to the left."""
        dx, dy = place[0] - self.x, place[1] - self.y
        cosine, sine = math.cos(self.heading), math.sin(self.heading)
        return dx * cosine + dy * sine, dy * cosine - dx * sine
