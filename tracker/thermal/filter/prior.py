"""Where a person may be before anything was seen."""

from __future__ import annotations

import math

import numpy as np

from peopleboy.tracker.thermal.config import (
    REFERENCE_HEIGHT_PX,
    FilterConfig,
    LimitsConfig,
    MotionConfig,
    TrackerConfig,
)
from peopleboy.tracker.thermal.filter.particles import STATE_SIZE, VH, VW, VX, VY, D, Floats, H, W, X, Y

BOX_SPREAD = 0.05  # of a person within a box that is known, as a share of its sides


def draw_prior(
    count: int,
    shape: tuple[int, int],
    motion: MotionConfig,
    filter_config: FilterConfig,
    rng: np.random.Generator,
) -> Floats:
    """Draw samples (count, 9) evenly over the limits; velocities normal around standing still.

    Source: thesis, section 4.1, "in our case uniform".
    """
    height, width = shape
    limits = filter_config.limits
    chance = rng.random((count, 5), dtype=np.float32)
    velocity = rng.standard_normal((count, 4), dtype=np.float32)
    state = np.empty((count, STATE_SIZE), dtype=np.float32)
    state[:, X] = width * chance[:, 0]
    state[:, H] = height * _heights(limits.h, chance[:, 2], filter_config.log_uniform_h)
    state[:, Y] = _rows(height, state[:, H], limits, chance[:, 1])
    state[:, W] = state[:, H] * _between(limits.ratio_wh, chance[:, 3])
    state[:, D] = state[:, W] * _between(limits.ratio_dw, chance[:, 4])
    noise = (motion.noise_x, motion.noise_y, motion.noise_w, motion.noise_h)
    amplitude = np.array(noise if motion.fresh_speed is None else motion.fresh_speed, dtype=np.float32)
    state[:, [VX, VY, VW, VH]] = height / REFERENCE_HEIGHT_PX * amplitude * velocity
    return state


def _heights(limits: tuple[float, float], chance: Floats, is_log_uniform: bool) -> Floats:
    """Draw h in image heights; log-uniform, small and far people are as many as large and near ones."""
    if not is_log_uniform:
        return _between(limits, chance)
    h: Floats = np.exp(_between((math.log(limits[0]), math.log(limits[1])), chance))
    return h


def _rows(height: int, h: Floats, limits: LimitsConfig, chance: Floats) -> Floats:
    """Draw y [px] between the limits, those of the floor included."""
    low = np.maximum(limits.y[0] * height, limits.horizon * height + limits.y_below_horizon[0] * h)
    high = np.minimum(limits.y[1] * height, limits.horizon * height + limits.y_below_horizon[1] * h)
    y: Floats = low + (high - low) * chance
    return y


def _between(limits: tuple[float, float], chance: Floats) -> Floats:
    drawn: Floats = np.float32(limits[0]) + np.float32(limits[1] - limits[0]) * chance
    return drawn


def draw_around(
    box: tuple[float, float, float, float], config: TrackerConfig, rng: np.random.Generator
) -> Floats:
    """Draw samples (N, 9) of a standing person whose box [px] is known.

    The box gives top, height and column; its width may be that of arms and a stride, so that of the body is
    drawn from what bodies may have.
    """
    left, top, width, height = box
    limits, count = config.person.limits, config.person.count
    h = height / config.box.height_per_h * np.exp(BOX_SPREAD * rng.standard_normal(count))
    state = np.zeros((count, STATE_SIZE), dtype=np.float32)
    state[:, H] = h
    state[:, X] = left + width / 2 + BOX_SPREAD * width * rng.standard_normal(count)
    state[:, Y] = top + (1 + 2 / config.contour.head_divisor + config.box.hair_per_h) * h
    state[:, W] = h * rng.uniform(*limits.ratio_wh, count)
    state[:, D] = state[:, W] * rng.uniform(*limits.ratio_dw, count)
    return state
