"""How the floor lies in the panorama: how far away the floor of a row is, and in which row a distance is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import Calibration

Linear = NDArray[np.float32]

STEP_M: Final = 0.01
FARTHEST_M: Final = 40.0


@dataclass(frozen=True, slots=True, eq=False)
class FloorRows:
    """The floor round the robot as the rows show it. Arrays are read-only.

    Attributes:
        distance_m: (H,) of the floor seen in the middle of each row [m]; `FARTHEST_M` where there is none.
        row_at: (N,) row of the floor at 0, 1, 2, ... times `STEP_M`.
    """

    distance_m: Linear
    row_at: Linear


def floor_rows(calibration: Calibration, height: int) -> FloorRows:
    """Tell how the floor lies in the rows of a panorama with this calibration."""
    ahead = np.arange(0.0, FARTHEST_M + STEP_M, STEP_M)
    places = np.stack([ahead, np.zeros_like(ahead), np.zeros_like(ahead)], axis=1)
    row_at = np.nan_to_num(calibration.project(places)[:, 1], nan=10.0 * height)
    distance = np.interp(np.arange(height), row_at[::-1], ahead[::-1])
    return FloorRows(distance_m=_frozen(distance), row_at=_frozen(row_at))


def _frozen(array: NDArray[np.float64]) -> Linear:
    kept = array.astype(np.float32)
    kept.setflags(write=False)
    return kept
