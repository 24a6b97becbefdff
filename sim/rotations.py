"""Quaternions to poses, for many bodies at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def pose_matrices(positions: ArrayLike, orientations: ArrayLike) -> NDArray[np.float64]:
    """Turn (..., 3) positions [m] and (..., 4) unit quaternions x, y, z, w into (..., 4, 4) poses."""
    position = np.asarray(positions, np.float64)
    x, y, z, w = np.moveaxis(np.asarray(orientations, np.float64), -1, 0)
    poses = np.zeros((*position.shape[:-1], 4, 4))
    poses[..., 0, 0] = 1.0 - 2.0 * (y * y + z * z)
    poses[..., 0, 1] = 2.0 * (x * y - z * w)
    poses[..., 0, 2] = 2.0 * (x * z + y * w)
    poses[..., 1, 0] = 2.0 * (x * y + z * w)
    poses[..., 1, 1] = 1.0 - 2.0 * (x * x + z * z)
    poses[..., 1, 2] = 2.0 * (y * z - x * w)
    poses[..., 2, 0] = 2.0 * (x * z - y * w)
    poses[..., 2, 1] = 2.0 * (y * z + x * w)
    poses[..., 2, 2] = 1.0 - 2.0 * (x * x + y * y)
    poses[..., :3, 3] = position
    poses[..., 3, 3] = 1.0
    return poses
