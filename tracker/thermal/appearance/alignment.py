"""From places in the thermal image to places in the colour image."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numba import njit

from peopleboy.tracker.thermal.appearance.regions import Rectangle
from peopleboy.tracker.thermal.colour_config import Affine
from peopleboy.tracker.thermal.particles import Floats


@lru_cache(maxsize=16)
def alignment(
    thermal_shape: tuple[int, int], colour_shape: tuple[int, int], affine: Affine, parallax: float
) -> Floats:
    """Give equation 6.1 in pixels for images of given sizes, its parallax included.

    Pixel (u, v) has its centre at the shares (u + 1/2) / W, (v + 1/2) / H.

    Returns:
        (2, 4) that maps thermal u, v, h, 1 [px] to colour x, y [px]; h is the semi-height of the person who
        is looked at. Read-only.
    """
    p1, p2, p3, p4, p5, p6 = affine
    to_share = np.diag([1 / thermal_shape[1], 1 / thermal_shape[0], 1 / thermal_shape[1], 1.0])
    to_share[:2, 3] = 0.5 * np.diag(to_share)[:2]
    to_pixel = np.diag([colour_shape[1], colour_shape[0]])
    shares = np.array([[p2, p3, parallax, p1], [p5, p6, 0.0, p4]])
    matrix: Floats = (to_pixel @ shares @ to_share - np.array([[0, 0, 0, 0.5]])).astype(np.float32)
    matrix.setflags(write=False)
    return matrix


@njit(cache=True, nogil=True)
def align(matrix: Floats, rectangle: Rectangle, height: np.float32) -> Rectangle:
    """Map a rectangle of the thermal image to an upright one of the colour image.

    A sheared map makes parallelograms; their place is that of their centre, and their size that of their
    middle lines.

    Args:
        matrix: of `alignment`.
        rectangle: left, top, right, bottom [px].
        height: semi-height h [px] of the person it belongs to.
    """
    half = np.float32(0.5)
    left, top, right, bottom = rectangle
    u, v = half * (left + right), half * (top + bottom)
    x = matrix[0, 0] * u + matrix[0, 1] * v + (matrix[0, 2] * height + matrix[0, 3])
    y = matrix[1, 0] * u + matrix[1, 1] * v + (matrix[1, 2] * height + matrix[1, 3])
    wide, tall = half * matrix[0, 0] * (right - left), half * matrix[1, 1] * (bottom - top)
    return x - wide, y - tall, x + wide, y + tall


@njit(cache=True, nogil=True)
def aligned(matrix: Floats, rectangles: Floats, height: Floats) -> Floats:
    """Map rectangles (N, P, 4) of people with semi-heights (N,), as `align` does for one."""
    result = np.empty_like(rectangles)
    for i in range(rectangles.shape[0]):
        for p in range(rectangles.shape[1]):
            left, top, right, bottom = rectangles[i, p]
            result[i, p] = align(matrix, (left, top, right, bottom), height[i])
    return result
