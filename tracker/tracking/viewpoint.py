"""Projection from metres around the robot to a camera's image: people are upright lines on their feet.

The level frame moves with the robot: x to the right, y down, z ahead along the floor [m]. Its origin is the
reference camera of the tracker.
"""

import math
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.tracker.tracking.config import NEAREST_M, STATURE_M

Floats = NDArray[np.float64]
Position = tuple[float, float, float]
"""Forward, left, up in the robot frame [m]."""

VIEW_ANGLE_DEG: Final = 44.0
"""Vertical field of view of an uncalibrated camera."""

_ROBOT_FROM_LEVEL: Final = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
_LEAST_DEPTH_M: Final = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Viewpoint:
    """Pose and intrinsics of a camera in the level frame.

    Attributes:
        focal_px: focal lengths along columns and rows.
        centre_px: principal point.
        camera_from_level: (3, 3) rotation.
        floor_m: depth of the floor below the origin; None if unknown.
        at_m: (3,) position of the camera.
        toe_m: how much nearer than the middle of a person the lower end of the box is: the front foot.
    """

    focal_px: tuple[float, float]
    centre_px: tuple[float, float]
    camera_from_level: Floats
    floor_m: float | None
    at_m: Floats = field(default_factory=lambda: np.zeros(3))
    toe_m: float = 0.0

    @property
    def breadth(self) -> float:
        """Half-width of the field of view: the tangent of half the horizontal angle."""
        return (self.centre_px[0] + 0.5) / self.focal_px[0]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the image [px], whose middle is the principal point."""
        across, down = self.centre_px
        return round(2.0 * down + 1.0), round(2.0 * across + 1.0)

    @classmethod
    def of(
        cls,
        calibration: Calibration | None,
        shape: tuple[int, int],
        origin_m: Position | None = None,
        toe_m: float = 0.0,
    ) -> "Viewpoint":
        """Make the viewpoint of a camera; an uncalibrated camera is assumed to be level.

        Args:
            calibration: of the camera; None if unknown.
            shape: rows and columns of its image [px].
            origin_m: of the level frame, in the robot frame; None for the camera's own position.
            toe_m: how much nearer than the middle of a person the lower end of the box is.
        """
        if isinstance(calibration, PinholeCalibration):
            matrix = calibration.intrinsics
            origin_m = calibration.position_m if origin_m is None else origin_m
            return cls(
                (float(matrix[0, 0]), float(matrix[1, 1])),
                (float(matrix[0, 2]), float(matrix[1, 2])),
                calibration.robot_from_camera[:3, :3].T @ _ROBOT_FROM_LEVEL,
                origin_m[2],
                np.subtract(calibration.position_m, origin_m) @ _ROBOT_FROM_LEVEL,
                toe_m,
            )
        rows, columns = shape
        focal = rows / 2.0 / math.tan(math.radians(VIEW_ANGLE_DEG) / 2.0)
        return cls((focal, focal), ((columns - 1) / 2.0, (rows - 1) / 2.0), np.eye(3), None, toe_m=toe_m)

    def seen(self, feet_m: Floats, build: Floats) -> Floats:
        """Project people: (K, 3) middle column and rows of head and feet.

        Args:
            feet_m: (K, 3) positions of the feet.
            build: (K,) logarithm of the stature divided by the usual stature.
        """
        result = np.empty((len(feet_m), 3))
        _see(
            feet_m - self.at_m,
            build,
            self.toe_m,
            self.camera_from_level,
            self.focal_px,
            self.centre_px,
            result,
        )
        return result

    def slopes(self, feet_m: Floats, build: Floats) -> Floats:
        """Return the derivatives (K, 3, 4) of `seen` by x, y, z of the feet, and the build."""
        slope = np.empty((len(feet_m), 3, 4))
        _slope(feet_m - self.at_m, build, self.toe_m, self.camera_from_level, self.focal_px, slope)
        return slope

    def feet(self, boxes: Floats) -> Floats:
        """Return the positions (K, 3) of people with these boxes (K, 4), assuming the usual stature."""
        left, top, width, height = boxes.T
        aside = self._lean(boxes) * height / 2.0
        rays = self._rays(np.stack([left + width / 2.0 + aside, top + height], axis=1))
        heads = self._rays(np.stack([left + width / 2.0 - aside, top], axis=1))
        # The ray of the feet meets the front foot at a distance z ahead, and that of the head the upright
        # line behind it: STATURE_M = z (slope of feet) - (z + toe) (slope of head).
        toe = self.toe_m / np.hypot(rays[:, 0], 1.0)
        ahead = (STATURE_M + toe * heads[:, 1]) / np.maximum(rays[:, 1] - heads[:, 1], 1e-3)
        ahead = np.maximum(ahead, NEAREST_M)
        middle = ahead + toe
        return np.column_stack([rays[:, 0] * middle, rays[:, 1] * ahead, middle]) + self.at_m

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
    toe_m: float,
    camera_from_level: Floats,
    focal_px: tuple[float, float],
    centre_px: tuple[float, float],
    result: Floats,
) -> None:  # pragma: no cover
    for number in range(len(feet_m)):
        x, y, z = feet_m[number]
        near = _nearness(x, z, toe_m)
        foot = _seen_from(near * x, y, near * z, camera_from_level)
        head = _seen_from(x, y - STATURE_M * math.exp(build[number]), z, camera_from_level)
        middle = (foot[0] / foot[2] + head[0] / head[2]) / 2.0
        result[number, 0] = middle * focal_px[0] + centre_px[0]
        result[number, 1] = head[1] / head[2] * focal_px[1] + centre_px[1]
        result[number, 2] = foot[1] / foot[2] * focal_px[1] + centre_px[1]


@njit(cache=True, nogil=True)
def _slope(
    feet_m: Floats,
    build: Floats,
    toe_m: float,
    camera_from_level: Floats,
    focal_px: tuple[float, float],
    slope: Floats,
) -> None:  # pragma: no cover
    across, down, ahead = camera_from_level
    foot_across, foot_down = np.empty(3), np.empty(3)
    for number in range(len(feet_m)):
        x, y, z = feet_m[number]
        stature = STATURE_M * math.exp(build[number])
        near = _nearness(x, z, toe_m)
        foot = _seen_from(near * x, y, near * z, camera_from_level)
        head = _seen_from(x, y - stature, z, camera_from_level)
        put = slope[number]
        for axis in range(3):
            foot_across[axis] = (across[axis] - foot[0] / foot[2] * ahead[axis]) / foot[2]
            foot_down[axis] = (down[axis] - foot[1] / foot[2] * ahead[axis]) / foot[2]
        _move_with_middle(x, z, near, foot_across)
        _move_with_middle(x, z, near, foot_down)
        for axis in range(3):
            of_head = (across[axis] - head[0] / head[2] * ahead[axis]) / head[2]
            put[0, axis] = (foot_across[axis] + of_head) / 2.0 * focal_px[0]
            put[1, axis] = (down[axis] - head[1] / head[2] * ahead[axis]) / head[2] * focal_px[1]
            put[2, axis] = foot_down[axis] * focal_px[1]
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


@njit(cache=True, nogil=True)
def _nearness(x: float, z: float, toe_m: float) -> float:  # pragma: no cover
    """Return the distance of the front foot on the floor, as a share of that of the middle."""
    return max(1.0 - toe_m / max(math.hypot(x, z), _LEAST_DEPTH_M), 0.0)


@njit(cache=True, nogil=True)
def _move_with_middle(x: float, z: float, near: float, slope: Floats) -> None:  # pragma: no cover
    """Turn derivatives (3,) by the position of the front foot into those by the position of the middle.

    The foot keeps its distance from the middle, so that motion along the line of sight is that of the foot,
    and motion across it is reduced.
    """
    away = max(math.hypot(x, z), _LEAST_DEPTH_M)
    along = (slope[0] * x + slope[2] * z) / away
    slope[0] = near * slope[0] + (1.0 - near) * along * x / away
    slope[2] = near * slope[2] + (1.0 - near) * along * z / away
