"""The mean of an image over head, torso and legs of many people at once."""

from typing import Any, Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.appearance.regions import (
    HEAD,
    PARTS,
    TORSO,
    align,
    first_pixel_after,
    part_rectangle,
)
from peopleboy.tracker.reproductions.contour.measurement.clutter_kernels import bodies_of
from peopleboy.tracker.reproductions.contour.particles import D, Floats, H, W, X, Y

WHITE: Final = 255.0


@njit(cache=True, nogil=True)
def write_part_means(
    means: Floats,
    column: int,
    state: Floats,
    alignment: Floats,
    integral: NDArray[np.integer[Any]],
    channels: tuple[int, ...],
    scale: Floats,
    least_seen: float,
) -> None:
    """Write the scaled mean of each of an image's C channels over each part of people, in place.

    The first moments of `ColourView.describe`, bit-identical, without intermediate arrays.

    Args:
        means: (N, 3, F) output, written from `column` on; NaN where too little of a part is in the image.
        column: of the first channel.
        state: (N, 9) contours in the thermal image.
        alignment: (2, 4) from the thermal image to this one.
        integral: (H + 1, W + 1, C, K) of `PowerSums`.
        channels: index of the first power of each channel among those of a pixel.
        scale: (3, F) factors on the means, 0..1.
        least_seen: least share of the part's area inside the image.
    """
    height, width = integral.shape[:2]
    sums, step = integral.reshape(-1), integral.shape[2] * integral.shape[3]
    twin, bodies = bodies_of(state)
    corners, share = np.empty((4, len(state)), dtype=np.int32), np.empty(len(state))
    total = np.empty((len(channels), len(state)), dtype=sums.dtype)
    mean = np.empty(len(state), dtype=np.float32)
    for first, end, rows in ((HEAD, TORSO, np.arange(len(state))), (TORSO, PARTS, bodies)):
        shape = _columns(state, rows)
        for part in range(first, end):
            _locate(corners, share, shape, part, alignment, width - 1, height - 1, least_seen)
            _add_up(total, sums, corners, step, channels, len(rows))
            for c in range(len(channels)):
                factor, counted = scale[part, column + c], total[c]
                for n in range(np.uint64(len(rows))):
                    mean[n] = np.float32(counted[n] * share[n] / WHITE) * factor
                for n in range(np.uint64(len(rows))):
                    means[np.uint64(rows[n]), part, column + c] = mean[n]
    for i in range(len(state)):
        if twin[i] >= 0:  # only the head has another position for another d
            for part in range(TORSO, PARTS):
                for c in range(column, column + len(channels)):
                    means[i, part, c] = means[twin[i], part, c]


@njit(cache=True, nogil=True)
def _columns(state: Floats, rows: NDArray[np.int64]) -> Floats:
    """Return x, y, w, h and d (5, M) of the samples (N, 9) in some rows."""
    shape = np.empty((5, len(rows)), dtype=np.float32)
    for n in range(len(rows)):
        i = rows[n]
        shape[0, n], shape[1, n], shape[2, n] = state[i, X], state[i, Y], state[i, W]
        shape[3, n], shape[4, n] = state[i, H], state[i, D]
    return shape


@njit(cache=True, nogil=True)
def _add_up(
    total: NDArray[np.integer[Any]],
    sums: NDArray[np.integer[Any]],
    corners: NDArray[np.int32],
    step: int,
    channels: tuple[int, ...],
    count: int,
) -> None:
    """Sum channels (C, M) over the first parts (M,), with corners as in `_locate`."""
    # Unsigned, as numba would otherwise check for negative indices.
    for n in range(np.uint64(count)):
        a, b = np.uint64(corners[0, n]) * np.uint64(step), np.uint64(corners[1, n]) * np.uint64(step)
        c, d = np.uint64(corners[2, n]) * np.uint64(step), np.uint64(corners[3, n]) * np.uint64(step)
        for k in range(len(channels)):
            at = np.uint64(channels[k])
            total[np.uint64(k), n] = sums[a + at] + sums[b + at] - (sums[c + at] + sums[d + at])


# Without NumPy's rules a kernel would test every division.
@njit(cache=True, nogil=True, error_model="numpy")
def _locate(
    corners: NDArray[np.int32],
    share: NDArray[np.float64],
    shape: Floats,
    part: int,
    alignment: Floats,
    width: int,
    height: int,
    least_seen: float,
) -> None:
    """Locate one part of people in an image of a given size, vectorised and without branches.

    Args:
        corners: output (4, M) pixels of the integral image: lower right and upper left, which are added, and
            upper right and lower left, which are subtracted.
        share: output (M,) one pixel's share of the part's mean; NaN where too little of it is in the image.
        shape: (5, M) from `_columns`.
        part: index of the part.
        alignment: (2, 4) from the thermal image to this one.
        width: of the image.
        height: of the image.
        least_seen: least share of the part's area inside the image.
    """
    none, most_right, most_down = np.int32(0), np.int32(width), np.int32(height)
    columns = np.int32(width + 1)
    # Unsigned, as numba would otherwise check for negative indices.
    for n in range(np.uint64(shape.shape[1])):
        x, y, w, h, d = shape[0, n], shape[1, n], shape[2, n], shape[3, n], shape[4, n]
        edges = align(alignment, part_rectangle(x, y, w, h, d, part), h)
        left, top = first_pixel_after(edges[0]), first_pixel_after(edges[1])
        right, bottom = first_pixel_after(edges[2]), first_pixel_after(edges[3])
        wide, tall = np.int32(right - left), np.int32(bottom - top)
        area = np.float64(max(wide, none)) * np.float64(max(tall, none))
        left, top = min(max(left, none), most_right), min(max(top, none), most_down)
        right, bottom = max(left, min(right, most_right)), max(top, min(bottom, most_down))
        # Cast to 32 bits at once, or numba would compute with 64.
        pixels = np.int32((right - left) * (bottom - top))
        share[n] = 1.0 / pixels if (pixels > 0) & (pixels >= least_seen * area) else np.nan
        upper, lower = np.int32(top * columns), np.int32(bottom * columns)
        corners[0, n], corners[1, n] = np.int32(lower + right), np.int32(upper + left)
        corners[2, n], corners[3, n] = np.int32(upper + right), np.int32(lower + left)
