"""The nearest solid along rays, by the shapes' own geometry (numba kernels)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import Point, cross, dot, minus, turn_back
from peopleboy.sim.physics.solids.solids import Array, Placements, Solids
from peopleboy.sim.shapes.rays import hit_shape
from peopleboy.sim.shapes.shapes import ShapeKind

_MESH = int(ShapeKind.MESH)
_MARGIN_M = 1e-3  # around boxes: far more than PyBullet's rays are off
_BLOCK = 15  # rays that are looked at together, such as those of a sonar


@njit(cache=True, nogil=True)
def cast(
    starts: Array, ends: Array, bodies: Placements, solids: Solids, passed: int
) -> tuple[Array, NDArray[np.int64]]:
    """Find what rays hit first; shapes are met from outside only, triangles from both sides.

    Args:
        starts: (R, 3) [m] world frame.
        ends: (R, 3) [m].
        bodies: up to date.
        solids: likewise.
        passed: number of a body that rays pass through, -1 for none.

    Returns:
        fraction: (R,) of the way, 1 where nothing is hit.
        part: (R,) what is hit, -1 for nothing.
    """
    fraction, part = np.ones(len(starts)), np.full(len(starts), -1, np.int64)
    if len(starts) > 0:
        cast_into(starts, ends, bodies, solids, passed, fraction, part)
    return fraction, part


@njit(cache=True, nogil=True)
def cast_into(
    starts: Array,
    ends: Array,
    bodies: Placements,
    solids: Solids,
    passed: int,
    fraction: Array,
    part: NDArray[np.int64],
) -> None:
    """Do as `cast`, where fraction is 1 and part -1 at first; there must be a ray."""
    whole = np.empty((2, 3))
    _surround(starts, ends, 0, len(starts), whole)
    blocks = (len(starts) + _BLOCK - 1) // _BLOCK
    around = np.empty((blocks, 2, 3))
    for block in range(blocks):
        _surround(starts, ends, block * _BLOCK, min((block + 1) * _BLOCK, len(starts)), around[block])
    for k in range(len(solids.boxes)):
        body, box = bodies.of_part[solids.table.part[k]], solids.boxes[k]
        if body == passed or bodies.hidden[body] or not _share(whole, box, 0.0):
            continue
        for block in range(blocks):
            if not _share(around[block], box, _MARGIN_M):
                continue
            for ray in range(block * _BLOCK, min((block + 1) * _BLOCK, len(starts))):
                if entered_at(starts[ray], ends[ray], box) < fraction[ray]:
                    t = _hit(starts[ray], ends[ray], solids, k)
                    if t < fraction[ray]:
                        fraction[ray], part[ray] = t, solids.table.part[k]


@njit(cache=True)
def _surround(starts: Array, ends: Array, first: int, stop: int, box: Array) -> None:
    """Write (2, 3) least and greatest corner of the upright box around some rays."""
    for axis in range(3):
        low, high = np.inf, -np.inf
        for ray in range(first, stop):
            low = min(low, starts[ray, axis], ends[ray, axis])
            high = max(high, starts[ray, axis], ends[ray, axis])
        box[0, axis], box[1, axis] = low, high


@njit(cache=True)
def _share(one: Array, other: Array, margin_m: float) -> bool:
    """Whether two upright boxes share a point, or nearly so."""
    for axis in range(3):
        if one[0, axis] > other[1, axis] + margin_m or one[1, axis] < other[0, axis] - margin_m:
            return False
    return True


@njit(cache=True)
def _hit(start: Array, end: Array, solids: Solids, k: int) -> float:
    """Where, as a fraction of its way, a ray enters a solid; infinite where it misses."""
    pose, table = solids.poses[k], solids.table
    o = turn_back(pose, start[0] - pose[0, 3], start[1] - pose[1, 3], start[2] - pose[2, 3])
    d = turn_back(pose, end[0] - start[0], end[1] - start[1], end[2] - start[2])
    if table.kind[k] != _MESH:
        return hit_shape(table.kind[k], (table.size[k, 0], table.size[k, 1], table.size[k, 2]), o, d)[0]
    nearest = math.inf
    for number in range(table.triangle_range[k, 0], table.triangle_range[k, 1]):
        nearest = min(nearest, _hit_triangle(table.triangles[number], o, d))
    return nearest


@njit(cache=True, error_model="numpy")
def _hit_triangle(corners: Array, o: Point, d: Point) -> float:
    """Where a ray meets a triangle (3, 3), from either side.

    Source: Moeller and Trumbore, Fast, minimum storage ray/triangle intersection, 1997.
    """
    first = (corners[0, 0], corners[0, 1], corners[0, 2])
    ab = minus((corners[1, 0], corners[1, 1], corners[1, 2]), first)
    ac = minus((corners[2, 0], corners[2, 1], corners[2, 2]), first)
    p = cross(d, ac)
    volume = dot(ab, p)
    if volume == 0.0:
        return math.inf
    s = minus(o, first)
    u, q = dot(s, p) / volume, cross(s, ab)
    v, t = dot(d, q) / volume, dot(ac, q) / volume
    return t if u >= 0.0 and v >= 0.0 and u + v <= 1.0 and t >= 0.0 else math.inf


@njit(cache=True)
def entered_at(start: Array, end: Array, box: Array) -> float:
    """Share of its way at which a line from start to end comes into a box, or within 1 mm; inf for never.

    There it is within all three pairs of faces at once.
    """
    enters, leaves = 0.0, 1.0
    for axis in range(3):
        low, high = box[0, axis] - _MARGIN_M - start[axis], box[1, axis] + _MARGIN_M - start[axis]
        step = end[axis] - start[axis]
        if step == 0.0:
            if low > 0.0 or high < 0.0:
                return np.inf
            continue
        if step < 0.0:
            low, high = high, low
        enters, leaves = max(enters, low / step), min(leaves, high / step)
        if enters > leaves:
            return np.inf
    return enters
