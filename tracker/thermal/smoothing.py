"""A low pass over a person's estimates, against the jitter of the samples."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import SmoothingConfig
from peopleboy.tracker.thermal.filter.particles import STATE_SIZE, VX, D, H, W, X, Y
from peopleboy.tracker.thermal.particle_filter import FrameView


def smoothed(
    before: NDArray[np.float64], now: NDArray[np.float64], view: FrameView, config: SmoothingConfig
) -> NDArray[np.float64]:
    """Blend the estimate (9,) of this frame into the one shown before, first-order low pass.

    The place shown before moves on with the estimated velocity and the camera's turn, so that a steady walk
    is not shown late. A person's size changes slowly, and may be smoothed for longer than the place.
    """
    expected = before.copy()
    expected[:4] += view.dt_s * before[VX:]
    expected[[X]] = view.after_turn(expected[[X]])
    gain = np.ones(STATE_SIZE)
    gain[[X, Y]] = _gain(view.dt_s, config.place_s)
    gain[[W, H, D]] = _gain(view.dt_s, config.size_s)
    return expected + gain * (now - expected)


def _gain(dt_s: float, time_constant_s: float) -> float:
    return 1.0 if time_constant_s == 0 else 1 - math.exp(-dt_s / time_constant_s)
