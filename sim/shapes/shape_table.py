"""All visible shapes of one or of many worlds, as arrays for the kernels of the ray caster."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, transform
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.shapes.shapes import Shape, ShapeKind, Vector, load_triangles

Numbers = NDArray[np.int64]

# Number of surfaces of a shape, each a piece of a plane or of a quadric; a mesh has one per triangle.
_SURFACES = {
    ShapeKind.SPHERE: 1,
    ShapeKind.CAPSULE: 3,
    ShapeKind.CYLINDER: 3,
    ShapeKind.BOX: 6,
    ShapeKind.PLANE: 1,
}


@dataclass(frozen=True, slots=True, eq=False)
class VisualShape:
    """One shape of a part.

    Attributes:
        part: index into `Bullet.parts()`.
        kind, size, mesh: as in `Shape`.
        part_from_shape: (4, 4) pose of the shape in its part's frame.
        is_stand_in: as in `Shape`.
    """

    part: int
    kind: ShapeKind
    size: Vector
    part_from_shape: Matrix
    mesh: Path | None
    is_stand_in: bool = False


def as_given(shape: Shape, part: int) -> VisualShape:
    """Return a shape for the part with a number."""
    pose = pose_matrices(shape.position, shape.orientation)
    return VisualShape(part, shape.kind, shape.size, pose, shape.mesh, shape.is_stand_in)


class ShapeTable(NamedTuple):
    """S shapes with M surfaces and T triangles in total; the arrays are read-only.

    Attributes:
        kind: (S,) ShapeKind.
        size: (S, 3) as in `Shape`.
        part: (S,) number of the part that the shape belongs to.
        part_from_shape: (S, 4, 4) pose in the part's frame; for a mesh the identity.
        triangle_range: (S, 2) first and one after the last triangle of a mesh, 0 and 0 for other shapes.
        triangles: (T, 3, 3) [m] corners, in the part's frame.
        extent: (S, 2, 3) [m] least and greatest corner of a mesh, in the part's frame; 0 for other shapes.
        reach: (S,) [m] largest distance of a shape's points from the origin of its frame, inf for a plane.
        is_stand_in: (S,) shapes that pinhole cameras do not see, as they see a skin instead.
        first_surface: (S,) number of the shape's first surface.
        surface_part: (M,) number of the part that a surface belongs to.
        surface_shape: (M,) number of the shape that a surface belongs to.
    """

    kind: NDArray[np.int64]
    size: NDArray[np.float64]
    part: NDArray[np.int64]
    part_from_shape: NDArray[np.float64]
    triangle_range: NDArray[np.int64]
    triangles: NDArray[np.float64]
    extent: NDArray[np.float64]
    reach: NDArray[np.float64]
    is_stand_in: NDArray[np.bool_]
    first_surface: NDArray[np.int64]
    surface_part: NDArray[np.int32]
    surface_shape: NDArray[np.int32]


def make_shape_table(shapes: Sequence[VisualShape]) -> ShapeTable:
    """Convert shapes to arrays, in their order.

    Raises:
        BadInput: a mesh file cannot be read.
    """
    meshes = [_triangles(shape) for shape in shapes]
    ends = np.cumsum([0, *map(len, meshes)])
    counts = [_SURFACES.get(shape.kind, len(mesh)) for shape, mesh in zip(shapes, meshes, strict=True)]
    part = np.array([shape.part for shape in shapes], np.int64)
    poses = [np.eye(4) if shape.kind == ShapeKind.MESH else shape.part_from_shape for shape in shapes]
    extent = np.array([_extent(mesh) for mesh in meshes], np.float64).reshape(-1, 2, 3)
    table = ShapeTable(
        kind=np.array([shape.kind for shape in shapes], np.int64),
        size=np.array([shape.size for shape in shapes], np.float64).reshape(-1, 3),
        part=part,
        part_from_shape=np.array(poses, np.float64).reshape(-1, 4, 4),
        triangle_range=np.stack([ends[:-1], ends[1:]], axis=1).astype(np.int64),
        triangles=np.concatenate([np.zeros((0, 3, 3)), *meshes]),
        extent=extent,
        reach=np.array([_reach(shape, own) for shape, own in zip(shapes, extent, strict=True)], np.float64),
        is_stand_in=np.array([shape.is_stand_in for shape in shapes], np.bool_),
        first_surface=np.cumsum([0, *counts])[:-1].astype(np.int64),
        surface_part=np.repeat(part, counts).astype(np.int32),
        surface_shape=np.repeat(np.arange(len(shapes)), counts).astype(np.int32),
    )
    for array in table:
        array.setflags(write=False)
    return table


def _triangles(shape: VisualShape) -> NDArray[np.float64]:
    """Return the triangles (T, 3, 3) of a mesh in its part's frame; none for other shapes."""
    if shape.kind != ShapeKind.MESH or shape.mesh is None:
        return np.zeros((0, 3, 3))
    triangles = load_triangles(shape.mesh) * np.array(shape.size)
    # Mirroring turns outsides into insides, unless the order of the corners is reversed too.
    is_mirrored = np.prod(np.sign(shape.size)) < 0.0
    return transform(shape.part_from_shape, triangles[:, ::-1] if is_mirrored else triangles)


def _extent(triangles: NDArray[np.float64]) -> NDArray[np.float64]:
    if len(triangles) == 0:
        return np.zeros((2, 3))
    return np.stack([triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))])


def _reach(shape: VisualShape, extent: NDArray[np.float64]) -> float:
    """Return the largest distance [m] of a shape, or of a mesh's extent (2, 3), from the frame's origin."""
    length, radius, _ = shape.size
    if shape.kind == ShapeKind.SPHERE:
        return length
    if shape.kind in (ShapeKind.CAPSULE, ShapeKind.CYLINDER):
        return length / 2.0 + radius
    if shape.kind == ShapeKind.BOX:
        return float(np.linalg.norm(shape.size)) / 2.0
    return math.inf if shape.kind == ShapeKind.PLANE else float(np.linalg.norm(np.abs(extent).max(axis=0)))


# The shape tables of many worlds in common arrays.


class JoinedTables(NamedTuple):
    """B concatenated tables; the numbers within each table are unchanged.

    Attributes:
        arrays: concatenated arrays, read-only.
        shape, surface, triangle: (B + 1,) offsets of each table's entries.
    """

    arrays: ShapeTable
    shape: Numbers
    surface: Numbers
    triangle: Numbers


def join_tables(tables: Sequence[ShapeTable]) -> JoinedTables:
    """Concatenate tables."""
    return JoinedTables(
        arrays=ShapeTable(*map(_fixed, zip(*tables, strict=True))),
        shape=ends([len(table.kind) for table in tables]),
        surface=ends([len(table.surface_part) for table in tables]),
        triangle=ends([len(table.triangles) for table in tables]),
    )


@njit(cache=True, nogil=True)
def table_of(joined: JoinedTables, number: int) -> ShapeTable:
    """Return one of the tables, as views of those arrays."""
    arrays = joined.arrays
    s, s_end = joined.shape[number], joined.shape[number + 1]
    m, m_end = joined.surface[number], joined.surface[number + 1]
    t, t_end = joined.triangle[number], joined.triangle[number + 1]
    return ShapeTable(
        arrays.kind[s:s_end],
        arrays.size[s:s_end],
        arrays.part[s:s_end],
        arrays.part_from_shape[s:s_end],
        arrays.triangle_range[s:s_end],
        arrays.triangles[t:t_end],
        arrays.extent[s:s_end],
        arrays.reach[s:s_end],
        arrays.is_stand_in[s:s_end],
        arrays.first_surface[s:s_end],
        arrays.surface_part[m:m_end],
        arrays.surface_shape[m:m_end],
    )


def ends(counts: Sequence[int]) -> Numbers:
    """Return the offsets (B + 1,) for B counts."""
    return np.cumsum([0, *counts]).astype(np.int64)


def _fixed(arrays: Sequence[NDArray[Any]]) -> NDArray[Any]:
    joined = np.concatenate(arrays)
    joined.setflags(write=False)
    return joined
