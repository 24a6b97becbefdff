"""How large a person would be in the image if nothing hid it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.geometry.vectors import compose
from peopleboy.sim.rendering.canvas import Lens, make_canvas
from peopleboy.sim.rendering.raycast import draw
from peopleboy.sim.shapes.bounds import EMPTY, shape_bounds, unite
from peopleboy.sim.shapes.shape_table import ShapeTable

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def silhouette_bounds(camera: Pinhole, table: ShapeTable, camera_from_part: Matrix, parts: Mask) -> Array:
    """Find the rectangles around all that the camera would see of sets of parts if nothing hid them.

    They may lie outside the image. What is nearer than 0.05 m along the optical axis does not count.

    Args:
        camera: the pinhole camera.
        table: the world's shapes.
        camera_from_part: (P, 4, 4) poses in the optical frame.
        parts: (N, P) which parts.

    Returns:
        (N, 4) left, top, right, bottom [px]; NaN where nothing lies before the camera.
    """
    found = np.empty((len(parts), 4))
    _bounds(table, camera_from_part, parts, found)
    (u, v), focal = camera.centre_px, camera.focal_px
    found[found[:, 0] > found[:, 2]] = math.nan
    bounds: Array = (u, v, u, v) + focal * found
    return bounds


def silhouette_area(
    camera: Pinhole, table: ShapeTable, camera_from_part: Matrix, parts: Mask, bounds: Sequence[float]
) -> int:
    """Count the pixels that some parts (P,) would fill if nothing hid them, the image's border neither.

    The image is continued by its own width and height beyond each border; arguments are as in
    `silhouette_bounds`, and what that says of the parts.
    """
    if math.isnan(bounds[0]):
        return 0
    left, right = _within(bounds[0], bounds[2], camera.width)
    top, bottom = _within(bounds[1], bounds[3], camera.height)
    if left > right or top > bottom:
        return 0
    u, v = camera.centre_px
    lens = Lens(camera.focal_px, u - left, v - top, right - left + 1, bottom - top + 1)
    canvas = make_canvas(lens, len(table.surface_part))
    bits = np.ones(len(parts), np.uint64)
    draw(table, camera_from_part, ~parts, bits, lens, canvas)
    return int(np.count_nonzero(canvas.cover))


def _within(low: float, high: float, size: int) -> tuple[int, int]:
    """First and last pixel of an interval within the image and one image on either side."""
    return math.ceil(max(low, -float(size))), math.floor(min(high, 2.0 * size - 1.0))


@njit(cache=True)
def _bounds(table: ShapeTable, camera_from_part: Array, parts: Mask, found: Array) -> None:
    """Write the bounds (N, 4) of several sets of parts (N, P) at a distance of 1."""
    pose = np.empty((3, 4))
    for n in range(len(parts)):
        found[n, 0], found[n, 1], found[n, 2], found[n, 3] = EMPTY
    for shape in range(len(table.kind)):
        part = table.part[shape]
        wanted = False
        for n in range(len(parts)):
            wanted |= parts[n, part]
        if not wanted:
            continue
        compose(camera_from_part[part], table.part_from_shape[shape], pose)
        first, end = table.triangle_range[shape]
        own = shape_bounds(table.kind[shape], table.size[shape], pose, table.triangles[first:end])
        for n in range(len(parts)):
            if parts[n, part]:
                before = (found[n, 0], found[n, 1], found[n, 2], found[n, 3])
                found[n, 0], found[n, 1], found[n, 2], found[n, 3] = unite(before, own)
