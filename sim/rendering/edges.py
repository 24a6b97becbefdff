"""Edges without stairs: where surfaces meet within a pixel, each gets the share of it that it fills.

Four rays go through a pixel, none in a row or column with another. Beside a pixel that shows something else,
the ray nearest to that is tried against what both show, and if it meets the other, the next nearest is. What
they meet looks as one of the two pixels does. So nothing is evaluated twice, and any image of the view can
do it. Where an image shows no step, nothing is done.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose
from peopleboy.sim.geometry.vectors import compose
from peopleboy.sim.rendering.canvas import Lens
from peopleboy.sim.rendering.rays import hit_shape
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.shape_table import ShapeTable
from peopleboy.sim.shapes.shapes import ShapeKind

Array = NDArray[np.float64]
Pixels = NDArray[np.int32]

# [px] where rays go through a pixel, from its middle: the first is nearest to the pixel above it, the next to
# those on the right, on the left and below; and which rays are next nearest to these.
_RAYS = np.array([(-0.125, -0.375), (0.375, -0.125), (-0.375, 0.125), (0.125, 0.375)])
_NEXT = (1, 3, 0, 2)

_BOX = int(ShapeKind.BOX)
_CAPSULE = int(ShapeKind.CAPSULE)
_MESH = int(ShapeKind.MESH)
_NONE = -1

_BEHIND = 1.1  # what is farther than this many times another's depth is behind it all over a pixel


class Shapes(NamedTuple):
    """What rays are tried against.

    Attributes:
        kind, size, first_surface, surface_shape: as in `ShapeTable`.
        piece: (M,) the piece that a surface is of: itself, but of a capsule or mesh its first surface.
        pose: (S, 3, 4) shape from camera.
    """

    kind: NDArray[np.int64]
    size: Array
    first_surface: NDArray[np.int64]
    surface_shape: Pixels
    piece: Pixels
    pose: Array


def smooth(
    image: NDArray[np.float32],
    contrast: float,
    view: View,
    table: ShapeTable,
    camera: Pinhole,
    world_from_camera: Matrix,
    world_from_part: Matrix,
) -> None:
    """Give each edge of an image the mean of what fills it, in place; a view without surfaces keeps its own.

    Args:
        image: (H, W, C) linear in light or radiance, C-contiguous.
        contrast: least difference of any channel between two pixels that makes an edge.
        view: what each pixel sees.
        table: the world's shapes.
        camera: the pinhole camera.
        world_from_camera: (4, 4).
        world_from_part: (P, 4, 4).
    """
    if view.surface is None:
        return
    lens = Lens(camera.focal_px, *camera.centre_px, camera.width, camera.height)
    pose = _shapes_from_camera(table, invert_pose(world_from_camera) @ world_from_part)
    shapes = Shapes(table.kind, table.size, table.first_surface, table.surface_shape, _pieces_of(table), pose)
    piece = _find_pieces(view.part, view.surface, shapes.piece)
    values, least = image.reshape(-1, image.shape[2]), np.float32(contrast)
    pixel = _find_pixels(image, piece, least)
    sources = _find_sources(pixel, values, least, view.depth, piece, shapes, lens)
    _average(values, pixel, sources)


@njit(cache=True)
def _average(values: NDArray[np.float32], pixel: Pixels, sources: Pixels) -> None:
    channels = values.shape[1]
    found = np.empty((len(pixel), channels), np.float32)
    for i in range(len(pixel)):
        for c in range(channels):
            found[i, c] = 0.25 * (
                values[sources[i, 0], c]
                + values[sources[i, 1], c]
                + values[sources[i, 2], c]
                + values[sources[i, 3], c]
            )
    for i in range(len(pixel)):
        for c in range(channels):
            values[pixel[i], c] = found[i, c]


@njit(cache=True)
def _shapes_from_camera(table: ShapeTable, camera_from_part: Array) -> Array:
    """(S, 3, 4) the camera's frame in that of each shape."""
    poses, pose = np.empty((len(table.part), 3, 4)), np.empty((3, 4))
    for shape in range(len(table.part)):
        compose(camera_from_part[table.part[shape]], table.part_from_shape[shape], pose)
        for i in range(3):
            for j in range(3):
                poses[shape, i, j] = pose[j, i]
            poses[shape, i, 3] = -(
                pose[0, i] * pose[0, 3] + pose[1, i] * pose[1, 3] + pose[2, i] * pose[2, 3]
            )
    return poses


@njit(cache=True)
def _pieces_of(table: ShapeTable) -> Pixels:
    """(M,) the piece that a surface is of: itself, but of a capsule or mesh its first surface."""
    pieces = np.empty(len(table.surface_shape), np.int32)
    for surface in range(len(pieces)):
        shape = table.surface_shape[surface]
        is_one = table.kind[shape] in (_CAPSULE, _MESH)
        pieces[surface] = table.first_surface[shape] if is_one else surface
    return pieces


@njit(cache=True)
def _find_pieces(part: Pixels, surface: Pixels, pieces: Pixels) -> Pixels:
    """(H, W) number of the piece that each pixel shows, -1 for nothing."""
    height, width = part.shape
    piece = np.empty((height, width), np.int32)
    for v in range(height):
        for u in range(width):
            piece[v, u] = _NONE if part[v, u] < 0 else pieces[surface[v, u]]
    return piece


@njit(cache=True)
def _find_pixels(image: NDArray[np.float32], piece: Pixels, contrast: np.float32) -> Pixels:
    """Number the pixels beside which another piece is seen, and looks different."""
    height, width = piece.shape
    pixel, found = np.empty(height * width, np.int32), 0
    below, above = np.zeros(width, np.bool_), np.zeros(width, np.bool_)
    for v in range(height):
        above, below = below, above
        is_after = False
        for u in range(width):
            is_edge = is_after or above[u]
            is_after = u + 1 < width and piece[v, u + 1] != piece[v, u]
            is_after = is_after and _differ(image[v, u], image[v, u + 1], contrast)
            below[u] = v + 1 < height and piece[v + 1, u] != piece[v, u]
            below[u] = below[u] and _differ(image[v, u], image[v + 1, u], contrast)
            if is_edge or is_after or below[u]:
                pixel[found] = v * width + u
                found += 1
    return pixel[:found].copy()


@njit(cache=True)
def _differ(one: NDArray[np.float32], other: NDArray[np.float32], contrast: np.float32) -> bool:
    """Whether two values (C,) differ by more than the contrast."""
    for c in range(len(one)):  # noqa: SIM110 (kernels have no generators)
        if abs(one[c] - other[c]) > contrast:
            return True
    return False


@njit(cache=True, error_model="numpy")
def _find_sources(  # noqa: C901 (in one function)
    pixel: Pixels,
    values: NDArray[np.float32],
    contrast: np.float32,
    depth: NDArray[np.float32],
    piece: Pixels,
    shapes: Shapes,
    lens: Lens,
) -> Pixels:
    """(E, 4) the numbers of the pixels that look like what each ray meets.

    No ray is tried where that would look the same.

    All is in one function, as to pass arrays to a kernel costs as much as to try a ray.
    """
    kind, size, first_surface, shape_of, piece_of, pose = shapes
    z, pieces = depth.reshape(-1), piece.reshape(-1)
    sources, scale = np.repeat(pixel, len(_RAYS)).reshape(-1, len(_RAYS)), 1.0 / lens.focal
    for i in range(len(pixel)):
        own = pixel[i]
        v, u = own // lens.width, own % lens.width
        beside = (
            own if v == 0 else own - lens.width,
            own if u == lens.width - 1 else own + 1,
            own if u == 0 else own - 1,
            own if v == lens.height - 1 else own + lens.width,
        )
        one, depth_one = pieces[own], z[own]
        for side in range(4):
            at = beside[side]
            other = pieces[at]
            if other == one or not _differ(values[own], values[at], contrast):
                continue
            first, last, count = _in_order(one, other, shape_of[one] == shape_of[other], depth_one, z[at])
            for turn in range(2):
                # If the ray nearest to the pixel beside meets what that shows, the next nearest may, too, but
                # not if it has another such pixel nearer to it.
                k = side if turn == 0 else _NEXT[side]
                if turn == 1 and pieces[beside[k]] != one:
                    break
                x = (u + _RAYS[k, 0] - lens.centre_u) * scale
                y = (v + _RAYS[k, 1] - lens.centre_v) * scale
                best, seen = math.inf, last if count == 1 else one
                for j in range(count):
                    p = first if j == 0 else last
                    s = shape_of[p]
                    if kind[s] == _MESH:
                        best, seen = 0.0, one
                        break
                    if kind[s] == _BOX:
                        t, surface = _hit_face(p - first_surface[s], size[s], pose[s], x, y), p
                    else:
                        o = (pose[s, 0, 3], pose[s, 1, 3], pose[s, 2, 3])
                        d = (
                            pose[s, 0, 0] * x + pose[s, 0, 1] * y + pose[s, 0, 2],
                            pose[s, 1, 0] * x + pose[s, 1, 1] * y + pose[s, 1, 2],
                            pose[s, 2, 0] * x + pose[s, 2, 1] * y + pose[s, 2, 2],
                        )
                        t, local = hit_shape(kind[s], (size[s, 0], size[s, 1], size[s, 2]), o, d)
                        surface = piece_of[first_surface[s] + local]
                    if t < best:
                        best, seen = t, surface
                if seen == one or (seen != other and shape_of[seen] == shape_of[one]):
                    break
                sources[i, k] = at
    return sources


@njit(cache=True, error_model="numpy")
def _hit_face(face: int, size: Array, pose: Array, x: float, y: float) -> float:
    """Where the camera's ray (x, y, 1) meets one face of a box, infinite if it does not."""
    i, j, k = face % 3, (face + 1) % 3, (face + 2) % 3
    along = pose[i, 0] * x + pose[i, 1] * y + pose[i, 2]
    end = 0.5 * size[i] if face < 3 else -0.5 * size[i]
    t = (end - pose[i, 3]) / along
    across = pose[j, 3] + t * (pose[j, 0] * x + pose[j, 1] * y + pose[j, 2])
    up = pose[k, 3] + t * (pose[k, 0] * x + pose[k, 1] * y + pose[k, 2])
    is_met = (abs(across) <= 0.5 * size[j]) & (abs(up) <= 0.5 * size[k]) & (end * along < 0.0)
    return t if is_met else math.inf


@njit(cache=True)
def _in_order(one: int, other: int, is_same: bool, z: float, other_z: float) -> tuple[int, int, int]:
    """Two pieces by their depths, the nearer first, and how many of their shapes are to be tried.

    Only the nearer is if the other is far behind, and of two pieces of one shape the second, where a miss
    tells nothing.
    """
    if is_same and one != _NONE and other != _NONE:
        return other, one, 1
    if other_z < z:
        one, other, z, other_z = other, one, other_z, z
    return one, other, 1 if other == _NONE or other_z > _BEHIND * z else 2
