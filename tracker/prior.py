"""Where a person may be before anything was seen."""

from __future__ import annotations

import math

import numpy as np

from tracker.config import FilterConfig, LimitsConfig, MotionConfig
from tracker.particles import STATE_SIZE, VH, VW, VX, VY, D, Floats, H, W, X, Y


def draw_prior(
    count: int,
    shape: tuple[int, int],
    size: float,
    limits: LimitsConfig,
    motion: MotionConfig,
    filter_config: FilterConfig,
    rng: np.random.Generator,
) -> Floats:
    """Draw samples (count, 9) evenly over the limits; velocities normal with the motion model's amplitudes.

    Source: thesis, section 4.1, "in our case uniform".
    """
    height, width = shape
    chance = rng.random((count, 5), dtype=np.float32)
    velocity = rng.standard_normal((count, 4), dtype=np.float32)
    state = np.empty((count, STATE_SIZE), dtype=np.float32)
    state[:, X] = width * chance[:, 0]
    state[:, Y] = height * _between(limits.y, chance[:, 1])
    low, high = limits.h
    if filter_config.log_uniform_h:
        state[:, H] = height * np.exp(_between((math.log(low), math.log(high)), chance[:, 2]))
    else:
        state[:, H] = height * _between(limits.h, chance[:, 2])
    state[:, W] = state[:, H] * _between(limits.ratio_wh, chance[:, 3])
    state[:, D] = state[:, W] * _between(limits.ratio_dw, chance[:, 4])
    amplitude = size * np.array(
        [motion.noise_x, motion.noise_y, motion.noise_w, motion.noise_h], dtype=np.float32
    )
    state[:, [VX, VY, VW, VH]] = amplitude * velocity
    return state


def _between(limits: tuple[float, float], chance: Floats) -> Floats:
    return (limits[0] + (limits[1] - limits[0]) * chance).astype(np.float32)
