"""How a person moves in the image from one frame to the next."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.config import MotionConfig
from peopleboy.tracker.thermal.filter.particles import VX, D, Floats, H

Columns = NDArray[np.floating[Any]]


def predict(
    state: Floats, dt_s: float, size: float, config: MotionConfig, rng: np.random.Generator
) -> Floats:
    """Draw the (N, 9) states one time step later.

    Constant velocity in (x, y, w, h), a random walk in d and in the velocities.

    Args:
        state: (N, 9) particles now.
        dt_s: time step [s].
        size: image height / 240; the amplitudes are given for an image of 240 rows.
        config: amplitudes of the random walk.
        rng: source of chance.

    Source: thesis, equations 4.7 and 4.8.
    """
    noise = rng.standard_normal((len(state), 5), dtype=np.float32)
    amplitude = noise_per_step(dt_s, size, config)
    memory = np.array([config.place_memory] * 2 + [config.size_memory] * 2, dtype=np.float32)
    moved: Floats = _predicted(state, noise, amplitude, dt_s, size * config.noise_by_height, memory)
    return moved


def turned(x: Columns, turn_rad: float, focal_px: float, centre_px: float) -> Columns:
    """Tell where columns x [px] lie after the camera has turned to the left, which moves them to the right.

    The thesis leaves the robot's motion to chance; its turn is known from odometry and need not be.
    """
    tangent, slope = math.tan(turn_rad), (x - centre_px) / focal_px
    moved: Columns = centre_px + focal_px * (slope + tangent) / (1 - slope * tangent)
    return moved


def noise_per_step(dt_s: float, size: float, config: MotionConfig) -> Floats:
    """Give the amplitudes (5,) of the random walk in d, vx, vy, vw, vh over one step, the last entries of B.

    The sources mean magnitudes a second: the velocities' entries reach the position times dt by way of A, so
    d's entry is multiplied by dt here.
    """
    amplitude = np.array(
        [config.noise_d * dt_s, config.noise_x, config.noise_y, config.noise_w, config.noise_h]
    )
    return (size * amplitude).astype(np.float32)


@njit(cache=True, nogil=True)
def _predicted(
    state: Floats,
    noise: Floats,
    amplitude: Floats,
    dt_s: float,
    by_height: float,
    memory: Floats,
) -> Floats:
    result = np.empty_like(state)
    for i in range(len(state)):
        # by_height is the semi-height at which the amplitudes hold as they are; 0 keeps them for every size.
        scale = state[i, H] / by_height if by_height > 0 else 1.0
        for k in range(4):
            result[i, k] = state[i, k] + dt_s * state[i, VX + k]
            result[i, VX + k] = memory[k] * state[i, VX + k] + scale * amplitude[1 + k] * noise[i, 1 + k]
        result[i, D] = state[i, D] + scale * amplitude[0] * noise[i, 0]
    return result
