"""Regions of head, torso and legs: upright rectangles from the elliptic contour."""

from functools import lru_cache

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.colour_config import Affine
from peopleboy.tracker.reproductions.contour.particles import D, Floats, H, W, X, Y

Bounds = NDArray[np.int32]
HEAD, TORSO, LEGS = range(3)
PARTS = 3

# Per part: its offset as a share of d; half its width in w and in h; its top and bottom below the body's
# centre in h. The thesis shows the rectangles in a figure only (6.2 b); these contain hardly anything but the
# part, except legs in mid-stride.
_LAYOUT = np.array(
    [
        [1.0, 0.0, 0.12, -1.40, -1.05],
        [0.0, 0.60, 0.0, -0.75, 0.10],
        [0.0, 0.45, 0.0, 0.25, 1.65],
    ],
    dtype=np.float32,
)


Rectangle = tuple[np.float32, np.float32, np.float32, np.float32]
"""Left, top, right, bottom [px]."""


@njit(cache=True, nogil=True)
def part_rectangle(
    x: np.float32, y: np.float32, w: np.float32, h: np.float32, d: np.float32, part: int
) -> Rectangle:
    """Return the rectangle of one part of a person; right and bottom are never less than left and top.

    Source: thesis, section 6.1.2 and figure 6.2 b.
    """
    w, h = max(w, np.float32(0)), max(h, np.float32(0))
    middle = x + _LAYOUT[part, 0] * d
    half = _LAYOUT[part, 1] * w + _LAYOUT[part, 2] * h
    top, bottom = y + _LAYOUT[part, 3] * h, y + _LAYOUT[part, 4] * h
    return middle - half, top, middle + half, bottom


@njit(cache=True, nogil=True)
def part_rectangles(state: Floats) -> Floats:
    """Return head, torso and legs (N, 3, 4) of people (N, 9), as `part_rectangle` does for one."""
    result = np.empty((len(state), PARTS, 4), dtype=np.float32)
    for i in range(len(state)):
        for part in range(PARTS):
            result[i, part] = part_rectangle(
                state[i, X], state[i, Y], state[i, W], state[i, H], state[i, D], part
            )
    return result


@njit(cache=True, nogil=True)
def first_pixel_after(edge: np.float32) -> np.int32:
    """Return the first column or row whose pixels' centres are not left of, or above, an edge [px].

    Clipped far beyond any image, so that it is an int32 for any sample.
    """
    return np.int32(np.ceil(min(max(edge, np.float32(-1e6)), np.float32(1e6))))


@njit(cache=True, nogil=True)
def pixel_bounds(rectangles: Floats) -> Bounds:
    """Return the pixels of rectangles (N, P, 4): those with their centre inside.

    Returns:
        (N P, 4) first column, first row, and those after the last ones; they may lie outside the image.
    """
    edges = rectangles.reshape(-1, 4)
    bounds = np.empty(edges.shape, dtype=np.int32)
    for i in range(len(edges)):
        for k in range(4):
            bounds[i, k] = first_pixel_after(edges[i, k])
    return bounds


@njit(cache=True, nogil=True)
def covered(bounds: Bounds, height: int, width: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Count the pixels of rectangles (M, 4), (M,) in an image of that size and (M,) also outside of it."""
    pixels, area = np.empty(len(bounds), dtype=np.int64), np.empty(len(bounds), dtype=np.int64)
    for i in range(len(bounds)):
        left, top, right, bottom = bounds[i]
        area[i] = np.int64(max(right - left, 0)) * max(bottom - top, 0)
        wide = min(right, width) - max(left, 0)
        pixels[i] = max(wide, 0) * max(min(bottom, height) - max(top, 0), 0)
    return pixels, area


# Conversion of positions from the thermal to the colour image.


@lru_cache(maxsize=16)
def alignment(
    thermal_shape: tuple[int, int], colour_shape: tuple[int, int], affine: Affine, parallax: float
) -> Floats:
    """Return equation 6.1 in pixels for images of given sizes, including its parallax.

    Pixel (u, v) has its centre at the shares (u + 1/2) / W, (v + 1/2) / H.

    Returns:
        (2, 4) that maps thermal u, v, h, 1 [px] to colour x, y [px]; h is the semi-height of the person.
        Read-only.
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

    A sheared map gives parallelograms; the result has their centre, and the size of their middle lines.

    Args:
        matrix: from `alignment`.
        rectangle: left, top, right, bottom [px].
        height: semi-height h [px] of its person.
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
