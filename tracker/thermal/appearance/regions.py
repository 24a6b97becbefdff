"""Where head, torso and legs of a person are: upright rectangles from the elliptic contour."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.particles import D, Floats, H, W, X, Y

Bounds = NDArray[np.int32]
HEAD, TORSO, LEGS = range(3)
PARTS = 3

# Per part: share of d by which it is displaced; half its width in w and in h; its top and bottom below the
# body's centre in h. The thesis shows the rectangles in a figure only (6.2 b); these hold hardly anything but
# the part they are named after, legs in mid-stride aside.
_LAYOUT = np.array(
    [
        [1.0, 0.0, 0.12, -1.40, -1.05],
        [0.0, 0.60, 0.0, -0.75, 0.10],
        [0.0, 0.45, 0.0, 0.25, 1.65],
    ],
    dtype=np.float32,
)


@njit(cache=True, nogil=True)
def part_rectangles(state: Floats) -> Floats:
    """Lay out head, torso and legs of people.

    Args:
        state: (N, 9) contours, thermal image.

    Returns:
        (N, 3, 4) left, top, right, bottom [px] of each part, right and bottom never less than left and top.

    Source: thesis, section 6.1.2 and figure 6.2 b.
    """
    result = np.empty((len(state), PARTS, 4), dtype=np.float32)
    for i in range(len(state)):
        w, h = max(state[i, W], np.float32(0)), max(state[i, H], np.float32(0))
        for part in range(PARTS):
            middle = state[i, X] + _LAYOUT[part, 0] * state[i, D]
            half = _LAYOUT[part, 1] * w + _LAYOUT[part, 2] * h
            result[i, part, 0], result[i, part, 2] = middle - half, middle + half
            result[i, part, 1] = state[i, Y] + _LAYOUT[part, 3] * h
            result[i, part, 3] = state[i, Y] + _LAYOUT[part, 4] * h
    return result


@njit(cache=True, nogil=True)
def pixel_bounds(rectangles: Floats) -> Bounds:
    """Tell which pixels rectangles (N, P, 4) cover: those with their centre inside.

    Returns:
        (N P, 4) first column, first row, and those after the last ones; they may lie outside the image.
    """
    # Far beyond any image and still an int32, whatever a stray sample asks for.
    return np.ceil(np.clip(rectangles, -1e6, 1e6)).astype(np.int32).reshape(-1, 4)


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
