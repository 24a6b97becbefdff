"""Samples that were drawn from the same one, whose bodies need to be looked at once."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.thermal.particles import Floats, H, W, X, Y


@njit(cache=True, nogil=True)
def twin_of(state: Floats, i: int) -> int:
    """Find one of the two samples before the i-th whose body is the same; negative if there is none.

    Samples (N, 9) drawn from the same one lie together and differ in d alone, but for one in every few that
    is tried at another size.
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
    """Find the twins (N,) of samples (N, 9) by `twin_of`, and the rows (M,) of those that have none."""
    twin, rows, count = np.empty(len(state), dtype=np.int64), np.empty(len(state), dtype=np.int64), 0
    for i in range(len(state)):
        twin[i] = twin_of(state, i)
        if twin[i] < 0:
            rows[count] = i
            count += 1
    return twin, rows[:count]
