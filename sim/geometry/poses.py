"""Quaternions to poses and back, for many bodies at once (numba kernels)."""

import math

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def pose_matrices(positions: ArrayLike, orientations: ArrayLike) -> Array:
    """Turn (..., 3) positions [m] and (..., 4) unit quaternions x, y, z, w into (..., 4, 4) poses."""
    position, orientation = np.asarray(positions, np.float64), np.asarray(orientations, np.float64)
    poses: Array = _poses(position.reshape(-1, 3), orientation.reshape(-1, 4))
    return poses.reshape(*position.shape[:-1], 4, 4)


@njit(cache=True)
def _poses(positions: Array, orientations: Array) -> Array:
    poses = np.zeros((len(positions), 4, 4))
    for n in range(len(positions)):
        pose, (x, y, z, w) = poses[n], orientations[n]
        pose[0, 0] = 1.0 - 2.0 * (y * y + z * z)
        pose[0, 1] = 2.0 * (x * y - z * w)
        pose[0, 2] = 2.0 * (x * z + y * w)
        pose[1, 0] = 2.0 * (x * y + z * w)
        pose[1, 1] = 1.0 - 2.0 * (x * x + z * z)
        pose[1, 2] = 2.0 * (y * z - x * w)
        pose[2, 0] = 2.0 * (x * z - y * w)
        pose[2, 1] = 2.0 * (y * z + x * w)
        pose[2, 2] = 1.0 - 2.0 * (x * x + y * y)
        pose[0, 3], pose[1, 3], pose[2, 3], pose[3, 3] = (
            positions[n, 0],
            positions[n, 1],
            positions[n, 2],
            1.0,
        )
    return poses


@njit(cache=True)
def quaternions(poses: Array) -> Array:
    """Return the unit quaternions x, y, z, w (N, 4) of rigid poses (N, 4, 4).

    Each starts from the largest of its four numbers, so that nothing is divided by almost zero.

    Source: Markley, Unit quaternion from rotation matrix, J. Guidance, Control and Dynamics 31, 440 (2008).
    """
    result = np.empty((len(poses), 4))
    for n in range(len(poses)):
        r, q = poses[n], result[n]
        trace = r[0, 0] + r[1, 1] + r[2, 2]
        i = int(np.argmax(np.array([r[0, 0], r[1, 1], r[2, 2], trace])))
        if i == 3:
            q[0], q[1], q[2] = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
            q[3] = 1.0 + trace
        else:
            j, k = (i + 1) % 3, (i + 2) % 3
            q[i] = 1.0 - trace + 2.0 * r[i, i]
            q[j], q[k], q[3] = r[j, i] + r[i, j], r[k, i] + r[i, k], r[k, j] - r[j, k]
        q /= math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return result
