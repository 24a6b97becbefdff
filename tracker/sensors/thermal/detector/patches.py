"""Features of a window: the mean of a rectangle of cells, or the difference of two such means.

They are computed from integral images (Viola and Jones, CVPR 2001; Dollár et al., Integral Channel Features,
BMVC 2009) of integers, so that no precision is lost in large images.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.sensors.thermal.detector.channels import CHANNELS, Cells
from peopleboy.tracker.sensors.thermal.detector.window import COLUMNS, ROWS

Sums = NDArray[np.int32]
"""(9, h + 1, w + 1): sums of all cells above and to the left, in units of `PART`."""

Layout = tuple[NDArray[np.uint32], Cells]
"""Offsets (N, 8) of the corners of patches in the sums, and the factors (N, 2) of both rectangles."""

PART: Final = np.float32(512.0)
CORNERS: Final = 8
"""Signs of the corners of two rectangles: last and first are added, the others subtracted."""


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Pairs of rectangles of cells in a window.

    Attributes:
        channel: (F,) uint8.
        first: (F, 4) uint8 row and column of the first cell, and those after the last.
        second: (F, 4) uint8 of the subtracted rectangle; all 0 for none.
    """

    channel: NDArray[np.uint8]
    first: NDArray[np.uint8]
    second: NDArray[np.uint8]

    def __len__(self) -> int:
        return len(self.channel)

    def corners(self, feature: NDArray[np.int32], high: int, wide: int) -> Layout:
        """Return offsets of patches (N,) in sums of `high` by `wide`, relative to a window's first cell."""
        offset, weight = np.empty((len(feature), CORNERS), np.uint32), np.empty((len(feature), 2), np.float32)
        _corners(feature, self.channel, self.first, self.second, high, wide, offset, weight)
        return offset, weight

    def of(self, sums: Sums, number: int) -> Cells:
        """Return a patch (N,) of windows whose sums are the columns of an array (9 * 21 * 11, N)."""
        offset, weight = self.corners(np.array([number], np.int32), ROWS + 1, COLUMNS + 1)
        result = np.empty(sums.shape[1], np.float32)
        _measure(sums, offset[0], weight[0], result)
        return result


def integrate(cells: Cells) -> Sums:
    """Return the integral images of channels (9, h, w)."""
    _, high, wide = cells.shape
    sums = np.empty((CHANNELS, high + 1, wide + 1), np.int32)
    _sum(cells, sums)
    return sums


def integrate_windows(windows: NDArray[np.float16]) -> Sums:
    """Return the integral images of windows (N, 1800), as columns (9 * 21 * 11, N)."""
    sums = np.empty((CHANNELS * (ROWS + 1) * (COLUMNS + 1), len(windows)), np.int32)
    for number, window in enumerate(windows):
        sums[:, number] = integrate(window.astype(np.float32).reshape(CHANNELS, ROWS, COLUMNS)).ravel()
    return sums


@njit(inline="always")
def patch(sums: Sums, at: np.uint32, corner: NDArray[np.uint32], by: Cells) -> np.float32:  # pragma: no cover
    """Return a patch of the window at a position in sums, from its corners and their factors."""
    one = sums[at + corner[0]] - sums[at + corner[1]] - sums[at + corner[2]] + sums[at + corner[3]]
    two = sums[at + corner[4]] - sums[at + corner[5]] - sums[at + corner[6]] + sums[at + corner[7]]
    return np.float32(np.float32(one) * by[0] - np.float32(two) * by[1])


@njit(cache=True, nogil=True)
def _measure(sums: Sums, corner: NDArray[np.uint32], by: Cells, result: Cells) -> None:  # pragma: no cover
    a, b, c, d = sums[corner[0]], sums[corner[1]], sums[corner[2]], sums[corner[3]]
    e, f, g, h = sums[corner[4]], sums[corner[5]], sums[corner[6]], sums[corner[7]]
    for k in range(len(result)):
        one, two = a[k] - b[k] - c[k] + d[k], e[k] - f[k] - g[k] + h[k]
        result[k] = np.float32(one) * by[0] - np.float32(two) * by[1]


@njit(cache=True, nogil=True)
def _sum(cells: Cells, sums: Sums) -> None:  # pragma: no cover
    channels, high, wide = cells.shape
    for channel in range(channels):
        sums[channel, 0] = 0
        for i in range(high):
            total, above, here = np.int32(0), sums[channel, i], sums[channel, i + 1]
            here[0] = 0
            for j in range(wide):
                total += np.int32(np.rint(cells[channel, i, j] * PART))
                here[j + 1] = above[j + 1] + total


@njit(cache=True, nogil=True)
def _corners(
    feature: NDArray[np.int32],
    channel: NDArray[np.uint8],
    first: NDArray[np.uint8],
    second: NDArray[np.uint8],
    high: int,
    wide: int,
    offset: NDArray[np.uint32],
    weight: Cells,
) -> None:  # pragma: no cover
    for k in range(len(feature)):
        number = feature[k]
        begin = np.uint32(channel[number]) * np.uint32(high * wide)
        for side in range(2):
            box = first[number] if side == 0 else second[number]
            top, left, bottom, right = np.int64(box[0]), np.int64(box[1]), np.int64(box[2]), np.int64(box[3])
            at = 4 * side
            offset[k, at] = begin + np.uint32(bottom * wide + right)
            offset[k, at + 1] = begin + np.uint32(top * wide + right)
            offset[k, at + 2] = begin + np.uint32(bottom * wide + left)
            offset[k, at + 3] = begin + np.uint32(top * wide + left)
            cells = (bottom - top) * (right - left)
            weight[k, side] = np.float32(1.0) / (PART * np.float32(cells)) if cells else np.float32(0.0)
