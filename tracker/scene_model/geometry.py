"""Positions of depth pixels in the robot frame, and their temperature in the thermal image."""

from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.geometry.small_matrices import inverse
from peopleboy.tracker.frame import DEPTH, DEPTH_AMPLITUDE, DEPTH_COLOUR, THERMAL, Floats, Frame
from peopleboy.tracker.scene_model.scene import Metres

UNSEEN, COLD, WARM = -1, 0, 1


@dataclass(frozen=True, slots=True, eq=False)
class Geometry:
    """A calibrated depth camera.

    Attributes:
        calibration: of the camera.
        rays: (H, W, 3) direction of each pixel in the robot frame, of depth 1.
        focal_px: focal length.
    """

    calibration: PinholeCalibration
    rays: Metres
    focal_px: float

    @classmethod
    def of(cls, frame: Frame) -> "Geometry":
        """Make it from a frame.

        Raises:
            BadInput: there is no depth image, or no calibration of a planar camera.
        """
        calibration = frame.calibrations.get(DEPTH)
        if not isinstance(calibration, PinholeCalibration):
            raise BadInput(f"camera {DEPTH!r}: the scene model needs a calibrated planar camera")
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
        """Return the points (N, 3) [m] in the robot frame of pixels with flat indices (N,)."""
        rays = self.rays.reshape(-1, 3)[pixels].astype(np.float64)
        return np.asarray(self.calibration.robot_from_camera[:3, 3] + rays * depth_m.ravel()[pixels, None])

    def warmth(self, depth_m: Metres, frame: Frame, warm: float) -> NDArray[np.int8] | None:
        """Return (H, W) whether each reading is warm, cold, or outside the thermal image.

        Returns:
            None if there is no thermal image, or its camera is not calibrated.
        """
        theirs = frame.calibrations.get(THERMAL)
        if THERMAL not in frame.images or not isinstance(theirs, PinholeCalibration):
            return None
        ours = self.calibration
        turn = theirs.intrinsics @ theirs.robot_from_camera[:3, :3].T
        shift = turn @ (ours.robot_from_camera[:3, 3] - theirs.robot_from_camera[:3, 3])
        unprojected = turn @ ours.robot_from_camera[:3, :3] @ inverse(ours.intrinsics)
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


# Appearance of surfaces in the pixels of a depth image: colours, or reflectance.

Shades = NDArray[np.uint8]

_WHITE_AT_1_M = 10_000.0  # amplitude


def shades_of(frame: Frame) -> Shades | None:
    """Return (H, W, 3) RGB, or (H, W, 1) reflectance of a time-of-flight sensor, or None.

    Raises:
        BadInput: its size differs from that of the depth image.
    """
    if DEPTH_COLOUR in frame.images:
        colour = frame.rgb(DEPTH_COLOUR)
        _check_size(colour.shape, frame)
        return colour
    if DEPTH_AMPLITUDE not in frame.images:
        return None
    amplitude = frame.depth(DEPTH_AMPLITUDE)
    _check_size(amplitude.shape, frame)
    reflectance = amplitude * (frame.depth(DEPTH).astype(np.float32) / 1000.0) ** 2 / _WHITE_AT_1_M
    return np.asarray(255.0 * np.sqrt(np.minimum(reflectance, 1.0)), np.uint8)[:, :, None]


def grey_of(frame: Frame) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Return (H, W) grey that does not depend on the distance, and (H, W) amplitude.

    For a colour camera the grey is also the amplitude.

    Raises:
        BadInput: there is neither, or the size differs.
    """
    shades = shades_of(frame)
    if shades is None:
        raise BadInput(f"frame has neither {DEPTH_COLOUR} nor {DEPTH_AMPLITUDE}, by which motion is seen")
    if shades.shape[2] == 1:
        return shades[:, :, 0], frame.depth(DEPTH_AMPLITUDE).astype(np.float32)
    grey = np.asarray(cv2.cvtColor(shades, cv2.COLOR_RGB2GRAY), np.uint8)
    return grey, grey.astype(np.float32)


def _check_size(shape: tuple[int, ...], frame: Frame) -> None:
    depth = frame.depth(DEPTH).shape
    if shape[:2] != depth:
        raise BadInput(f"{DEPTH} and what is seen beside it must have one size: {depth} and {shape[:2]}")
