"""Windows of a scan around each beam, with the same size in metres at every range."""

import math
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import ScanCalibration

Floats = NDArray[np.float64]
Inputs = NDArray[np.float32]

WINDOW: Final = 48
"""Samples of a window from left to right."""
SIZE: Final = WINDOW + 3
"""Inputs for each beam: the window, the range in two forms, and the distance between beams."""
HALF_M: Final = 0.8  # a stride and a half, so that both legs are inside
DEPTH_M: Final = 1.0  # differences in range are clipped
FARTHEST_M: Final = 10.0
_APART_M: Final = 0.1  # scale of the distance between beams


def cut_windows(ranges: NDArray[np.uint16], calibration: ScanCalibration) -> tuple[NDArray[np.int64], Inputs]:
    """Return the beams that are evaluated, and their inputs.

    Each sample is the nearest range in its direction, relative to that of the beam: so a thin leg stays
    visible however far away. Beams without a reading, or beyond 10 m, are not evaluated.

    Args:
        ranges: (N,) of a scan, from left to right [mm], 0 for no reading.
        calibration: of the range finder.

    Returns:
        (M,) numbers of the beams, and inputs (M, SIZE).
    """
    metres = np.where(ranges > 0, ranges / 1000.0, np.inf)
    beams = np.flatnonzero((metres > 0.0) & (metres <= FARTHEST_M))
    inputs = np.empty((len(beams), SIZE), np.float32)
    _cut(metres, beams, calibration.step_rad, inputs)
    near = metres[beams]
    inputs[:, WINDOW] = 1.0 / np.maximum(near, 0.1)
    inputs[:, WINDOW + 1] = near / FARTHEST_M
    inputs[:, WINDOW + 2] = near * calibration.step_rad / _APART_M
    return beams, inputs


@njit(cache=True, nogil=True)
def _cut(metres: Floats, beams: NDArray[np.int64], step_rad: float, inputs: Inputs) -> None:
    width = 2.0 * HALF_M / WINDOW
    for row in range(len(beams)):
        beam = beams[row]
        own = metres[beam]
        for k in range(WINDOW):
            left = k * width - HALF_M
            first = math.ceil(beam + math.atan2(left, own) / step_rad)
            last = math.ceil(beam + math.atan2(left + width, own) / step_rad) - 1
            if last < first:  # beams are farther apart than samples: take the nearest
                first = round(beam + math.atan2(left + 0.5 * width, own) / step_rad)
                last = first
            nearest = own + DEPTH_M
            for j in range(max(first, 0), min(last, len(metres) - 1) + 1):
                nearest = min(nearest, metres[j])
            inputs[row, k] = max((nearest - own) / DEPTH_M, -1.0)
