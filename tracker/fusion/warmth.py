"""How much of what stands somewhere is as warm as people are: depth tells where to look in the thermal image."""

from __future__ import annotations

from typing import Final

import numpy as np

from peopleboy.tracker.frame import DEPTH, THERMAL, Floats, Frame, PinholeCalibration
from peopleboy.tracker.rgbd.detection.pre_detection import PreDetection

WARM: Final = 255.0 * (25.0 - 24.0) / (36.0 - 24.0)
"""Grey from which on something is as warm as people are: 25 degC in an image of 24 to 36 degC."""

LEAST_SHARE: Final = 0.3
"""Share of warm pixels from which on something is a person."""

_COLUMNS: Final = 10
_ROWS: Final = 20
_REACH_M: Final = 0.5  # from the depth that was found, within which pixels belong to it
_LEAST_PIXELS: Final = 20


def is_warm(found: PreDetection, frame: Frame) -> bool:
    """Tell whether what was found in the depth image is a person by its heat."""
    return warm_share(found, frame) > LEAST_SHARE


def warm_share(found: PreDetection, frame: Frame) -> float:
    """Give the share of what was found in the depth image that is as warm as people are.

    Returns:
        0..1; 0 where the thermal image does not show it, or there is none.
    """
    ours, theirs = frame.calibrations.get(DEPTH), frame.calibrations.get(THERMAL)
    has_both = isinstance(ours, PinholeCalibration) and THERMAL in frame.images
    if not has_both or theirs is None:
        return 0.0
    points = _points(found, frame.depth(DEPTH), ours)
    seen = np.rint(theirs.project(points))
    image = frame.grey(THERMAL)
    height, width = image.shape
    inside = (seen >= 0.0).all(axis=1) & (seen[:, 0] < width) & (seen[:, 1] < height)
    if inside.sum() < _LEAST_PIXELS:
        return 0.0
    columns, rows = seen[inside].astype(np.int64).T
    return float((image[rows, columns] > WARM).mean())


def _points(found: PreDetection, depth: np.ndarray, calibration: PinholeCalibration) -> Floats:
    """Give points (N, 3) of its surface in the robot's frame, by a grid over its box."""
    left, top, width, height = found.box
    u = left + (np.arange(_COLUMNS) + 0.5) / _COLUMNS * width
    v = top + (np.arange(_ROWS) + 0.5) / _ROWS * height
    columns, rows = (grid.ravel() for grid in np.meshgrid(u, v))
    rows_in = np.clip(rows.astype(np.int64), 0, depth.shape[0] - 1)
    columns_in = np.clip(columns.astype(np.int64), 0, depth.shape[1] - 1)
    z = depth[rows_in, columns_in] / 1000.0
    own = (z > 0.0) & (np.abs(z - found.z_m) < _REACH_M)
    rays = calibration.rays(np.stack([columns[own], rows[own]], axis=1))
    return np.asarray(calibration.robot_from_camera[:3, 3] + rays * z[own, None])
