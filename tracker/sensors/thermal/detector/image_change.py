"""Change detection between images, with the camera's own motion compensated."""

import math
from collections import deque
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.small_matrices import inverse
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.tracking.camera_motion import seen_homography

Grey = NDArray[np.uint8]
Matrix = NDArray[np.float64]

_STILL_PX: Final = 1.0 / 64.0
"""Shift below which the image is not warped: pixels are interpolated to 1/32."""


def rotation_homography(mount: Mount, shape: tuple[int, int], turn_rad: float) -> Matrix:
    """Return the homography (3, 3) of pixels (u, v, 1) for a rotation of the robot.

    Args:
        mount: of the camera, whose optical axis is in the middle of the image.
        shape: rows and columns of the image.
        turn_rad: to the left.
    """
    rows, columns = shape
    middle = np.array([(columns - 1) / 2.0, (rows - 1) / 2.0])
    inward = np.array([[mount.focal_px, 0.0, middle[0]], [0.0, mount.focal_px, middle[1]], [0.0, 0.0, 1.0]])
    pitch = math.atan2(middle[1] - mount.horizon_px, mount.focal_px)
    # Vertical axis in the camera frame, x right, y down, z forward; behind a camera that looks down.
    axis = np.array([0.0, -math.cos(pitch), -math.sin(pitch)])
    rotation, _ = cv2.Rodrigues(-turn_rad * axis)
    return np.asarray(inward @ rotation @ inverse(inward), np.float64)


def image_difference(before: Grey, now: Grey, moved: Matrix) -> Grey:
    """Return the absolute difference (H, W) of an image and an earlier one, warped by a homography.

    Areas that were outside the earlier image have no difference.
    """
    rows, columns = now.shape
    if _farthest_px(moved, rows, columns) > _STILL_PX:
        before = np.asarray(
            cv2.warpPerspective(
                before, moved, (columns, rows), dst=now.copy(), borderMode=cv2.BORDER_TRANSPARENT
            ),
            np.uint8,
        )
    return np.asarray(cv2.absdiff(now, before), np.uint8)


def _farthest_px(moved: Matrix, rows: int, columns: int) -> float:
    """Return the greatest displacement of an image corner along columns or rows."""
    right, bottom = columns - 1.0, rows - 1.0
    corners = np.array([[0.0, right, 0.0, right], [0.0, 0.0, bottom, bottom], [1.0, 1.0, 1.0, 1.0]])
    there = moved @ corners
    return float(np.abs(there[:2] / there[2] - corners[:2]).max())


EARLIER_S: Final = 0.2
"""Age of the image with which the present one is compared."""

_OLDEST_S: Final = 2.5 * EARLIER_S


class _Past(NamedTuple):
    grey: Grey
    time_s: float
    heading_rad: float
    is_known: bool  # whether the rotation since the previous image is known


class PastImages:
    """The latest images of one camera."""

    def __init__(self) -> None:
        self._past: deque[_Past] = deque()

    def keep(self, grey: Grey, time_s: float, odometry: Odometry | None = None) -> None:
        """Add the next image.

        Args:
            grey: (H, W); an image of another size, or one that is not later, resets the history.
            time_s: time of the image.
            odometry: motion of the robot since the last image; None if unknown.
        """
        past = self._past
        if past and (past[-1].time_s >= time_s or past[-1].grey.shape != grey.shape):
            past.clear()
        heading = past[-1].heading_rad if past else 0.0
        turn_rad = odometry.turn_rad if odometry is not None else 0.0
        past.append(_Past(grey.copy(), time_s, heading + turn_rad, odometry is not None))
        while time_s - past[0].time_s > _OLDEST_S:
            past.popleft()

    def change(self, mount: Mount | None = None) -> Grey:
        """Return the difference (H, W) of the last image from that of about 0.2 s before, or 0.

        Args:
            mount: of the camera, used with odometry to warp images; None estimates motion from the images.
        """
        *earlier, now = self._past
        if not earlier:
            return np.zeros_like(now.grey)
        before = min(earlier, key=lambda one: abs(now.time_s - one.time_s - EARLIER_S))
        since = [one for one in self._past if one.time_s > before.time_s]
        if mount is not None and all(one.is_known for one in since):
            moved = rotation_homography(mount, now.grey.shape, now.heading_rad - before.heading_rad)
        else:
            moved = seen_homography(before.grey, now.grey)
        return image_difference(before.grey, now.grey, moved)
