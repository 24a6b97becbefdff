"""The numbers of observations in many worlds (numba kernels)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.physics.solid_shapes import Array
from peopleboy.sim.robot.robot_body import WHEEL_DISTANCE_M
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.tracker.boxes import image_shares

_image_shares = njit(cache=True)(image_shares)


@njit(cache=True, nogil=True)
def tell_motions(starts: Array, now: Array, wheels: Array, found: NDArray[np.float32]) -> None:
    """Fill `odometry`.

    Args:
        starts: (G, 3) x, y [m], heading [rad] by odometry at the start.
        now: (G, 3) the same now.
        wheels: (G, 2) [m/s] rim speeds, left and right.
        found: (G, 6) gets x, y [m] from the start in its frame, cosine and sine of the heading since then,
            forward speed [m/s], turn rate [rad/s].
    """
    for row in range(len(starts)):
        cos, sin = math.cos(starts[row, 2]), math.sin(starts[row, 2])
        dx, dy = now[row, 0] - starts[row, 0], now[row, 1] - starts[row, 1]
        turned = now[row, 2] - starts[row, 2]
        left, right = wheels[row, 0], wheels[row, 1]
        found[row, 0], found[row, 1] = cos * dx + sin * dy, cos * dy - sin * dx
        found[row, 2], found[row, 3] = math.cos(turned), math.sin(turned)
        found[row, 4], found[row, 5] = (left + right) / 2.0, (right - left) / WHEEL_DISTANCE_M


@njit(cache=True, nogil=True)
def fill_tracks(
    people: Array,
    borders: Numbers,
    width: int,
    height: int,
    farthest: float,
    lowest: tuple[float, ...],
    highest: tuple[float, ...],
    found: NDArray[np.float32],
) -> None:
    """Fill `tracks`, the tallest first, and nobody into the rest.

    Args:
        people: (Q, 7) id, box [px], confidence and is_visible, of all worlds; nobody by a box of NaN.
        borders: (G, 2) where those of each world begin and end.
        width: [px] of the image.
        height: [px].
        farthest: [half image widths] from the middle of the image, beyond which nobody is told.
        lowest: number of each column.
        highest: number of each column.
        found: (G, 5 * 7).
    """
    columns = people.shape[1]
    told = np.empty(people.shape)
    found[:] = 0.0
    for row in range(len(borders)):
        first, end = borders[row, 0], borders[row, 1]
        for q in range(first, end):
            left, top, across, up = people[q, 1], people[q, 2], people[q, 3], people[q, 4]
            shares = _image_shares((left, top, across, up), width, height)
            told[q, 0], told[q, 5], told[q, 6] = people[q, 0], people[q, 5], people[q, 6]
            told[q, 1], told[q, 2], told[q, 3], told[q, 4] = shares
            if not abs(told[q, 1]) <= farthest:
                told[q, 2] = -np.inf
        for place in range(min(found.shape[1] // columns, end - first)):
            tallest = first + np.argmax(told[first:end, 2])
            if told[tallest, 2] == -np.inf:
                break
            for k in range(columns):
                number = min(max(told[tallest, k], lowest[k]), highest[k])
                found[row, place * columns + k] = number
            told[tallest, 2] = -np.inf
