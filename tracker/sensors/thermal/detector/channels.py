"""Feature channels of an image: normalised grey, gradients and motion in cells.

Aggregated channel features (Dollár et al., Fast Feature Pyramids, PAMI 2014) without absolute grey: they are
invariant to a gain or an offset of the image, as long as the contrast is well above the noise.
"""

import math
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.networks.convolution import Buffer
from peopleboy.tracker.sensors.thermal.detector.window import CELL_PX

Cells = NDArray[np.float32]
Image = NDArray[np.float32]

GREY: Final = 0
GRADIENT: Final = 1
FIRST_DIRECTION: Final = 2
DIRECTIONS: Final = 6
MOTION: Final = FIRST_DIRECTION + DIRECTIONS
CHANNELS: Final = MOTION + 1
OVER: Final = 13
"""Rows of cells by which an image is extended above and below, for windows of truncated people."""
BESIDE: Final = 4
"""Columns of cells by which it is extended on either side."""

_SQUARES: Final = MOTION  # sums of squares are stored here before motion is
_NEAR: Final = 5  # [cells] neighbourhood in which gradients are normalised
_AROUND: Final = 21  # [cells] neighbourhood in which greys are normalised
_LEAST_GREY: Final = 1.0  # of 8 bits
_NOISES: Final = 1.5
_MOST_MOTION: Final = np.float32(3.0)
_ANGLE = math.pi * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
_COS = np.cos(2.0 * _ANGLE).astype(np.float32)
_SIN = np.sin(2.0 * _ANGLE).astype(np.float32)


def noise_of(grey: Image) -> float:
    """Estimate the standard deviation of an image's noise from the median second difference along rows."""
    rows = grey[::3]
    second = rows[:, 2::3] + rows[:, :-2:3] - 2.0 * rows[:, 1:-1:3]
    return float(np.median(np.abs(second))) / 0.6745 / math.sqrt(6.0)


def channels(grey: Image, change: Image, noise: float, buffer: Buffer | None = None) -> Cells:
    """Return the channels of an image's cells.

    Gradients are divided among 6 directions, mod 180 deg: a gradient of magnitude m and direction a
    contributes m max(0, 2 cos(2 (a - b)) - 1) to direction b, which is m for a = b, and 0 from 30 deg on.

    Args:
        grey: (2 h, 2 w) image.
        change: (h, w) change of the greys, one value per cell.
        noise: standard deviation of the image's noise.
        buffer: output memory; None to allocate it.

    Returns:
        (9, h + 26, w + 8): grey, gradient, 6 directions, motion; the border is replicated.
    """
    # binomial filter 1 2 1 in both directions
    smooth = np.asarray(cv2.GaussianBlur(grey, (3, 3), 0.0, borderType=cv2.BORDER_REFLECT_101), np.float32)
    rows, columns = change.shape
    cells = (buffer or Buffer()).take((CHANNELS, rows + 2 * OVER, columns + 2 * BESIDE))
    inner = cells[:, OVER:-OVER, BESIDE:-BESIDE]
    _sum_up(smooth, _COS, _SIN, cells)
    mean = cv2.blur(inner[GREY], (_AROUND, _AROUND))
    squares = cv2.blur(inner[_SQUARES], (_AROUND, _AROUND))
    strength = cv2.blur(inner[GRADIENT], (_NEAR, _NEAR))
    _relate(cells, change, mean, squares, strength, np.float32(_LEAST_GREY + _NOISES * noise))
    _spread(cells)
    return cells


@njit(cache=True, nogil=True, fastmath=True)
def _sum_up(smooth: Image, cos: Cells, sin: Cells, cells: Cells) -> None:  # pragma: no cover
    """Average within cells: grey, gradient, its directions, squared grey."""
    rows, columns = cells.shape[1] - 2 * OVER, cells.shape[2] - 2 * BESIDE
    wide, last = CELL_PX * columns, CELL_PX * rows - 1
    quarter = np.float32(1.0 / CELL_PX**2)
    half, one, tiny = np.float32(0.5), np.float32(1.0), np.float32(1e-12)
    size, even, odd = np.zeros(wide, np.float32), np.zeros(wide, np.float32), np.zeros(wide, np.float32)
    line = np.empty(wide, np.float32)
    for row in range(rows):
        for channel in range(CHANNELS):
            cells[channel, row + OVER] = 0.0
        grey, gradient = cells[GREY, row + OVER], cells[GRADIENT, row + OVER]
        squares = cells[_SQUARES, row + OVER]
        for y in range(CELL_PX * row, CELL_PX * row + CELL_PX):
            here, above, below = smooth[y], smooth[max(y - 1, 0)], smooth[min(y + 1, last)]
            for x in range(1, wide - 1):
                right = half * (here[x + 1] - here[x - 1])
                down = half * (below[x] - above[x])
                a, b = right * right, down * down
                m = math.sqrt(a + b + tiny)
                twice = (one + one) / m
                size[x] = m
                even[x] = (a - b) * twice
                odd[x] = right * down * (twice + twice)
            for k in range(DIRECTIONS):
                c, s = cos[k], sin[k]
                direction = cells[FIRST_DIRECTION + k, row + OVER]
                for x in range(wide):
                    line[x] = max(c * even[x] + s * odd[x] - size[x], np.float32(0.0)) * quarter
                for j in range(columns):
                    direction[j + BESIDE] += line[2 * j] + line[2 * j + 1]
            for j in range(columns):
                p, q = here[2 * j], here[2 * j + 1]
                grey[j + BESIDE] += (p + q) * quarter
                squares[j + BESIDE] += (p * p + q * q) * quarter
                gradient[j + BESIDE] += (size[2 * j] + size[2 * j + 1]) * quarter


@njit(cache=True, nogil=True, fastmath=True)
def _relate(
    cells: Cells, change: Cells, mean: Cells, squares: Cells, strength: Cells, least: np.float32
) -> None:  # pragma: no cover
    """Normalise by the neighbourhood: grey and motion by its standard deviation, gradients by their mean."""
    rows, columns = change.shape
    zero, one, two = np.float32(0.0), np.float32(1.0), np.float32(2.0)
    share = np.empty(columns, np.float32)
    for i in range(rows):
        grey, motion = cells[GREY, i + OVER], cells[MOTION, i + OVER]
        for j in range(columns):
            spread = math.sqrt(max(squares[i, j] - mean[i, j] * mean[i, j], zero)) + two * least
            inverse = one / spread
            grey[j + BESIDE] = (grey[j + BESIDE] - mean[i, j]) * inverse
            motion[j + BESIDE] = min(change[i, j] * inverse, _MOST_MOTION)
            share[j] = one / (strength[i, j] + least)
        for channel in range(GRADIENT, MOTION):
            line = cells[channel, i + OVER]
            for j in range(columns):
                line[j + BESIDE] *= share[j]


@njit(cache=True, nogil=True, fastmath=True)
def _spread(cells: Cells) -> None:  # pragma: no cover
    """Smooth by 1 2 1 in both directions, and replicate the borders."""
    count, rows, columns = cells.shape[0], cells.shape[1] - 2 * OVER, cells.shape[2] - 2 * BESIDE
    quarter, half = np.float32(0.25), np.float32(0.5)
    line, above = np.empty(columns + 2, np.float32), np.empty(columns, np.float32)
    for channel in range(count):
        for j in range(columns):
            above[j] = cells[channel, OVER, BESIDE + j]
        for i in range(OVER, rows + OVER):
            here, below = cells[channel, i], cells[channel, min(i + 1, rows + OVER - 1)]
            for j in range(columns):
                line[j + 1] = quarter * (above[j] + below[j + BESIDE]) + half * here[j + BESIDE]
                above[j] = here[j + BESIDE]
            line[0], line[columns + 1] = line[1], line[columns]
            for j in range(columns):
                here[j + BESIDE] = quarter * (line[j] + line[j + 2]) + half * line[j + 1]
            for j in range(BESIDE):
                here[j], here[columns + BESIDE + j] = here[BESIDE], here[columns + BESIDE - 1]
        upper, lower = cells[channel, OVER], cells[channel, rows + OVER - 1]
        for i in range(OVER):
            before, after = cells[channel, i], cells[channel, rows + OVER + i]
            for j in range(cells.shape[2]):
                before[j], after[j] = upper[j], lower[j]
