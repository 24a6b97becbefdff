"""Where all parts and all solid shapes of a world are, as arrays for kernels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import compose, map_point
from peopleboy.sim.shapes.shape_table import ShapeTable, VisualShape, make_shape_table
from peopleboy.sim.shapes.shapes import ShapeKind

Array = NDArray[np.float64]

_SPHERE = int(ShapeKind.SPHERE)
_BOX = int(ShapeKind.BOX)
_CAPSULE = int(ShapeKind.CAPSULE)
_PLANE = int(ShapeKind.PLANE)
_MESH = int(ShapeKind.MESH)
_PARKED_M = -500.0


class Placements(NamedTuple):
    """B bodies with P parts; `places`, `hidden` and `stale` are set from outside, `poses` follow.

    Attributes:
        places: (B, 7) position [m] and quaternion x, y, z, w of each body's base.
        hidden: (B,) not there.
        stale: (B,) moved, hidden or shown since `refresh`.
        of_part: (P,) which body a part belongs to.
        base_from_part: (P, 4, 4).
        poses: (P, 4, 4) world from part; hidden ones are far below the floor.
    """

    places: Array
    hidden: NDArray[np.bool_]
    stale: NDArray[np.bool_]
    of_part: NDArray[np.int64]
    base_from_part: Array
    poses: Array


class Solids(NamedTuple):
    """S solid shapes, and where they are now.

    Attributes:
        table: what they are.
        poses: (S, 4, 4) world from shape, of a mesh world from part.
        boxes: (S, 2, 3) [m] least and greatest corner of the upright box around each, world frame.
    """

    table: ShapeTable
    poses: Array
    boxes: Array


def make_solids(shapes: Sequence[VisualShape]) -> Solids:
    """Give shapes, by the numbers of their parts, room for where they are, which `refresh` fills."""
    table = make_shape_table(shapes)
    count = len(table.kind)
    return Solids(table, np.zeros((count, 4, 4)), np.zeros((count, 2, 3)))


@njit(cache=True, nogil=True)
def refresh(bodies: Placements, solids: Solids) -> None:
    """Put all parts and solids of stale bodies where they are now."""
    for part in range(len(bodies.of_part)):
        body = bodies.of_part[part]
        if bodies.stale[body]:
            _place(bodies.places[body], bodies.base_from_part[part], bodies.poses[part])
            if bodies.hidden[body]:
                bodies.poses[part, 2, 3] = _PARKED_M
    table = solids.table
    for k in range(len(table.kind)):
        if bodies.stale[bodies.of_part[table.part[k]]]:
            compose(bodies.poses[table.part[k]], table.part_from_shape[k], solids.poses[k])
            solids.poses[k, 3, 3] = 1.0
            _box_around(table.kind[k], table.size[k], table.extent[k], solids.poses[k], solids.boxes[k])
    bodies.stale[:] = False


@njit(cache=True)
def _place(place: Array, base_from_part: Array, pose: Array) -> None:
    x, y, z, w = place[3], place[4], place[5], place[6]
    base = np.empty((3, 4))
    base[0, 0], base[0, 1], base[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)
    base[1, 0], base[1, 1], base[1, 2] = 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)
    base[2, 0], base[2, 1], base[2, 2] = 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)
    base[0, 3], base[1, 3], base[2, 3] = place[0], place[1], place[2]
    compose(base, base_from_part, pose)
    pose[3, :3] = 0.0
    pose[3, 3] = 1.0


@njit(cache=True)
def _box_around(kind: int, size: Array, extent: Array, pose: Array, box: Array) -> None:
    """Write the upright box around a shape; of a cylinder and of a mesh it is that of their own box."""
    if kind == _PLANE:
        box[0], box[1] = -math.inf, math.inf
        return
    low, high = np.empty(3), np.empty(3)
    for k in range(3):
        if kind == _MESH:
            low[k], high[k] = extent[0, k], extent[1, k]
            continue
        half = 0.5 * size[k]
        if kind == _SPHERE:
            half = size[0]
        elif kind != _BOX:
            half = size[1] if k < 2 else size[0] / 2.0 + (size[1] if kind == _CAPSULE else 0.0)
        low[k], high[k] = -half, half
    box[0], box[1] = math.inf, -math.inf
    for corner in range(8):
        point = map_point(
            pose,
            high[0] if corner & 1 else low[0],
            high[1] if corner & 2 else low[1],
            high[2] if corner & 4 else low[2],
        )
        for axis in range(3):
            box[0, axis], box[1, axis] = min(box[0, axis], point[axis]), max(box[1, axis], point[axis])
