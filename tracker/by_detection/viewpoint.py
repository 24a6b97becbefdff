"""From metres round a camera to its image: people as upright lines on their feet.

The level frame has its origin in the camera: x to the right, y down, z ahead along the floor [m].
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.by_detection.config import STATURE_M
from peopleboy.tracker.frame import Calibration, PinholeCalibration

Floats = NDArray[np.float64]

VIEW_ANGLE_DEG: Final = 44.0
"""Vertical, of a camera of which nothing is known."""

NEAREST_M: Final = 0.3
_ROBOT_FROM_LEVEL: Final = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
_LEAST_DEPTH_M: Final = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Viewpoint:
    """How a camera looks into the level frame.

    Attributes:
        focal_px: focal lengths along columns and rows.
        centre_px: where the optical axis meets the image.
        camera_from_level: (3, 3) rotation.
        floor_m: how far below the camera the floor is; None if nobody knows.
    """

    focal_px: tuple[float, float]
    centre_px: tuple[float, float]
    camera_from_level: Floats
    floor_m: float | None

    @classmethod
    def of(cls, calibration: Calibration | None, shape: tuple[int, int]) -> Viewpoint:
        """Take a camera's calibration; one of which nothing is known is level.

        Args:
            calibration: of the camera; None if nobody knows it.
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
        """Tell how people are seen: (K, 3) middle column, rows of head and feet.

        Args:
            feet_m: (K, 3) where they stand.
            build: (K,) logarithm of their stature over the usual one.
        """
        heads = feet_m.copy()
        heads[:, 1] -= STATURE_M * np.exp(build)
        foot, head = self._pixels(feet_m), self._pixels(heads)
        return np.stack([(foot[:, 0] + head[:, 0]) / 2.0, head[:, 1], foot[:, 1]], axis=1)

    def slopes(self, feet_m: Floats, build: Floats) -> Floats:
        """Give the derivatives (K, 3, 4) of `seen` by x, y, z of the feet, and the build."""
        stature = STATURE_M * np.exp(build)
        heads = feet_m.copy()
        heads[:, 1] -= stature
        foot, head = self._pixel_slopes(feet_m), self._pixel_slopes(heads)
        slope = np.zeros((len(feet_m), 3, 4))
        slope[:, 0, :3] = (foot[:, 0] + head[:, 0]) / 2.0
        slope[:, 1, :3], slope[:, 2, :3] = head[:, 1], foot[:, 1]
        slope[:, 0, 3] = -head[:, 0, 1] * stature / 2.0
        slope[:, 1, 3] = -head[:, 1, 1] * stature
        return slope

    def feet(self, boxes: Floats) -> Floats:
        """Tell where people with these boxes (K, 4) stand, (K, 3), if they are of the usual stature."""
        left, top, width, height = boxes.T
        aside = self._lean(boxes) * height / 2.0
        rays = self._rays(np.stack([left + width / 2.0 + aside, top + height], axis=1))
        heads = self._rays(np.stack([left + width / 2.0 - aside, top], axis=1))
        # Both rays meet the upright line at one distance z: STATURE_M = z (slope of feet - slope of head).
        ahead = STATURE_M / np.maximum(rays[:, 1] - heads[:, 1], 1e-3)
        return rays * np.maximum(ahead, NEAREST_M)[:, None]

    def _lean(self, boxes: Floats) -> Floats:
        """Tell by how many columns a plumb line through middles of boxes moves on from row to row, (K,)."""
        middle = (boxes[:, :2] + boxes[:, 2:] / 2.0 - self.centre_px) / self.focal_px
        plumb = self.camera_from_level[:, 1]
        across, down = (plumb[:2] - plumb[2] * middle).T
        return np.asarray(across / np.maximum(down, 1e-3) * self.focal_px[0] / self.focal_px[1])

    def _pixels(self, points_m: Floats) -> Floats:
        turned = points_m @ self.camera_from_level.T
        depth = np.maximum(turned[:, 2], _LEAST_DEPTH_M)
        return turned[:, :2] / depth[:, None] * self.focal_px + self.centre_px

    def _pixel_slopes(self, points_m: Floats) -> Floats:
        """Give the derivatives (K, 2, 3) of columns and rows by x, y, z."""
        turned = points_m @ self.camera_from_level.T
        depth = np.maximum(turned[:, 2], _LEAST_DEPTH_M)[:, None, None]
        across, ahead = self.camera_from_level[:2], self.camera_from_level[2]
        slope = across[None] / depth - turned[:, :2, None] / depth**2 * ahead
        return np.asarray(slope * np.array(self.focal_px)[:, None])

    def _rays(self, pixels: Floats) -> Floats:
        """Give directions (K, 3) in the level frame, of depth 1 along the floor."""
        straight = np.column_stack([(pixels - self.centre_px) / self.focal_px, np.ones(len(pixels))])
        level = straight @ self.camera_from_level
        return level / np.maximum(level[:, 2:], 1e-3)
