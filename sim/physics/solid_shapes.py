"""Solid shapes of a world as arrays: poses and ray casting (numba kernels)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from peopleboy.sim.geometry.vectors import Point, compose, cross, dot, map_corner, minus, turn_back
from peopleboy.sim.shapes.rays import hit_shape
from peopleboy.sim.shapes.shape_table import ShapeTable, VisualShape, as_given, make_shape_table
from peopleboy.sim.shapes.shapes import Shape, ShapeKind

Array = NDArray[np.float64]

_SPHERE = int(ShapeKind.SPHERE)
_BOX = int(ShapeKind.BOX)
_CAPSULE = int(ShapeKind.CAPSULE)
_PLANE = int(ShapeKind.PLANE)
_MESH = int(ShapeKind.MESH)
_PARKED_M = -500.0


@dataclass(frozen=True, slots=True)
class PartKey:
    """One part of the world: a link of a body; -1 is the body's base."""

    name: str
    link: int
    link_name: str


class Placements(NamedTuple):
    """B bodies with P parts. Callers set `places`, `hidden` and `stale`; `refresh` updates `poses`.

    Attributes:
        places: (B, 7) position [m] and quaternion x, y, z, w of each body's base.
        hidden: (B,) whether the body is absent.
        stale: (B,) whether the body was moved, hidden or shown since `refresh`.
        of_part: (P,) number of the body to which a part belongs.
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
    """S solid shapes with their current poses.

    Attributes:
        table: the shapes.
        poses: (S, 4, 4) world from shape; for a mesh world from part.
        boxes: (S, 2, 3) [m] least and greatest corner of the axis-aligned bounding boxes, world frame.
    """

    table: ShapeTable
    poses: Array
    boxes: Array


def make_solids(shapes: Sequence[VisualShape]) -> Solids:
    """Return solids for shapes with part numbers; `refresh` fills in their poses."""
    table = make_shape_table(shapes)
    count = len(table.kind)
    return Solids(table, np.zeros((count, 4, 4)), np.zeros((count, 2, 3)))


@njit(cache=True, nogil=True)
def refresh(bodies: Placements, solids: Solids) -> None:
    """Update the poses of all parts and solids of stale bodies."""
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


class PlacedBodies:
    """Bodies by number, placed by the caller, whose solids block rays.

    Attributes:
        places, hidden, stale: (B, 7), (B,) and (B,) as in `Placements`.
    """

    def __init__(self) -> None:
        self.places, self.hidden, self.stale = np.zeros((0, 7)), np.zeros(0, np.bool_), np.zeros(0, np.bool_)
        self._of_part: list[int] = []
        self._base_from_part: list[Array] = []
        self._solid: list[VisualShape] = []
        self._packed: tuple[Placements, Solids] | None = None

    def add(self) -> int:
        """Add a body without parts, and return its number."""
        self.places = np.concatenate([self.places, np.zeros((1, 7))])
        self.hidden, self.stale = (np.append(flags, False) for flags in (self.hidden, self.stale))
        self._packed = None
        return len(self.places) - 1

    def add_part(self, body: int, base_from_part: Array, solid: Sequence[Shape]) -> None:
        """Add a part to a body at a pose (4, 4) in its base frame, with solids in the part's frame."""
        self._solid += [as_given(shape, len(self._of_part)) for shape in solid]
        self._of_part.append(body)
        self._base_from_part.append(base_from_part)
        self._packed = None

    def put(self, body: int | Sequence[int], positions: ArrayLike, orientations: ArrayLike) -> None:
        """Place one body, or N bodies, at (3,) or (N, 3) [m] and unit quaternions (4,) or (N, 4)."""
        self.places[body, :3], self.places[body, 3:] = positions, orientations
        self.stale[body] = True

    def now(self) -> tuple[Placements, Solids]:
        """Return all bodies and solids with current poses."""
        if self._packed is None:
            self.stale[:] = True
            count = len(self._of_part)
            self._packed = (
                Placements(
                    places=self.places,
                    hidden=self.hidden,
                    stale=self.stale,
                    of_part=np.array(self._of_part, np.int64),
                    base_from_part=np.array(self._base_from_part).reshape(-1, 4, 4),
                    poses=np.zeros((count, 4, 4)),
                ),
                make_solids(self._solid),
            )
        if self.stale.any():
            refresh(*self._packed)
        return self._packed

    def rebind(self, bodies: Placements, solids: Solids) -> None:
        """Use other arrays, which already hold the same values, from now on."""
        self._packed = bodies, solids
        self.places, self.hidden, self.stale = bodies.places, bodies.hidden, bodies.stale


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
    """Write the axis-aligned box around a shape; for cylinders and meshes that of their oriented box."""
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
        point = map_corner(pose, low, high, corner)
        for axis in range(3):
            box[0, axis], box[1, axis] = min(box[0, axis], point[axis]), max(box[1, axis], point[axis])


_MARGIN_M = 1e-3  # around boxes; far more than the error of PyBullet's rays
_BLOCK = 15  # rays that are culled together, such as those of a sonar


@njit(cache=True, nogil=True)
def cast(
    starts: Array, ends: Array, bodies: Placements, solids: Solids, passed: int
) -> tuple[Array, NDArray[np.int64]]:
    """Find the first hit of each ray; shapes are hit from outside only, triangles from both sides.

    Args:
        starts: (R, 3) [m] world frame.
        ends: (R, 3) [m].
        bodies: bodies with current poses.
        solids: solids with current poses.
        passed: number of a body that rays ignore, -1 for none.

    Returns:
        fraction: (R,) hit distance as a fraction of the ray, 1 without a hit.
        part: (R,) number of the hit part, -1 for none.
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
    """Do the same as `cast`, into arrays initialised to 1 and -1; requires at least one ray."""
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
    """Write (2, 3) least and greatest corner of the axis-aligned box around rays."""
    for axis in range(3):
        low, high = np.inf, -np.inf
        for ray in range(first, stop):
            low = min(low, starts[ray, axis], ends[ray, axis])
            high = max(high, starts[ray, axis], ends[ray, axis])
        box[0, axis], box[1, axis] = low, high


@njit(cache=True)
def _share(one: Array, other: Array, margin_m: float) -> bool:
    """Return whether two axis-aligned boxes overlap, within a margin."""
    for axis in range(3):
        if one[0, axis] > other[1, axis] + margin_m or one[1, axis] < other[0, axis] - margin_m:
            return False
    return True


@njit(cache=True)
def _hit(start: Array, end: Array, solids: Solids, k: int) -> float:
    """Return where a ray enters a solid, as a fraction of its length; inf for a miss."""
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
    """Return where a ray hits a triangle (3, 3) from either side, as a fraction of its length.

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
    """Return the fraction at which a line from start to end enters a box, enlarged by 1 mm; inf for a miss.

    Slab method: the line is inside where it is within all three pairs of faces.
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
