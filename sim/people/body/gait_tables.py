"""Where a gait is tabulated, and how its tables are looked up (numba kernels)."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

PHASES: Final = 48
AMPLITUDES: Final = np.array([0.0, 0.15, 0.3, 0.5, 0.75, 1.0, 1.2, 1.4])
_FULL_SPEED_M_S = 1.1  # a stride as long as the clip's, for a leg as long as the clip's


@njit(cache=True, nogil=True)
def amplitude_of(speed_m_s: float, root_scale: float) -> float:
    """Length of the stride against the clip's at a walking speed, for legs of a scale of this root.

    It grows with the root of speed, as cadence does.
    """
    return min(math.sqrt(abs(speed_m_s) / (_FULL_SPEED_M_S * root_scale)), 1.4)


@njit(cache=True, nogil=True)
def gait_pose(
    rotations: Array, sway: Array, phase: float, amplitude: float, turns: Array
) -> tuple[float, float]:
    """Look a pose up in tables (A, P, 17, 3) and (A, P, 3) of `Gait`, at a phase [cycles].

    Returns:
        The pelvis' offset [m] to the front and to the left; `turns` (17, 3) gets the rotation vectors.
    """
    last = len(AMPLITUDES) - 1
    i = last
    while i > 0 and amplitude < AMPLITUDES[i]:
        i -= 1
    row = float(i)
    if i < last:
        row = 1.0 / (AMPLITUDES[i + 1] - AMPLITUDES[i]) * (amplitude - AMPLITUDES[i]) + i
    column = (phase % 1.0) * PHASES
    i, j = min(int(row), last - 1), int(column) % PHASES
    di, dj, following = row - i, column - int(column), (j + 1) % PHASES
    turns[:] = 0.0
    front = left = 0.0
    for corner in range(4):
        a, p = i + corner // 2, following if corner % 2 else j
        weight = (di if corner // 2 else 1.0 - di) * (dj if corner % 2 else 1.0 - dj)
        front += weight * sway[a, p, 0]
        left += weight * sway[a, p, 1]
        for bone in range(turns.shape[0]):
            for axis in range(3):
                turns[bone, axis] += weight * rotations[a, p, bone, axis]
    return front, left
