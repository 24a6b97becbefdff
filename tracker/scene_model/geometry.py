"""Where the pixels of a depth image are in the robot's frame, and how warm the thermal camera sees them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.frame import DEPTH, THERMAL, Floats, Frame, PinholeCalibration
from peopleboy.tracker.scene_model.scene import Metres

UNSEEN, COLD, WARM = -1, 0, 1


@dataclass(frozen=True, slots=True, eq=False)
class Geometry:
    """A calibrated depth camera.

    Attributes:
        calibration: of it.
        rays: (H, W, 3) direction of each pixel in the robot's frame, of depth 1.
        focal_px: focal length.
    """

    calibration: PinholeCalibration
    rays: Metres
    focal_px: float

    @classmethod
    def of(cls, frame: Frame) -> Geometry:
        """Read it from a frame.

        Raises:
            BadInput: no depth image, or no calibration of a flat one.
        """
        calibration = frame.calibrations.get(DEPTH)
        if not isinstance(calibration, PinholeCalibration):
            raise BadInput(f"camera {DEPTH!r}: the scene model wants a calibrated one with a flat image")
        height, width = frame.depth(DEPTH).shape
        v, u = np.mgrid[:height, :width]
        pixels = np.stack([u.ravel(), v.ravel()], axis=1).astype(np.float64)
        rays = calibration.rays(pixels).reshape(height, width, 3).astype(np.float32)
        return cls(calibration, rays, float(calibration.intrinsics[0, 0]))

    @property
    def shape(self) -> tuple[int, int]:
        """Of its images."""
        height, width, _ = self.rays.shape
        return height, width

    def points(self, pixels: NDArray[np.intp], depth_m: Metres) -> Floats:
        """Give the points (N, 3) [m] in the robot's frame at flat indices (N,) of pixels."""
        rays = self.rays.reshape(-1, 3)[pixels].astype(np.float64)
        return np.asarray(self.calibration.robot_from_camera[:3, 3] + rays * depth_m.ravel()[pixels, None])

    def warmth(self, depth_m: Metres, frame: Frame, warm: float) -> NDArray[np.int8] | None:
        """Tell (H, W) of each reading whether it is warm, cold, or not seen by the thermal camera.

        Returns:
            None if there is no thermal image, or nobody knows where its camera is.
        """
        theirs = frame.calibrations.get(THERMAL)
        if THERMAL not in frame.images or not isinstance(theirs, PinholeCalibration):
            return None
        ours = self.calibration
        turn = theirs.intrinsics @ theirs.robot_from_camera[:3, :3].T
        shift = turn @ (ours.robot_from_camera[:3, 3] - theirs.robot_from_camera[:3, 3])
        unprojected = turn @ ours.robot_from_camera[:3, :3] @ np.linalg.inv(ours.intrinsics)
        return np.asarray(_look_up(depth_m, unprojected, shift, frame.grey(THERMAL), warm), np.int8)


@njit(cache=True, nogil=True)
def _look_up(depth, turn, shift, image, warm):  # type: ignore[no-untyped-def]
    height, width = depth.shape
    rows, columns = image.shape
    found = np.full((height, width), -1, np.int8)
    for v in range(height):
        for u in range(width):
            z = depth[v, u]
            if z <= 0.0:
                continue
            deep = z * (turn[2, 0] * u + turn[2, 1] * v + turn[2, 2]) + shift[2]
            if deep <= 0.0:
                continue
            column = round((z * (turn[0, 0] * u + turn[0, 1] * v + turn[0, 2]) + shift[0]) / deep)
            row = round((z * (turn[1, 0] * u + turn[1, 1] * v + turn[1, 2]) + shift[1]) / deep)
            if 0 <= row < rows and 0 <= column < columns:
                found[v, u] = 1 if image[row, column] > warm else 0
    return found
