"""Bounding rectangle of a shape's image, computed analytically and not from pixels (numba kernels).

Bounds are (x0, y0, x1, y1), the least and greatest x / z and y / z over the points of the shape beyond the
near plane, in the optical frame; `EMPTY` if there are none. Poses are (3, 4) or (4, 4) arrays, camera from
shape.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import Point, map_point
from peopleboy.sim.shapes.shapes import ShapeKind

# Near and far plane of the renderers [m].
NEAR_M = 0.05
FAR_M = 100.0

Bounds = tuple[float, float, float, float]
Array = NDArray[np.float64]

EMPTY: Bounds = (math.inf, math.inf, -math.inf, -math.inf)
EVERYTHING: Bounds = (-math.inf, -math.inf, math.inf, math.inf)

_SPHERE = int(ShapeKind.SPHERE)
_CAPSULE = int(ShapeKind.CAPSULE)
_CYLINDER = int(ShapeKind.CYLINDER)
_BOX = int(ShapeKind.BOX)
_PLANE = int(ShapeKind.PLANE)
# Number of spheres that approximate a capsule across the near plane.
_BEADS = 16


@njit(cache=True)
def unite(a: Bounds, b: Bounds) -> Bounds:
    """Return the smallest bounds around both."""
    return min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])


@njit(cache=True)
def shape_bounds(kind: int, size: Array, pose: Array, triangles: Array) -> Bounds:
    """Return the bounds of one shape.

    They are exact except across the near plane, where a cylinder is replaced by its box, and a capsule by a
    row of spheres, which are smaller by less than a hundredth of its length.

    Args:
        kind: ShapeKind.
        size: (3,) as in `Shape`.
        pose: camera from shape.
        triangles: (T, 3, 3) triangles of a mesh, in the frame of its pose.
    """
    if kind == _SPHERE:
        return _sphere(map_point(pose, 0.0, 0.0, 0.0), size[0])
    if kind == _CAPSULE:
        return _capsule(
            map_point(pose, 0.0, 0.0, -size[0] / 2), map_point(pose, 0.0, 0.0, size[0] / 2), size[1]
        )
    if kind == _CYLINDER:
        return _cylinder(pose, size[0] / 2.0, size[1])
    if kind == _BOX:
        half_x, half_y, half_z = size[0] / 2.0, size[1] / 2.0, size[2] / 2.0
        return box_bounds(pose, -half_x, -half_y, -half_z, half_x, half_y, half_z)
    if kind == _PLANE:
        return EVERYTHING
    bounds = EMPTY
    for i in range(len(triangles)):
        for j in range(3):
            a, b = triangles[i, j], triangles[i, (j + 1) % 3]
            ends = map_point(pose, a[0], a[1], a[2]), map_point(pose, b[0], b[1], b[2])
            bounds = unite(bounds, segment_bounds(ends[0], ends[1]))
    return bounds


@njit(cache=True)
def box_bounds(pose: Array, x0: float, y0: float, z0: float, x1: float, y1: float, z1: float) -> Bounds:
    """Return the bounds of a box between two corners in its frame."""
    corners = (
        map_point(pose, x0, y0, z0),
        map_point(pose, x1, y0, z0),
        map_point(pose, x0, y1, z0),
        map_point(pose, x1, y1, z0),
        map_point(pose, x0, y0, z1),
        map_point(pose, x1, y0, z1),
        map_point(pose, x0, y1, z1),
        map_point(pose, x1, y1, z1),
    )
    bounds, nearest = EMPTY, math.inf
    for corner in corners:
        nearest = min(nearest, corner[2])
    if nearest >= NEAR_M:
        for corner in corners:
            x, y = corner[0] / corner[2], corner[1] / corner[2]
            bounds = min(bounds[0], x), min(bounds[1], y), max(bounds[2], x), max(bounds[3], y)
        return bounds
    for i in range(8):
        for axis in range(3):
            if (i >> axis) & 1 == 0:
                bounds = unite(bounds, segment_bounds(corners[i], corners[i | (1 << axis)]))
    return bounds


@njit(cache=True)
def segment_bounds(a: Point, b: Point) -> Bounds:
    """Return the bounds of a line segment."""
    if a[2] < NEAR_M and b[2] < NEAR_M:
        return EMPTY
    if a[2] < NEAR_M:
        a, b = b, a
    if b[2] < NEAR_M:
        share = (a[2] - NEAR_M) / (a[2] - b[2])
        b = (a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), NEAR_M)
    x, y, other_x, other_y = a[0] / a[2], a[1] / a[2], b[0] / b[2], b[1] / b[2]
    return min(x, other_x), min(y, other_y), max(x, other_x), max(y, other_y)


@njit(cache=True)
def _sphere(centre: Point, radius: float) -> Bounds:
    if centre[2] + radius <= NEAR_M:
        return EMPTY
    x0, x1 = _circle(centre[0], centre[2], radius)
    y0, y1 = _circle(centre[1], centre[2], radius)
    return x0, y0, x1, y1


@njit(cache=True)
def _circle(x: float, z: float, radius: float) -> tuple[float, float]:
    """Return least and greatest x / z over the part of a disc beyond the near plane.

    They are at the points where tangents through the origin touch the disc, (low_x, low_z) and (high_x,
    high_z), or else on the near plane, which cuts the disc in a line of length 2 `half`.
    """
    half = math.sqrt(max(radius**2 - (z - NEAR_M) ** 2, 0.0))
    low, high = (x - half) / NEAR_M, (x + half) / NEAR_M
    square = x * x + z * z
    if square > radius**2:
        reach = math.sqrt(square - radius**2)
        low_x, low_z = x * reach - z * radius, z * reach + x * radius
        high_x, high_z = x * reach + z * radius, z * reach - x * radius
        if low_z * reach >= NEAR_M * square:
            low = low_x / low_z
        if high_z * reach >= NEAR_M * square:
            high = high_x / high_z
    return low, high


@njit(cache=True)
def _capsule(a: Point, b: Point, radius: float) -> Bounds:
    """Return the bounds of a capsule: those of its end spheres, of which it is the convex hull."""
    if min(a[2], b[2]) - radius >= NEAR_M:
        return unite(_sphere(a, radius), _sphere(b, radius))
    bounds = EMPTY
    for i in range(_BEADS + 1):
        t = i / _BEADS
        centre = (a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2]))
        bounds = unite(bounds, _sphere(centre, radius))
    return bounds


@njit(cache=True)
def _cylinder(pose: Array, half_length: float, radius: float) -> Bounds:
    """Return the bounds of a cylinder: those of its end discs, of which it is the convex hull."""
    axis = (pose[0, 2], pose[1, 2], pose[2, 2])
    top, bottom = map_point(pose, 0.0, 0.0, half_length), map_point(pose, 0.0, 0.0, -half_length)
    lowest = min(top[2], bottom[2]) - radius * math.sqrt(max(1.0 - axis[2] ** 2, 0.0))
    if lowest < NEAR_M:
        return box_bounds(pose, -radius, -radius, -half_length, radius, radius, half_length)
    bounds = EMPTY
    for centre in (top, bottom):
        x0, x1 = _disc(centre[0], centre[2], axis[0], axis[2], radius)
        y0, y1 = _disc(centre[1], centre[2], axis[1], axis[2], radius)
        bounds = unite(bounds, (x0, y0, x1, y1))
    return bounds


@njit(cache=True)
def _disc(x: float, z: float, axis_x: float, axis_z: float, radius: float) -> tuple[float, float]:
    """Return least and greatest x / z over a disc in space beyond the near plane.

    The plane x = m z touches the disc if (x - m z)^2 = r^2 (1 + m^2 - (axis_x - m axis_z)^2).
    """
    square = radius * radius
    a = z * z - square * (1.0 - axis_z * axis_z)
    b = x * z + square * axis_x * axis_z
    c = x * x - square * (1.0 - axis_x * axis_x)
    root = math.sqrt(max(b * b - a * c, 0.0))
    return (b - root) / a, (b + root) / a
