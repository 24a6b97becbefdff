"""How much of what stands somewhere is as warm as people are: depth tells where the thermal one shows it."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import DEPTH, THERMAL, Floats, Frame, PinholeCalibration
from peopleboy.tracker.rgbd.detection.pre_detection import PreDetection
from peopleboy.tracker.track import Box

WARM: Final = 255.0 * (25.0 - 24.0) / (36.0 - 24.0)
"""Grey from which on something is as warm as people are: 25 degC in an image of 24 to 36 degC."""

LEAST_SHARE: Final = 0.3
"""Share of warm pixels from which on something of the size of a human is one."""

_COLUMNS: Final = 10
_ROWS: Final = 20
_REACH_M: Final = 0.5  # from the depth that was found, within which pixels belong to it
_LEAST_PIXELS: Final = 12


def is_warm(found: PreDetection, frame: Frame) -> bool:
    """Tell whether what was found in the depth image is a person by its heat."""
    pixels = grid(found.box, _COLUMNS, _ROWS, frame)
    z_m = depths_at(pixels, frame)
    own = (z_m > 0.0) & (np.abs(z_m - found.z_m) < _REACH_M)
    share = warm_share(pixels[own], z_m[own], frame)
    return share is not None and share > LEAST_SHARE


def warm_share(pixels: NDArray[np.int64], z_m: Floats, frame: Frame) -> float | None:
    """Give the share of surfaces that is as warm as people are.

    Args:
        pixels: (N, 2) of the depth image that show them.
        z_m: (N,) their depths [m].
        frame: with both images.

    Returns:
        0..1; None where the thermal image shows too few of them.
    """
    ours, theirs = frame.calibrations.get(DEPTH), frame.calibrations.get(THERMAL)
    if not isinstance(ours, PinholeCalibration) or theirs is None or THERMAL not in frame.images:
        return None
    points = ours.robot_from_camera[:3, 3] + ours.rays(pixels.astype(np.float64)) * z_m[:, None]
    seen, image = np.rint(theirs.project(points)), frame.grey(THERMAL)
    inside = (seen >= 0.0).all(axis=1) & (seen < np.array(image.shape[::-1])).all(axis=1)
    if inside.sum() < _LEAST_PIXELS:
        return None
    columns, rows = seen[inside].astype(np.int64).T
    return float((image[rows, columns] > WARM).mean())


def grid(box: Box, columns: int, rows: int, frame: Frame) -> NDArray[np.int64]:
    """Give pixels (N, 2) spread evenly over a box [px], as far as it lies in the depth image."""
    left, top, width, height = box
    u = left + width * (np.arange(columns) + 0.5) / columns
    v = top + height * (np.arange(rows) + 0.5) / rows
    pixels = np.rint(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)).astype(np.int64)
    size = np.array(frame.depth(DEPTH).shape[::-1])
    return np.asarray(pixels[((pixels >= 0) & (pixels < size)).all(axis=1)])


def depths_at(pixels: NDArray[np.int64], frame: Frame) -> Floats:
    """Give the depths (N,) [m] at pixels (N, 2) of the depth image; 0 where none is read."""
    return np.asarray(frame.depth(DEPTH)[pixels[:, 1], pixels[:, 0]] / 1000.0)
