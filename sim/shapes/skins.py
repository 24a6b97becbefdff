"""Skins: closed meshes that bend with the parts of a person, and their pose at an instant."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import compose
from peopleboy.sim.shapes.shape_table import ShapeTable
from peopleboy.sim.shapes.shapes import ShapeKind

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Skin:
    """The mesh of one person; parts are numbered in the person's order.

    Attributes:
        vertices: (V, 3) [m] at rest.
        triangles: (T, 3) corners, counterclockwise from outside.
        part: (T,) part that each triangle belongs to.
        bones: (V, 4) bones that move each vertex.
        weights: (V, 4) their shares, which sum to 1.
        part_of_bone: (B,) part whose frame follows each bone.
        part_from_rest: (B, 3, 4) poses of the mesh at rest in the frames of those parts.
    """

    vertices: Array
    triangles: Numbers
    part: Numbers
    bones: Numbers
    weights: Array
    part_of_bone: Numbers
    part_from_rest: Array


class SkinTable(NamedTuple):
    """K skins with V vertices and T triangles in total; the arrays are read-only.

    Attributes:
        first_vertex, first_triangle: (K + 1,) offsets of each skin's vertices and triangles.
        vertices: (V, 3) [m] at rest.
        bones, weights: (V, 4) as in `Skin`.
        triangles: (T, 3) numbers of vertices in this table.
        part: (T,) number of the world's part that a triangle belongs to.
        vertex_parts: (V, 2) least and greatest number of the parts whose triangles meet at a vertex.
        part_of_bone: (K, B) numbers of the world's parts.
        part_from_rest: (K, B, 3, 4) as in `Skin`.
        first_surface: number of the surface that is the first triangle; the others follow.
    """

    first_vertex: Numbers
    first_triangle: Numbers
    vertices: Array
    bones: Numbers
    weights: Array
    triangles: Numbers
    part: NDArray[np.int32]
    vertex_parts: Numbers
    part_of_bone: Numbers
    part_from_rest: Array
    first_surface: int


class PosedSkins(NamedTuple):
    """Skins at an instant.

    Attributes:
        table: the skins.
        vertices: (V, 3) [m] world frame.
        normals: (V, 3) unit normals of the vertices, world frame.
    """

    table: SkinTable
    vertices: Array
    normals: Array


def join_skins(
    table: ShapeTable, skins: Sequence[tuple[Skin, Sequence[int]]]
) -> tuple[ShapeTable, SkinTable | None]:
    """Add skins to a world's shapes, each with the numbers of its person's parts in the world.

    Returns:
        the shapes, with one more and a surface per triangle for each skin; and the skins, None without any.
    """
    if not skins:
        return table, None
    vertices = np.cumsum([0, *(len(skin.vertices) for skin, _ in skins)]).astype(np.int64)
    triangles = np.cumsum([0, *(len(skin.triangles) for skin, _ in skins)]).astype(np.int64)
    part = np.concatenate([np.array(parts)[skin.part] for skin, parts in skins])
    corners = np.concatenate(
        [skin.triangles + first for (skin, _), first in zip(skins, vertices, strict=False)]
    )
    joined = SkinTable(
        first_vertex=vertices,
        first_triangle=triangles,
        vertices=np.concatenate([skin.vertices for skin, _ in skins]),
        bones=np.concatenate([skin.bones for skin, _ in skins]),
        weights=np.concatenate([skin.weights for skin, _ in skins]),
        triangles=corners,
        part=part.astype(np.int32),
        vertex_parts=_parts_at(corners, part, int(vertices[-1])),
        part_of_bone=np.stack([np.array(parts)[skin.part_of_bone] for skin, parts in skins]),
        part_from_rest=np.stack([skin.part_from_rest for skin, _ in skins]),
        first_surface=len(table.surface_part),
    )
    for array in joined[:-1]:
        array.setflags(write=False)
    return _with_shapes(table, joined), joined


def _parts_at(triangles: Numbers, part: Numbers, vertices: int) -> Numbers:
    """Return `SkinTable.vertex_parts`."""
    least, most = np.full(vertices, np.iinfo(np.int64).max), np.full(vertices, -1)
    for corner in range(3):
        np.minimum.at(least, triangles[:, corner], part)
        np.maximum.at(most, triangles[:, corner], part)
    return np.stack([least, most], axis=1)


def _with_shapes(table: ShapeTable, skins: SkinTable) -> ShapeTable:
    """Append one shape without extent for each skin, and all surfaces."""
    first, count = len(table.kind), len(skins.first_vertex) - 1
    sizes = np.diff(skins.first_triangle)
    extended = ShapeTable(
        kind=np.append(table.kind, np.full(count, ShapeKind.SKIN)),
        size=np.concatenate([table.size, np.zeros((count, 3))]),
        part=np.append(table.part, skins.part_of_bone[:, 0]),
        part_from_shape=np.concatenate([table.part_from_shape, np.tile(np.eye(4), (count, 1, 1))]),
        triangle_range=np.concatenate([table.triangle_range, np.zeros((count, 2), np.int64)]),
        triangles=table.triangles,
        extent=np.concatenate([table.extent, np.zeros((count, 2, 3))]),
        reach=np.append(table.reach, np.zeros(count)),
        is_stand_in=np.append(table.is_stand_in, np.zeros(count, np.bool_)),
        first_surface=np.append(table.first_surface, skins.first_surface + skins.first_triangle[:-1]),
        surface_part=np.append(table.surface_part, skins.part),
        surface_shape=np.append(
            table.surface_shape, np.repeat(np.arange(count, dtype=np.int32) + first, sizes)
        ),
    )
    for array in extended:
        array.setflags(write=False)
    return extended


def pose_skins(skins: SkinTable, world_from_part: Array) -> PosedSkins:
    """Bend all skins by the poses (P, 4, 4) of the world's parts.

    Each vertex is the mean of its places in the frames of four bones (linear blend skinning); all sums have a
    fixed order. Normals are those of the triangles around a vertex, weighted by area.
    """
    vertices, normals = np.empty_like(skins.vertices), np.zeros_like(skins.vertices)
    _pose(skins, world_from_part, vertices)
    _add_normals(skins.triangles, vertices, normals)
    return PosedSkins(skins, vertices, normals)


@njit(cache=True, nogil=True)
def _pose(skins: SkinTable, world_from_part: Array, vertices: Array) -> None:
    """Write the vertices (V, 3) in the world frame."""
    bones = skins.part_of_bone.shape[1]
    world_from_rest = np.empty((bones, 3, 4))
    for k in range(len(skins.part_of_bone)):
        for bone in range(bones):
            part = skins.part_of_bone[k, bone]
            compose(world_from_part[part], skins.part_from_rest[k, bone], world_from_rest[bone])
        for v in range(skins.first_vertex[k], skins.first_vertex[k + 1]):
            x, y, z = skins.vertices[v, 0], skins.vertices[v, 1], skins.vertices[v, 2]
            a, b, c = 0.0, 0.0, 0.0
            for i in range(skins.bones.shape[1]):
                weight = skins.weights[v, i]
                if weight > 0.0:
                    pose = world_from_rest[skins.bones[v, i]]
                    a += weight * (pose[0, 0] * x + pose[0, 1] * y + pose[0, 2] * z + pose[0, 3])
                    b += weight * (pose[1, 0] * x + pose[1, 1] * y + pose[1, 2] * z + pose[1, 3])
                    c += weight * (pose[2, 0] * x + pose[2, 1] * y + pose[2, 2] * z + pose[2, 3])
            vertices[v, 0], vertices[v, 1], vertices[v, 2] = a, b, c


@njit(cache=True, nogil=True, error_model="numpy")
def _add_normals(triangles: Numbers, vertices: Array, normals: Array) -> None:
    """Write the unit normals (V, 3) of vertices; `normals` must be 0 before."""
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        px, py, pz = vertices[a, 0], vertices[a, 1], vertices[a, 2]
        ux, uy, uz = vertices[b, 0] - px, vertices[b, 1] - py, vertices[b, 2] - pz
        wx, wy, wz = vertices[c, 0] - px, vertices[c, 1] - py, vertices[c, 2] - pz
        nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
        for i in (a, b, c):
            normals[i, 0] += nx
            normals[i, 1] += ny
            normals[i, 2] += nz
    for v in range(len(normals)):
        x, y, z = normals[v, 0], normals[v, 1], normals[v, 2]
        scale = 1.0 / max(np.sqrt(x * x + y * y + z * z), 1e-30)
        normals[v, 0], normals[v, 1], normals[v, 2] = scale * x, scale * y, scale * z
