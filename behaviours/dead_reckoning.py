"""How the robot moved between two instants, by its wheels: along an arc, at constant speeds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from peopleboy.behaviours.percept import Percept, Points


@dataclass(frozen=True, slots=True)
class Motion:
    """A short drive.

    Attributes:
        way_m: [m] driven, forward positive.
        turn_rad: [rad] turned meanwhile, left positive.
    """

    way_m: float
    turn_rad: float

    @classmethod
    def of(cls, percept: Percept, step_s: float) -> Self:
        """Tell how far the wheels' present speeds bring the robot in step_s [s]."""
        return cls(percept.linear_m_s * step_s, percept.angular_rad_s * step_s)

    def carry(self, points: Points) -> Points:
        """Express points (N, 2) [m] of the robot's frame before the drive in its frame after it."""
        x = points[:, 0] - self.way_m * math.cos(self.turn_rad / 2.0)
        y = points[:, 1] - self.way_m * math.sin(self.turn_rad / 2.0)
        cosine, sine = math.cos(self.turn_rad), math.sin(self.turn_rad)
        return np.stack([cosine * x + sine * y, cosine * y - sine * x], axis=1)
