"""Geometry of the floor in the panorama: distances of rows, and rows of distances."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.geometry.small_matrices import solve

Linear = NDArray[np.float32]

FARTHEST_M: Final = 40.0
_THREE_M: Final = np.array([1.0, 2.0, 5.0])


@dataclass(frozen=True, slots=True, eq=False)
class FloorRows:
    """Relation between image rows and distances on the floor.

    Each column is a pinhole camera, so that the row of a floor point at distance d is (a d + b) / (d + c).

    Attributes:
        distance_m: (H,) floor distance at the middle of each row [m], read-only; `FARTHEST_M` above the
            horizon.
        horizon: a, the row of the horizon.
        slope: b [m].
        offset_m: c [m].
    """

    distance_m: Linear
    horizon: float
    slope: float
    offset_m: float


def floor_rows(calibration: Calibration, height: int) -> FloorRows:
    """Return the floor geometry of a panorama with this calibration."""
    zero, one = np.zeros(3), np.ones(3)
    rows = calibration.project(np.stack([_THREE_M, zero, zero], axis=1))[:, 1]
    lines = np.stack([_THREE_M, one, -rows], axis=1)
    horizon, slope, offset = solve(lines, rows * _THREE_M).tolist()
    below = np.arange(height) - horizon
    nearest = np.maximum(below, 1e-6)  # rows above the horizon show no floor
    distance = np.clip((slope - offset * (nearest + horizon)) / nearest, 0.0, FARTHEST_M).astype(np.float32)
    distance.setflags(write=False)
    return FloorRows(distance_m=distance, horizon=horizon, slope=slope, offset_m=offset)
