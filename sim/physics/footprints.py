"""Footprints of shapes between two heights: convex outlines with a radius, and their overlap with a box."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import map_corner, map_point
from peopleboy.sim.physics.solid_shapes import Array
from peopleboy.sim.shapes.shapes import ShapeKind

_SPHERE = int(ShapeKind.SPHERE)
_CAPSULE = int(ShapeKind.CAPSULE)
_CYLINDER = int(ShapeKind.CYLINDER)
_BOX = int(ShapeKind.BOX)
_SIDES = 16  # of the prism that approximates a cylinder that is not upright
MOST_POINTS = 8 * _SIDES
_UPRIGHT = 1.0 - 1e-9
_BOX_EDGES = np.array(
    [(a, b) for a in range(8) for b in range(8) if a < b and (a ^ b) in (1, 2, 4)], dtype=np.int64
)
_TRIANGLE_EDGES = np.array([(0, 1), (1, 2), (0, 2)])
_PRISM_EDGES = np.array(
    [
        edge
        for k in range(_SIDES)
        for edge in (
            (k, k + _SIDES),
            (k, (k + 1) % _SIDES),
            (k + _SIDES, (k + 1) % _SIDES + _SIDES),
        )
    ]
)


@njit(cache=True)
def footprint(
    kind: int, size: Array, pose: Array, low_m: float, high_m: float, outline: Array
) -> tuple[int, float]:
    """Write the outline of a primitive between two heights; exact except for tilted capsules and cylinders.

    A tilted capsule counts where its axis is within a radius of the heights; a tilted cylinder is
    approximated by a prism with 16 sides. A plane has no outline.

    Args:
        kind: ShapeKind, not a mesh.
        size: (3,) [m] as in `Shape`.
        pose: (4, 4) world from shape.
        low_m: [m] lower height.
        high_m: [m] upper height.
        outline: (MOST_POINTS, 2) [m] is filled with the corners, counter-clockwise.

    Returns:
        The number of corners, 0 if no part is between the heights, and the radius [m].
    """
    is_upright = abs(pose[2, 2]) > _UPRIGHT
    if kind == _SPHERE or (kind == _CAPSULE and is_upright):
        half, radius = (0.0, size[0]) if kind == _SPHERE else (size[0] / 2.0, size[1])
        off = max(pose[2, 3] - half - high_m, low_m - pose[2, 3] - half, 0.0)
        outline[0, 0], outline[0, 1] = pose[0, 3], pose[1, 3]
        return (1, math.sqrt(radius * radius - off * off)) if off < radius else (0, 0.0)
    if kind == _CAPSULE:
        return _clip_segment(size[0] / 2.0, size[1], pose, low_m, high_m, outline), size[1]
    if kind == _CYLINDER and is_upright:
        outline[0, 0], outline[0, 1] = pose[0, 3], pose[1, 3]
        half = size[0] / 2.0
        return int(pose[2, 3] - half < high_m and pose[2, 3] + half > low_m), size[1]
    if kind == _CYLINDER:
        return _clip(_prism(size, pose), _PRISM_EDGES, low_m, high_m, outline), 0.0
    if kind == _BOX:
        return _clip(_box_corners(size, pose), _BOX_EDGES, low_m, high_m, outline), 0.0
    return 0, 0.0


@njit(cache=True)
def triangle_footprint(corners: Array, pose: Array, low_m: float, high_m: float, outline: Array) -> int:
    """Write the outline of a triangle (3, 3) in a frame with a given pose; see `footprint`."""
    moved = np.empty((3, 3))
    for k in range(3):
        moved[k, 0], moved[k, 1], moved[k, 2] = map_point(pose, corners[k, 0], corners[k, 1], corners[k, 2])
    return _clip(moved, _TRIANGLE_EDGES, low_m, high_m, outline)


@njit(cache=True)
def _clip_segment(
    half: float, radius: float, pose: Array, low_m: float, high_m: float, outline: Array
) -> int:
    """Clip the axis of a tilted capsule to the heights, extended by its radius."""
    rise = pose[2, 2] * half
    start, end = -1.0, 1.0
    if abs(rise) > 1e-12:
        a = (low_m - radius - pose[2, 3]) / rise
        b = (high_m + radius - pose[2, 3]) / rise
        start, end = max(start, min(a, b)), min(end, max(a, b))
    elif pose[2, 3] + radius < low_m or pose[2, 3] - radius > high_m:
        return 0
    if start >= end:
        return 0
    for k in range(2):
        x, y, _ = map_point(pose, 0.0, 0.0, half * (start if k == 0 else end))
        outline[k, 0], outline[k, 1] = x, y
    return 2


@njit(cache=True)
def _prism(size: Array, pose: Array) -> Array:
    corners = np.empty((2 * _SIDES, 3))
    for k in range(2 * _SIDES):
        angle = 2.0 * math.pi * (k % _SIDES) / _SIDES
        z = size[0] / 2.0 if k < _SIDES else -size[0] / 2.0
        corners[k, 0], corners[k, 1], corners[k, 2] = map_point(
            pose, size[1] * math.cos(angle), size[1] * math.sin(angle), z
        )
    return corners


@njit(cache=True)
def _box_corners(size: Array, pose: Array) -> Array:
    corners = np.empty((8, 3))
    for k in range(8):
        corners[k, 0], corners[k, 1], corners[k, 2] = map_corner(pose, -0.5 * size, 0.5 * size, k)
    return corners


@njit(cache=True)
def _clip(corners: Array, edges: NDArray[np.int64], low_m: float, high_m: float, outline: Array) -> int:
    """Write the convex hull of the part of a convex solid between two heights."""
    points = np.empty((MOST_POINTS, 2))
    count = 0
    if corners[:, 2].max() <= low_m or corners[:, 2].min() >= high_m:
        return 0
    for k in range(len(corners)):
        if low_m <= corners[k, 2] <= high_m:
            points[count, 0], points[count, 1] = corners[k, 0], corners[k, 1]
            count += 1
    for e in range(len(edges)):
        a, b = corners[edges[e, 0]], corners[edges[e, 1]]
        for level in (low_m, high_m):
            if (a[2] - level) * (b[2] - level) < 0.0:
                share = (level - a[2]) / (b[2] - a[2])
                points[count, 0] = a[0] + share * (b[0] - a[0])
                points[count, 1] = a[1] + share * (b[1] - a[1])
                count += 1
    return _hull(points[:count], outline)


@njit(cache=True)
def _hull(points: Array, outline: Array) -> int:
    """Write the corners of the convex hull, counter-clockwise.

    Source: Andrew, Another efficient algorithm for convex hulls in two dimensions, 1979.
    """
    for k in range(1, len(points)):  # sorted by x, then y
        x, y, at = points[k, 0], points[k, 1], k
        while at > 0 and (points[at - 1, 0], points[at - 1, 1]) > (x, y):
            points[at, 0], points[at, 1] = points[at - 1, 0], points[at - 1, 1]
            at -= 1
        points[at, 0], points[at, 1] = x, y
    count = 0
    for chain in range(2):
        least = count + 1
        for k in range(len(points)):
            p = points[k] if chain == 0 else points[len(points) - 1 - k]
            while count > least and _turns(outline[count - 2], outline[count - 1], p) <= 1e-12:
                count -= 1
            outline[count, 0], outline[count, 1] = p[0], p[1]
            count += 1
        count -= 1  # the first point of the other chain
    return max(count, 1)


@njit(cache=True)
def _turns(a: Array, b: Array, c: Array) -> float:
    """Return a positive number if the path from a through b to c turns left."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


_FLUSH_M = 1e-3  # corners within this distance of the contact are part of it, too
APART = (-math.inf, 0.0, 0.0, 0.0)


@njit(cache=True)
def overlap(half: Array, outline: Array, radius: float) -> tuple[float, float, float, float]:
    """Return depth, normal and lever of a contact.

    Args:
        half: (2,) [m] half lengths of a rectangle about the origin, along x and y.
        outline: (N, 2) [m] counter-clockwise corners of the other shape, in the rectangle's frame.
        radius: [m] by which the outline is expanded.

    Returns:
        depth [m], negative without contact; the unit normal x, y, from the outline to the rectangle; and the
        position of the contact along (-y, x) of that normal [m].
    """
    separation, nx, ny = _widest_gap(half, outline)
    if separation > radius:
        return APART
    if separation > 1e-9:
        distance, x, y = _nearest(half, outline)
        if distance > 1e-9:
            separation, nx, ny = distance, x, y
    return radius - separation, nx, ny, _bearing(half, outline, nx, ny)


@njit(cache=True)
def _widest_gap(half: Array, outline: Array) -> tuple[float, float, float]:
    """Return the greatest gap along the side normals of both, negative if they overlap, and its normal."""
    best, best_x, best_y = -math.inf, 0.0, 0.0
    count = len(outline)
    for axis in range(2):
        for sign in (-1.0, 1.0):
            gap = sign * outline[0, axis]
            for k in range(1, count):
                gap = min(gap, sign * outline[k, axis])
            gap -= half[axis]
            if gap > best:
                best, best_x, best_y = gap, -sign if axis == 0 else 0.0, -sign if axis == 1 else 0.0
    for k in range(count if count > 1 else 0):
        a, b = outline[k], outline[(k + 1) % count]
        x, y = b[1] - a[1], a[0] - b[0]
        length = math.hypot(x, y)
        if length > 1e-9:
            x, y = x / length, y / length
            gap = -abs(x) * half[0] - abs(y) * half[1] - x * a[0] - y * a[1]
            if gap > best:
                best, best_x, best_y = gap, x, y
    return best, best_x, best_y


@njit(cache=True)
def _nearest(half: Array, outline: Array) -> tuple[float, float, float]:
    """Return the distance of two separate shapes, and the direction to the rectangle."""
    best, best_x, best_y = math.inf, 0.0, 0.0
    count = len(outline)
    for k in range(count):
        a, b = outline[k], outline[(k + 1) % count]
        x, y = min(max(a[0], -half[0]), half[0]) - a[0], min(max(a[1], -half[1]), half[1]) - a[1]
        if math.hypot(x, y) < best:
            best, best_x, best_y = math.hypot(x, y), x, y
        along_x, along_y = b[0] - a[0], b[1] - a[1]
        square = along_x * along_x + along_y * along_y
        for corner in range(4 if square > 0.0 else 0):
            cx, cy = half[0] if corner & 1 else -half[0], half[1] if corner & 2 else -half[1]
            share = ((cx - a[0]) * along_x + (cy - a[1]) * along_y) / square
            share = min(max(share, 0.0), 1.0)
            x, y = cx - a[0] - share * along_x, cy - a[1] - share * along_y
            if math.hypot(x, y) < best:
                best, best_x, best_y = math.hypot(x, y), x, y
    return (best, best_x / best, best_y / best) if best > 1e-9 else (best, 0.0, 0.0)


@njit(cache=True)
def _bearing(half: Array, outline: Array, nx: float, ny: float) -> float:
    """Return the middle of the overlap of the facing sides, along (-ny, nx)."""
    corners = np.empty((4, 2))
    for k in range(4):
        corners[k, 0] = half[0] if k & 1 else -half[0]
        corners[k, 1] = half[1] if k & 2 else -half[1]
    a, b = _foremost(corners, -1.0, nx, ny)
    c, d = _foremost(outline, 1.0, nx, ny)
    low, high = max(a, c), min(b, d)
    if low <= high:
        return (low + high) / 2.0
    return b if c > b else a


@njit(cache=True)
def _foremost(points: Array, way: float, nx: float, ny: float) -> tuple[float, float]:
    """Return the range along (-ny, nx) of the points that are farthest along `way` times (nx, ny)."""
    most = -math.inf
    for k in range(len(points)):
        most = max(most, way * (nx * points[k, 0] + ny * points[k, 1]))
    low, high = math.inf, -math.inf
    for k in range(len(points)):
        if way * (nx * points[k, 0] + ny * points[k, 1]) >= most - _FLUSH_M:
            at = nx * points[k, 1] - ny * points[k, 0]
            low, high = min(low, at), max(high, at)
    return low, high
