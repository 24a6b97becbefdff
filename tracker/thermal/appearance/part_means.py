"""The mean of an image over head, torso and legs of many people at once."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.appearance.alignment import align
from peopleboy.tracker.thermal.appearance.regions import (
    HEAD,
    PARTS,
    Rectangle,
    first_pixel_after,
    part_rectangle,
)
from peopleboy.tracker.thermal.particles import Floats, H, twin_of

WHITE: Final = 255.0


# Without numpy's rules a kernel would test every division.
@njit(cache=True, nogil=True, error_model="numpy")
def write_part_means(
    means: Floats,
    column: int,
    state: Floats,
    alignment: Floats,
    integral: NDArray[np.integer[Any]],
    scale: Floats,
    least_seen: float,
) -> None:
    """Write the scaled mean of each of an image's C channels over each part of people, in place.

    What `ColourView.describe` says as the first moments, to the last bit, without arrays in between.

    Args:
        means: (N, 3, F) whose columns from `column` on take the means; NaN where too little of a part is in
            the image.
        column: of the first channel.
        state: (N, 9) contours in the thermal image.
        alignment: (2, 4) from the thermal image to this one.
        integral: (H + 1, W + 1, C, K) of `PowerSums`.
        scale: (3, F) by which the means, 0..1, are multiplied.
        least_seen: share of the part's area that must lie in the image.
    """
    height, width, channels, degree = integral.shape
    height, width, sums, step = height - 1, width - 1, integral.reshape(-1), channels * degree
    for i in range(len(state)):
        twin = twin_of(state, i)
        for part in range(PARTS):
            if twin >= 0 and part != HEAD:  # nothing else lies elsewhere for another d
                means[i, part, column : column + channels] = means[twin, part, column : column + channels]
                continue
            rectangle = align(alignment, part_rectangle(state[i], part), state[i, H])
            left, top, right, bottom = _within(rectangle, width, height)
            pixels = (right - left) * (bottom - top)
            if pixels == 0 or pixels < least_seen * _area(rectangle):
                for c in range(channels):
                    means[i, part, column + c] = np.nan
                continue
            share, above, below = 1.0 / pixels, top * (width + 1), bottom * (width + 1)
            for c in range(channels):
                total = (
                    _sum_at(sums, (below + right) * step + c * degree)
                    + _sum_at(sums, (above + left) * step + c * degree)
                    - _sum_at(sums, (above + right) * step + c * degree)
                    - _sum_at(sums, (below + left) * step + c * degree)
                )
                mean = np.float32(total * share / WHITE)
                means[i, part, column + c] = mean * scale[part, column + c]


@njit(cache=True, nogil=True)
def _sum_at(sums: NDArray[np.integer[Any]], at: int) -> int:
    # Unsigned, as numba would ask of every other number whether it counts from the end.
    return int(sums[np.uint64(at)])


@njit(cache=True, nogil=True)
def _within(rectangle: Rectangle, width: int, height: int) -> tuple[int, int, int, int]:
    """Cut the pixels of a rectangle down to an image; none are left of one outside."""
    left, right = _clamped(rectangle[0], width), _clamped(rectangle[2], width)
    top, bottom = _clamped(rectangle[1], height), _clamped(rectangle[3], height)
    return left, top, max(left, right), max(top, bottom)


@njit(cache=True, nogil=True)
def _clamped(edge: np.float32, last: int) -> int:
    return min(max(int(first_pixel_after(edge)), 0), last)


@njit(cache=True, nogil=True)
def _area(rectangle: Rectangle) -> int:
    """Count the pixels of a rectangle, also those outside of the image."""
    left, top, right, bottom = rectangle
    wide = int(first_pixel_after(right)) - int(first_pixel_after(left))
    tall = int(first_pixel_after(bottom)) - int(first_pixel_after(top))
    return max(wide, 0) * max(tall, 0)
