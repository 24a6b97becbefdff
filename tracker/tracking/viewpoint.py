"""Projection from metres around a camera to its image: people are upright lines on their feet.

The level frame has its origin in the camera: x to the right, y down, z ahead along the floor [m].
"""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.tracker.tracking.config import STATURE_M

Floats = NDArray[np.float64]

VIEW_ANGLE_DEG: Final = 44.0
"""Vertical field of view of an uncalibrated camera."""

NEAREST_M: Final = 0.3
_ROBOT_FROM_LEVEL: Final = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
_LEAST_DEPTH_M: Final = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Viewpoint:
    """Pose and intrinsics of a camera relative to its level frame.

    Attributes:
        focal_px: focal lengths along columns and rows.
        centre_px: principal point.
        camera_from_level: (3, 3) rotation.
        floor_m: depth of the floor below the camera; None if unknown.
    """

    focal_px: tuple[float, float]
    centre_px: tuple[float, float]
    camera_from_level: Floats
    floor_m: float | None

    @property
    def breadth(self) -> float:
        """Half-width of the field of view: the tangent of half the horizontal angle."""
        return (self.centre_px[0] + 0.5) / self.focal_px[0]

    @classmethod
    def of(cls, calibration: Calibration | None, shape: tuple[int, int]) -> "Viewpoint":
        """Make the viewpoint of a camera; an uncalibrated camera is assumed to be level.

        Args:
            calibration: of the camera; None if unknown.
            shape: rows and columns of its image [px].
        """
        if isinstance(calibration, PinholeCalibration):
            matrix = calibration.intrinsics
            return cls(
                (float(matrix[0, 0]), float(matrix[1, 1])),
                (float(matrix[0, 2]), float(matrix[1, 2])),
                calibration.robot_from_camera[:3, :3].T @ _ROBOT_FROM_LEVEL,
                calibration.position_m[2],
            )
        rows, columns = shape
        focal = rows / 2.0 / math.tan(math.radians(VIEW_ANGLE_DEG) / 2.0)
        return cls((focal, focal), ((columns - 1) / 2.0, (rows - 1) / 2.0), np.eye(3), None)

    def seen(self, feet_m: Floats, build: Floats) -> Floats:
        """Project people: (K, 3) middle column and rows of head and feet.

        Args:
            feet_m: (K, 3) positions of the feet.
            build: (K,) logarithm of the stature divided by the usual stature.
        """
        result = np.empty((len(feet_m), 3))
        _see(feet_m, build, self.camera_from_level, self.focal_px, self.centre_px, result)
        return result

    def slopes(self, feet_m: Floats, build: Floats) -> Floats:
        """Return the derivatives (K, 3, 4) of `seen` by x, y, z of the feet, and the build."""
        slope = np.empty((len(feet_m), 3, 4))
        _slope(feet_m, build, self.camera_from_level, self.focal_px, slope)
        return slope

    def feet(self, boxes: Floats) -> Floats:
        """Return the positions (K, 3) of people with these boxes (K, 4), assuming the usual stature."""
        left, top, width, height = boxes.T
        aside = self._lean(boxes) * height / 2.0
        rays = self._rays(np.stack([left + width / 2.0 + aside, top + height], axis=1))
        heads = self._rays(np.stack([left + width / 2.0 - aside, top], axis=1))
        # Both rays meet the upright line at one distance z: STATURE_M = z (slope of feet - slope of head).
        ahead = STATURE_M / np.maximum(rays[:, 1] - heads[:, 1], 1e-3)
        return rays * np.maximum(ahead, NEAREST_M)[:, None]

    def _lean(self, boxes: Floats) -> Floats:
        """Return the slope (K,), in columns per row, of a plumb line through the middles of boxes."""
        middle = (boxes[:, :2] + boxes[:, 2:] / 2.0 - self.centre_px) / self.focal_px
        plumb = self.camera_from_level[:, 1]
        across, down = (plumb[:2] - plumb[2] * middle).T
        return np.asarray(across / np.maximum(down, 1e-3) * self.focal_px[0] / self.focal_px[1])

    def _rays(self, pixels: Floats) -> Floats:
        """Return directions (K, 3) in the level frame, of depth 1 along the floor."""
        straight = np.column_stack([(pixels - self.centre_px) / self.focal_px, np.ones(len(pixels))])
        level = straight @ self.camera_from_level
        return level / np.maximum(level[:, 2:], 1e-3)


@njit(cache=True, nogil=True)
def _see(
    feet_m: Floats,
    build: Floats,
    camera_from_level: Floats,
    focal_px: tuple[float, float],
    centre_px: tuple[float, float],
    result: Floats,
) -> None:  # pragma: no cover
    for number in range(len(feet_m)):
        x, y, z = feet_m[number]
        foot = _seen_from(x, y, z, camera_from_level)
        head = _seen_from(x, y - STATURE_M * math.exp(build[number]), z, camera_from_level)
        middle = (foot[0] / foot[2] + head[0] / head[2]) / 2.0
        result[number, 0] = middle * focal_px[0] + centre_px[0]
        result[number, 1] = head[1] / head[2] * focal_px[1] + centre_px[1]
        result[number, 2] = foot[1] / foot[2] * focal_px[1] + centre_px[1]


@njit(cache=True, nogil=True)
def _slope(
    feet_m: Floats, build: Floats, camera_from_level: Floats, focal_px: tuple[float, float], slope: Floats
) -> None:  # pragma: no cover
    across, down, ahead = camera_from_level
    for number in range(len(feet_m)):
        x, y, z = feet_m[number]
        stature = STATURE_M * math.exp(build[number])
        foot = _seen_from(x, y, z, camera_from_level)
        head = _seen_from(x, y - stature, z, camera_from_level)
        put = slope[number]
        for axis in range(3):
            of_foot = (across[axis] - foot[0] / foot[2] * ahead[axis]) / foot[2]
            of_head = (across[axis] - head[0] / head[2] * ahead[axis]) / head[2]
            put[0, axis] = (of_foot + of_head) / 2.0 * focal_px[0]
            put[1, axis] = (down[axis] - head[1] / head[2] * ahead[axis]) / head[2] * focal_px[1]
            put[2, axis] = (down[axis] - foot[1] / foot[2] * ahead[axis]) / foot[2] * focal_px[1]
            if axis == 1:
                put[0, 3] = -of_head / 2.0 * focal_px[0] * stature
                put[1, 3] = -put[1, 1] * stature
                put[2, 3] = 0.0


@njit(cache=True, nogil=True)
def _seen_from(
    x: float, y: float, z: float, camera_from_level: Floats
) -> tuple[float, float, float]:  # pragma: no cover
    """Return coordinates to the right, down and ahead of a camera, and whether the point is ahead of it."""
    right, down, ahead = camera_from_level
    depth = ahead[0] * x + ahead[1] * y + ahead[2] * z
    return (
        right[0] * x + right[1] * y + right[2] * z,
        down[0] * x + down[1] * y + down[2] * z,
        max(depth, _LEAST_DEPTH_M),
    )
