"""Scores of boxes of one size at many positions, each from four sums of an integral image."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.attention.feature_maps import CELL_PX

Doubles = NDArray[np.float64]

MOST: float = 9.0
"""Squared difference, in standard deviations, at which the score saturates."""


@njit(cache=True, nogil=True)
def box_means(sums: Doubles, row: int, column: int, height: int, width: int) -> Doubles:
    """Return the means (C,) over a box from an integral image (rows + 1, columns + 1, C)."""
    low, right = row + height, column + width
    count = np.float64(height * width)
    total = sums[low, right] - sums[row, right] - sums[low, column] + sums[row, column]
    mean: Doubles = (total / count).astype(np.float64)
    return mean


@njit(cache=True, nogil=True)
def spreads(sums: Doubles, height: int, width: int, step: int) -> Doubles:
    """Return the standard deviations (C,) of the means of all boxes of one size, on a grid of positions."""
    count = 0
    first, second = np.zeros(sums.shape[2]), np.zeros(sums.shape[2])
    for row in range(0, sums.shape[0] - height, step):
        for column in range(0, sums.shape[1] - width, step):
            mean = box_means(sums, row, column, height, width)
            first += mean
            second += mean * mean
            count += 1
    first /= count
    spread: Doubles = np.sqrt(np.maximum(second / count - first * first, 1e-12))
    return spread


@njit(cache=True, nogil=True)
def likenesses(
    sums: Doubles,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    size: tuple[int, int],
    learned: Doubles,
    spread: Doubles,
    used: NDArray[np.bool_],
) -> Doubles:
    """Compare features (C,) of boxes of one size, at all rows (R,) and columns (L,), with learned ones.

    Returns:
        (R, L) 1 for equal features, near 0 for different ones; 0 for boxes that are not inside.
    """
    height, width = size
    found = np.zeros((len(rows), len(columns)))
    index = np.flatnonzero(used)
    count, over = height * width, 1.0 / spread
    for i in range(len(rows)):
        top, low = rows[i], rows[i] + height
        if top < 0 or low >= sums.shape[0]:
            continue
        for j in range(len(columns)):
            left, right = columns[j], columns[j] + width
            if left < 0 or right >= sums.shape[1]:
                continue
            total = 0.0
            for k in index:
                below = sums[low, right, k] - sums[low, left, k]
                mean = (below - sums[top, right, k] + sums[top, left, k]) / count
                off = (mean - learned[k]) * over[k]
                total += min(off * off, MOST)
            found[i, j] = np.exp(-total / max(len(index), 1))
    return found


@njit(cache=True, nogil=True)
def mean_scores(
    sums: Doubles, rows: NDArray[np.int64], columns: NDArray[np.int64], size: tuple[int, int]
) -> Doubles:
    """Return box means (R, C) from an integral image (rows + 1, columns + 1); 0 for boxes outside."""
    height, width = size
    found = np.zeros((len(rows), len(columns)))
    for i in range(len(rows)):
        top, low = rows[i], rows[i] + height
        if top < 0 or low >= sums.shape[0]:
            continue
        for j in range(len(columns)):
            left, right = columns[j], columns[j] + width
            if left >= 0 and right < sums.shape[1]:
                total = sums[low, right] - sums[top, right] - sums[low, left] + sums[top, left]
                found[i, j] = total / (height * width)
    return found


@njit(cache=True, nogil=True)
def pattern_scores(
    sums: NDArray[np.float32],
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    size: tuple[int, int],
    learned: NDArray[np.float32],
    weight: NDArray[np.float32],
) -> Doubles:
    """Return LA (R, C) of equation 5.13 for boxes; 0 for boxes that are not inside.

    The source subtracts an image position; its sum goes over the bins.
    """
    height, width = size
    found = np.zeros((len(rows), len(columns)))
    many = np.float32(1.0) / np.float32(height * width * CELL_PX * CELL_PX)
    for i in range(len(rows)):
        top, low = rows[i], rows[i] + height
        if top < 0 or low >= sums.shape[0]:
            continue
        for j in range(len(columns)):
            left, right = columns[j], columns[j] + width
            if left < 0 or right >= sums.shape[1]:
                continue
            total = 0.0
            for k in range(sums.shape[2]):
                below = sums[low, right, k] - sums[low, left, k]
                off = (below - sums[top, right, k] + sums[top, left, k]) * many - learned[k]
                total += off * off * weight[k]
            found[i, j] = max(1.0 - total, 0.0)
    return found
