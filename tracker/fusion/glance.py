"""What the depth image tells of somewhere in the thermal image, and the other way round."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import DEPTH, THERMAL, Floats, Frame, PinholeCalibration
from peopleboy.tracker.fusion.warmth import WARM
from peopleboy.tracker.rgbd.detection.depth_view import DepthView
from peopleboy.tracker.track import Box

_COLUMNS: Final = 8
_ROWS: Final = 16
_LEAST: Final = 12  # readings from which on shares mean anything


@dataclass(frozen=True, slots=True)
class Glance:
    """What stands where somebody may be.

    Attributes:
        readings: how many there are.
        nearer, beyond: shares of the readings before and behind the person.
        warm: share of its own readings that are as warm as people are; None if too few are in view.
        range_m: [m] median depth of its own; None for too few.
    """

    readings: int
    nearer: float
    beyond: float
    warm: float | None
    range_m: float | None


def glance_at(box: Box, z_m: float, reach_m: float, frame: Frame) -> Glance | None:
    """Look into a box [px] of the depth image for somebody at a depth, give or take a reach [m].

    Returns:
        None without a depth image, or where it shows nothing of that box.
    """
    calibration = frame.calibrations.get(DEPTH)
    if not isinstance(calibration, PinholeCalibration) or DEPTH not in frame.images:
        return None
    depth = frame.depth(DEPTH)
    pixels = _grid(box, (depth.shape[1], depth.shape[0]))
    z = depth[pixels[:, 1], pixels[:, 0]] / 1000.0
    pixels, z = pixels[z > 0.0], z[z > 0.0]
    if len(z) < _LEAST:
        return None
    own = np.abs(z - z_m) < reach_m
    return Glance(
        readings=len(z),
        nearer=float((z <= z_m - reach_m).mean()),
        beyond=float((z >= z_m + reach_m).mean()),
        warm=warm_share_of(pixels[own], z[own], frame),
        range_m=float(np.median(z[own])) if own.sum() >= _LEAST else None,
    )


def depth_of(place_m: Floats, frame: Frame) -> float:
    """Give the depth [m] of a place (2,) in the robot's frame as the depth camera measures it."""
    calibration = frame.calibrations[DEPTH]
    view = DepthView.of(calibration, DEPTH)
    pose = view.calibration.robot_from_camera
    point = np.array([*place_m, pose[2, 3]])
    return float((point - pose[:3, 3]) @ pose[:3, 2])


def _grid(box: Box, size: tuple[int, int]) -> np.ndarray[tuple[int, int], np.dtype[np.int64]]:
    """Give pixels (N, 2) spread over the middle of a box, as far as it lies in the image."""
    left, top, width, height = box
    u = left + width * (0.2 + 0.6 * (np.arange(_COLUMNS) + 0.5) / _COLUMNS)
    v = top + height * (0.05 + 0.8 * (np.arange(_ROWS) + 0.5) / _ROWS)
    pixels = np.rint(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)).astype(np.int64)
    inside = (pixels >= 0).all(axis=1) & (pixels < np.array(size)).all(axis=1)
    return pixels[inside]


def warm_share_of(pixels: NDArray[np.int64], z_m: Floats, frame: Frame) -> float | None:
    """Give the share of surfaces at pixels (N, 2) of the depth image, z_m (N,) deep, that is as warm as people.

    Returns:
        None where the thermal image shows too few of them.
    """
    calibration, thermal = frame.calibrations.get(DEPTH), frame.calibrations.get(THERMAL)
    if not isinstance(calibration, PinholeCalibration) or thermal is None or THERMAL not in frame.images:
        return None
    if len(z_m) < _LEAST:
        return None
    points = calibration.robot_from_camera[:3, 3] + calibration.rays(pixels.astype(np.float64)) * z_m[:, None]
    seen, image = np.rint(thermal.project(points)), frame.grey(THERMAL)
    inside = (seen >= 0.0).all(axis=1) & (seen < np.array(image.shape[::-1])).all(axis=1)
    if inside.sum() < _LEAST:
        return None
    columns, rows = seen[inside].astype(np.int64).T
    return float((image[rows, columns] > WARM).mean())
