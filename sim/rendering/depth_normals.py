"""Surface normals from an image of depths alone, for a renderer that gives no more (numba kernels)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import Point, cross, dot, minus
from peopleboy.sim.rendering.canvas import Lens

Array = NDArray[np.float64]
Depth = NDArray[np.float32]


@njit(cache=True, error_model="numpy")
def normals_from_depth(depth: Depth, lens: Lens, rotation: Array) -> Depth:
    """Take the plane through each pixel and its neighbours that are nearest to it in depth.

    Rough on things of few pixels.

    Args:
        depth: (H, W) [m] along the optical axis, inf where nothing is.
        lens: where pixels look.
        rotation: (3, 3) world from camera.

    Returns:
        (H, W, 3) unit normals that face the camera, world frame; 0 where nothing is.
    """
    normals = np.zeros((lens.height, lens.width, 3), np.float32)
    for v in range(lens.height):
        for u in range(lens.width):
            if math.isfinite(depth[v, u]):
                here = _point(depth, lens, u, v)
                across = _step(here, _point(depth, lens, u - 1, v), _point(depth, lens, u + 1, v))
                down = _step(here, _point(depth, lens, u, v - 1), _point(depth, lens, u, v + 1))
                n = cross(across, down)
                size = math.sqrt(dot(n, n)) * (-1.0 if dot(n, here) > 0.0 else 1.0)
                for i in range(3):
                    along = rotation[i, 0] * n[0] + rotation[i, 1] * n[1] + rotation[i, 2] * n[2]
                    normals[v, u, i] = along / size if size != 0.0 else 0.0
    return normals


@njit(cache=True, error_model="numpy")
def _point(depth: Depth, lens: Lens, u: int, v: int) -> Point:
    """What lies behind a pixel, optical frame; very far off outside the image or where nothing is."""
    z = 1e9
    if 0 <= u < lens.width and 0 <= v < lens.height and math.isfinite(depth[v, u]):
        z = float(depth[v, u])
    return (u - lens.centre_u) / lens.focal * z, (v - lens.centre_v) / lens.focal * z, z


@njit(cache=True, error_model="numpy")
def _step(here: Point, before: Point, after: Point) -> Point:
    """The difference to one of two neighbours, whichever is nearer in depth, in the direction of `after`."""
    if abs(before[2] - here[2]) < abs(after[2] - here[2]):
        return minus(here, before)
    return minus(after, here)
