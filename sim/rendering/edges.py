"""Edges without stairs: where surfaces meet within a pixel, each gets the share of it that it fills.

Four rays through a pixel, none in a row or column with another, tell what they meet among the shapes that
the pixel and its eight neighbours show; a ray in a quarter whose neighbours all show the same needs no trial.
What that looks like is known already: it is taken from the nearest of these pixels that shows the same
surface. So nothing is evaluated twice, and any image of the view can do it. Where an image shows no step,
nothing is done.
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
Four = tuple[int, int, int, int]

# [px] where rays go through a pixel, from its middle.
_RAYS = np.array([(-0.125, -0.375), (0.375, -0.125), (-0.375, 0.125), (0.125, 0.375)])
# The neighbourhood, nearest first.
_AROUND = np.array([(0, 0), (0, -1), (-1, 0), (1, 0), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)])

_CAPSULE = int(ShapeKind.CAPSULE)
_MESH = int(ShapeKind.MESH)
_NONE, _UNKNOWN = -1, -2

_NEARER = 0.95  # what is nearer than this share of a shape's depth hides it all over a pixel
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
    pixel = _find_pixels(image, piece, np.float32(contrast))
    sources = _find_sources(pixel, view.depth, piece, shapes, lens)
    _average(image.reshape(-1, image.shape[2]), pixel, sources)


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


def _pieces_of(table: ShapeTable) -> Pixels:
    """(M,) the piece that a surface is of: itself, but of a capsule or mesh its first surface."""
    shape = table.surface_shape
    is_one = np.isin(table.kind, (_CAPSULE, _MESH))[shape]
    return np.where(is_one, table.first_surface[shape], np.arange(len(shape))).astype(np.int32)


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
def _find_sources(
    pixel: Pixels, depth: NDArray[np.float32], piece: Pixels, shapes: Shapes, lens: Lens
) -> Pixels:
    """(E, 4) the numbers of the pixels that look like what each ray meets.

    Nearly everywhere there are but two pieces. Then no array is passed to a kernel: to pass three costs as
    much as to try a ray.
    """
    kind, size, first_surface, shape_of, piece_of, pose = shapes
    z = depth.reshape(-1)
    sources = np.empty((len(pixel), len(_RAYS)), np.int32)
    around, near, nearest = np.empty((9, 2), np.int64), np.empty(9, np.int64), np.empty(9)
    for i in range(len(pixel)):
        own = pixel[i]
        v, u = own // lens.width, own % lens.width
        up, down = max(v - 1, 0), min(v + 1, lens.height - 1)
        left, right = max(u - 1, 0), min(u + 1, lens.width - 1)
        one = piece[v, u]
        beside = (piece[v, left], piece[up, u], piece[v, right], piece[down, u])
        askew = (piece[up, left], piece[up, right], piece[down, left], piece[down, right])
        second, at = _second(one, beside, askew)
        known, other = 0, own
        if at < 0:
            known = _look_around(v, u, piece, around)
            count, last = _shapes_of(known, around, z, shape_of, near, nearest)
        else:
            # Rows and columns in the order of `beside` and `askew`.
            row, column = (v, up, v, down, up, up, down, down), (left, u, right, u, left, right, left, right)
            other = row[at] * lens.width + column[at]
            near[0], near[1], nearest[0], nearest[1], count, last = _in_order(
                one, second, shape_of[one], shape_of[second], z[own], z[other]
            )
        for k in range(len(_RAYS)):
            best, seen = math.inf, one
            if _is_open(k, one, beside, askew):
                x = (u + _RAYS[k, 0] - lens.centre_u) / lens.focal
                y = (v + _RAYS[k, 1] - lens.centre_v) / lens.focal
                seen = last
                for j in range(count):
                    if best < _NEARER * nearest[j]:
                        break
                    s = near[j]
                    if kind[s] == _MESH:
                        best, seen = 0.0, _UNKNOWN
                    o = (pose[s, 0, 3], pose[s, 1, 3], pose[s, 2, 3])
                    d = (
                        pose[s, 0, 0] * x + pose[s, 0, 1] * y + pose[s, 0, 2],
                        pose[s, 1, 0] * x + pose[s, 1, 1] * y + pose[s, 1, 2],
                        pose[s, 2, 0] * x + pose[s, 2, 1] * y + pose[s, 2, 2],
                    )
                    t, surface = hit_shape(kind[s], (size[s, 0], size[s, 1], size[s, 2]), o, d)
                    if t < best:
                        best, seen = t, piece_of[first_surface[s] + surface]
            if known:
                sources[i, k] = _place_of(seen, known, around, shape_of)
            else:
                is_own = _is_own(seen, one, second, shape_of[seen], shape_of[one])
                sources[i, k] = own if is_own else other
    return sources


@njit(cache=True)
def _is_own(seen: int, one: int, second: int, shape: int, own_shape: int) -> bool:
    """Whether what a ray meets looks like the first of two pieces: another face of a box does, too."""
    if seen == one:
        return True
    return seen == _UNKNOWN or (seen != second and shape == own_shape)


@njit(cache=True)
def _is_open(ray: int, one: int, beside: Four, askew: Four) -> bool:
    """Whether those next to the quarter of a ray show something else than the pixel does."""
    side, end = 3 * (ray // 2) + 1 - ray // 2, 2 * (ray % 2)
    return bool((beside[side] != one) | (beside[end] != one) | (askew[ray] != one))


@njit(cache=True)
def _in_order(
    one: int, second: int, shape: int, other_shape: int, z: float, other_z: float
) -> tuple[int, int, float, float, int, int]:
    """The shapes of two pieces, the nearer first, their depths, how many are to be tried, and what is last.

    The last is the piece that is seen where they are missed; it may be nothing, or unknown.
    """
    if other_z < z:
        one, second, shape, other_shape, z, other_z = second, one, other_shape, shape, other_z, z
    if second == _NONE or other_z > _BEHIND * z:
        return shape, shape, z, z, 1, second
    return shape, other_shape, z, other_z, 1 if shape == other_shape else 2, _UNKNOWN


@njit(cache=True)
def _second(one: int, beside: Four, askew: Four) -> tuple[int, int]:
    """The only other piece in a neighbourhood, and where it is first; -1 for where if there are more."""
    found, at = _UNKNOWN, -1
    for j in range(8):
        here = beside[j] if j < 4 else askew[j - 4]
        if here != one and here != found:
            if at >= 0:
                return found, -1
            found, at = here, j
    return found, at


@njit(cache=True)
def _look_around(v: int, u: int, piece: Pixels, around: NDArray[np.int64]) -> int:
    """List the pieces of a neighbourhood, each with the nearest pixel that shows it; returns how many."""
    height, width = piece.shape
    known = 0
    for i in range(len(_AROUND)):
        x, y = u + _AROUND[i, 0], v + _AROUND[i, 1]
        if x < 0 or y < 0 or x >= width or y >= height:
            continue
        one = piece[y, x]
        is_new = True
        for j in range(known):
            is_new &= around[j, 0] != one
        if is_new:
            around[known, 0], around[known, 1] = one, y * width + x
            known += 1
    return known


@njit(cache=True)
def _shapes_of(
    known: int,
    around: NDArray[np.int64],
    depth: NDArray[np.float32],
    shape_of: Pixels,
    shapes: NDArray[np.int64],
    nearest: Array,
) -> tuple[int, int]:
    """List the shapes of pieces by depth, nearest first.

    Returns:
        How many are to be tried, and the piece that is seen where all of them are missed, which may be
        nothing or unknown. The farthest shape need not be tried if it is far behind and shows one piece.
    """
    count, last = 0, _UNKNOWN
    for j in range(known):
        if around[j, 0] == _NONE:
            last = _NONE
            continue
        shape, z = shape_of[around[j, 0]], float(depth[around[j, 1]])
        at = 0
        while at < count and shapes[at] != shape:
            at += 1
        if at == count:
            count += 1
            shapes[at], nearest[at] = shape, z
        nearest[at] = min(nearest[at], z)
        while at > 0 and nearest[at - 1] > nearest[at]:
            shapes[at], shapes[at - 1] = shapes[at - 1], shapes[at]
            nearest[at], nearest[at - 1] = nearest[at - 1], nearest[at]
            at -= 1
    if last == _NONE or count < 2 or nearest[count - 1] < _BEHIND * nearest[count - 2]:
        return count, last
    pieces = 0
    for j in range(known):
        if shape_of[around[j, 0]] == shapes[count - 1]:
            last, pieces = around[j, 0], pieces + 1
    return (count - 1, last) if pieces == 1 else (count, _UNKNOWN)


@njit(cache=True)
def _place_of(seen: int, known: int, around: NDArray[np.int64], shape_of: Pixels) -> int:
    """The pixel that shows a piece, or else its shape, or else the middle one."""
    at = -1
    for j in range(known):
        if around[j, 0] == seen:
            at = j
            break
        if at < 0 and seen >= 0 and around[j, 0] >= 0 and shape_of[around[j, 0]] == shape_of[seen]:
            at = j
    place: int = around[max(at, 0), 1]
    return place
