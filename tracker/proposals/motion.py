"""By how much an image changed beyond what the camera's own motion does."""

from __future__ import annotations

import math
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import Mount

Grey = NDArray[np.uint8]
Matrix = NDArray[np.float64]

_STILL_PX: Final = 1.0 / 64.0
"""Shift up to which no pixel moves: pixels between others are read to 1/32."""
_SURE: Final = 0.12  # response of the correlation below which nothing is said of a shift


def turned(mount: Mount, shape: tuple[int, int], turn_rad: float) -> Matrix:
    """Tell how pixels (u, v, 1) move when the robot turns: a homography (3, 3).

    Args:
        mount: of the camera, whose optical axis is in the middle of the image's columns and rows.
        shape: rows and columns of the image.
        turn_rad: to the left.
    """
    rows, columns = shape
    middle = np.array([(columns - 1) / 2.0, (rows - 1) / 2.0])
    inward = np.array([[mount.focal_px, 0.0, middle[0]], [0.0, mount.focal_px, middle[1]], [0.0, 0.0, 1.0]])
    pitch = math.atan2(middle[1] - mount.horizon_px, mount.focal_px)
    # Upright axis in the camera's frame, x right, y down, z forward; a camera that looks down has it behind.
    axis = np.array([0.0, -math.cos(pitch), -math.sin(pitch)])
    rotation, _ = cv2.Rodrigues(-turn_rad * axis)
    return np.asarray(inward @ rotation @ np.linalg.inv(inward), np.float64)


def shifted(before: Grey, now: Grey) -> Matrix:
    """Tell how pixels (u, v, 1) moved from one image to the next, by a shift (3, 3) of what is alike.

    The shift is that of phase correlation at half size; none where that is not sure.
    """
    half = (max(now.shape[1] // 2, 1), max(now.shape[0] // 2, 1))
    smaller = [cv2.resize(image, half, interpolation=cv2.INTER_AREA) for image in (before, now)]
    edges = [cv2.Laplacian(cv2.GaussianBlur(image, (0, 0), 1.0), cv2.CV_32F) for image in smaller]
    (right, down), response = cv2.phaseCorrelate(
        edges[0], edges[1], cv2.createHanningWindow(half, cv2.CV_32F)
    )
    matrix = np.eye(3)
    if response >= _SURE:
        matrix[:2, 2] = right * now.shape[1] / half[0], down * now.shape[0] / half[1]
    return matrix


def change(before: Grey, now: Grey, moved: Matrix) -> Grey:
    """Give the differences (H, W) of an image and an earlier one, whose pixels have moved so.

    What has come into view since is no difference.
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
    """Tell how far the corner of an image moves that moves farthest, along columns or rows."""
    right, bottom = columns - 1.0, rows - 1.0
    corners = np.array([[0.0, right, 0.0, right], [0.0, 0.0, bottom, bottom], [1.0, 1.0, 1.0, 1.0]])
    there = moved @ corners
    return float(np.abs(there[:2] / there[2] - corners[:2]).max())
