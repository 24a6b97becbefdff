"""Kernels that measure the clutter of an image."""

from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.particles import Floats, H, W, X, Y

_MOST: Final = 255  # [grey] greatest difference of pixels


@njit(cache=True, nogil=True)
def differences_in(image: NDArray[np.uint8], apart: int, stride: int) -> NDArray[np.uint8]:
    """Return histograms of differences of pixels of an image (H, W) at a distance, right and below, (N,).

    Of the rows for the one, and of the columns for the other, every `stride`-th is looked at.
    """
    height, width = image.shape
    rows, columns = -(-height // stride), -(-width // stride)
    wide, tall = max(width - apart, 0), max(height - apart, 0)
    differences, at = np.empty(rows * wide + tall * columns, dtype=np.uint8), 0
    for v in range(0, height, stride):
        _subtract(differences[at : at + wide], image[v, width - wide :], image[v])
        at += wide
    thin = np.empty((height, columns), dtype=np.uint8)
    for v in range(height):
        for u in range(np.uint64(columns)):
            thin[v, u] = image[v, u * np.uint64(stride)]
    for v in range(tall):
        _subtract(differences[at : at + columns], thin[v + apart], thin[v])
        at += columns
    return differences


@njit(cache=True, nogil=True)
def _subtract(difference: NDArray[np.uint8], one: NDArray[np.uint8], other: NDArray[np.uint8]) -> None:
    for u in range(len(difference)):
        difference[u] = max(one[u], other[u]) - min(one[u], other[u])


@njit(cache=True, nogil=True)
def least_above(differences: NDArray[np.uint8], share: float) -> int:
    """Return the least difference not exceeded by a share of the pixels (N,); it is mostly small."""
    wanted, low, high = share * len(differences), -1, 0
    while high < _MOST and _count_up_to(differences, high) < wanted:
        low, high = high, min(2 * high + 1, _MOST)
    while high - low > 1:
        middle = (low + high) // 2
        if _count_up_to(differences, middle) < wanted:
            low = middle
        else:
            high = middle
    return high


@njit(cache=True, nogil=True)
def _count_up_to(differences: NDArray[np.uint8], most: int) -> int:
    count, limit = np.int32(0), np.uint8(most)
    for i in range(len(differences)):
        count += np.int32(differences[i] <= limit)
    return int(count)


# Samples drawn from the same one, whose bodies need to be measured only once.


@njit(cache=True, nogil=True)
def twin_of(state: Floats, i: int) -> int:
    """Return one of the two samples before the i-th with the same body; negative if there is none.

    Samples (N, 9) drawn from the same one are adjacent and differ in d alone, except for a few resized ones.
    """
    for before in (i - 1, i - 2):
        if before >= 0 and (
            state[i, X] == state[before, X]
            and state[i, Y] == state[before, Y]
            and state[i, W] == state[before, W]
            and state[i, H] == state[before, H]
        ):
            return before
    return -1


@njit(cache=True, nogil=True)
def bodies_of(state: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the twins (N,) of samples (N, 9) by `twin_of`, and the rows (M,) of those without one."""
    twin, rows, count = np.empty(len(state), dtype=np.int64), np.empty(len(state), dtype=np.int64), 0
    for i in range(len(state)):
        twin[i] = twin_of(state, i)
        if twin[i] < 0:
            rows[count] = i
            count += 1
    return twin, rows[:count]
