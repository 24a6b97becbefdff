"""Angles in kernels."""

from __future__ import annotations

import math

from numba import njit


@njit(cache=True)
def remainder(angle: float) -> float:
    """`math.remainder` by a full turn, which kernels have not; exact up to one and a half turns."""
    if abs(angle) <= math.pi:
        return angle
    return angle - 2.0 * math.pi if angle > 0.0 else angle + 2.0 * math.pi
