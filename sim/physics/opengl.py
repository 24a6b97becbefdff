"""The pinhole camera in OpenGL's conventions, which TinyRenderer follows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose

# OpenGL's camera looks along -z with y up, the optical frame along z with y down.
_EYE_FROM_OPTICAL = np.diag([1.0, -1.0, -1.0, 1.0])


def view_matrix(world_from_camera: Matrix) -> list[float]:
    """16 numbers, column by column: eye from world."""
    return (_EYE_FROM_OPTICAL @ invert_pose(world_from_camera)).ravel(order="F").tolist()


def projection_matrix(camera: Pinhole, near_m: float, far_m: float) -> list[float]:
    """16 numbers, column by column: clip space from eye.

    TinyRenderer takes its sample of pixel (u, v) at -1 + 2 u / width, 1 - 2 (v + 1) / height: half a pixel
    left of and below the pixel's centre. The image is shifted by as much, so that it shows what lies
    behind the centres.
    """
    width, height = camera.width, camera.height
    matrix = np.zeros((4, 4))
    matrix[0, 0] = 2.0 * camera.focal_px / width
    matrix[1, 1] = 2.0 * camera.focal_px / height
    matrix[0, 2] = 1.0 / width
    matrix[1, 2] = 1.0 / height
    matrix[2, 2] = -(far_m + near_m) / (far_m - near_m)
    matrix[2, 3] = -2.0 * far_m * near_m / (far_m - near_m)
    matrix[3, 2] = -1.0
    return matrix.ravel(order="F").tolist()


def metric_depth(buffer: NDArray[np.float32], near_m: float, far_m: float) -> Matrix:
    """Depth along the optical axis [m] from a depth buffer that runs from 0 (near) to 1 (far)."""
    return far_m * near_m / (far_m - (far_m - near_m) * buffer.astype(np.float64))
