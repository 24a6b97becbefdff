"""Ray caster for panoramas: each column is a separate pinhole camera, one pixel wide (numba kernels).

A column is drawn as a row, by a camera rotated by 90 degrees, since the ray caster is fast along rows.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.scan_plane import ScanPlane
from peopleboy.sim.geometry.vectors import compose, map_corner, map_point
from peopleboy.sim.rendering.raycast import draw_face, draw_shape, quick_bounds
from peopleboy.sim.rendering.render_canvas import Brush, Canvas, Lens, pixels, shade
from peopleboy.sim.shapes.bounds import FAR_M
from peopleboy.sim.shapes.shape_table import ShapeTable
from peopleboy.sim.shapes.shapes import ShapeKind

Array = NDArray[np.float64]

_PLANE, _MESH = int(ShapeKind.PLANE), int(ShapeKind.MESH)
_SPHERE, _CAPSULE, _BOX = int(ShapeKind.SPHERE), int(ShapeKind.CAPSULE), int(ShapeKind.BOX)

# Margin of every span of columns, so that rounding does not lose any.
_SLACK = 1e-9


class Ring(NamedTuple):
    """The cameras of a panorama's W columns.

    Attributes:
        lens: common lens; its row runs down the column.
        column_from_ring: (W, 3, 4) poses: x down the column, y to the left, z along the camera's axis.
    """

    lens: Lens
    column_from_ring: Array


class Pieces(NamedTuple):
    """Shapes, and faces of boxes, that are potentially visible in some columns.

    Attributes:
        shape: (N,) number of the shape.
        face: (N,) number of the face, -1 for the whole shape.
        pose: (N, 3, 4) ring from shape.
        first: (W + 1,) offsets of the columns' pieces in `among`.
        among: numbers of the pieces, by column, in the order of the shapes.
    """

    shape: NDArray[np.int64]
    face: NDArray[np.int64]
    pose: Array
    first: NDArray[np.int64]
    among: NDArray[np.int64]


class Drawing(NamedTuple):
    """The buffers of the columns, stacked; see `Canvas`.

    Attributes:
        nearness, surface, cover: (W, H).
    """

    nearness: Array
    surface: NDArray[np.int32]
    cover: NDArray[np.uint64]


@lru_cache(maxsize=16)
def ring_of(camera: Panorama) -> Ring:
    """Return the cameras of a panorama's columns."""
    lens = Lens(camera.focal_px, camera.height - 0.5, 0.0, camera.height, 1)
    right = -camera.bearing(np.arange(camera.width))
    return _ring_towards(right, lens, camera.mirror.axis_rad, camera.mirror.ring_radius_m)


@lru_cache(maxsize=16)
def beams_of(plane: ScanPlane) -> Ring:
    """Return the beams of a whole turn, as cameras of one pixel; column 0 points backwards."""
    right = (np.arange(plane.beams_per_turn) + 0.5) * plane.step_rad - math.pi
    return _ring_towards(np.asarray(right, np.float64), Lens(1.0 / plane.step_rad, 0.0, 0.0, 1, 1), 0.0, 0.0)


def _ring_towards(right: Array, lens: Lens, axis_rad: float, radius_m: float) -> Ring:
    """Return cameras in directions (W,) to the right [rad], on a ring, with axes below the horizon."""
    sin, cos, none = np.sin(right), np.cos(right), np.zeros(len(right))
    low_sin, low_cos = math.sin(axis_rad), math.cos(axis_rad)
    poses = np.empty((len(right), 3, 4))
    poses[:, 0, :3] = np.stack([-low_sin * sin, none + low_cos, -low_sin * cos], axis=1)
    poses[:, 1, :3] = np.stack([-cos, none, sin], axis=1)
    poses[:, 2, :3] = np.stack([low_cos * sin, none + low_sin, low_cos * cos], axis=1)
    origins = radius_m * np.stack([sin, none, cos], axis=1)
    poses[:, :, 3] = -np.einsum("wij,wj->wi", poses[:, :, :3], origins)
    poses.setflags(write=False)
    return Ring(lens, poses)


def make_drawing(width: int, height: int) -> Drawing:
    """Return empty columns."""
    shape = (width, height)
    return Drawing(np.zeros(shape), np.empty(shape, np.int32), np.zeros(shape, np.uint64))


class Outline(NamedTuple):
    """Silhouettes of parts in a panorama that is extended beyond its top and bottom, as bits of the parts.

    Attributes:
        pixels: (N,) bits of all nonempty pixels.
        rows: (R,) bits by row.
        columns: (W,) bits by column.
        first_row: number of the first row, negative above the image.
    """

    pixels: NDArray[np.uint64]
    rows: NDArray[np.uint64]
    columns: NDArray[np.uint64]
    first_row: int


def outline(table: ShapeTable, ring_from_part: Array, bits: NDArray[np.uint64], camera: Panorama) -> Outline:
    """Return the silhouettes of parts, ignoring occlusion and the image's top and bottom.

    The image is extended by its height upwards and downwards, but not beyond the vertical downwards.

    Args:
        table: the shapes.
        ring_from_part: (P, 4, 4).
        bits: (P,) bits of each part, 0 for ignored parts.
        camera: the panorama.
    """
    lens, poses = ring_of(camera)
    below = min(camera.height, math.floor(camera.focal_px / math.tan(camera.mirror.axis_rad) - 0.5))
    longer = lens._replace(centre_u=lens.centre_u + camera.height, width=2 * camera.height + below)
    shading = np.empty((len(table.surface_part), 7))
    return Outline(*_outline(table, ring_from_part, bits, Ring(longer, poses), shading), -camera.height)


@njit(cache=True, error_model="numpy")
def _outline(
    table: ShapeTable, ring_from_part: Array, bits: NDArray[np.uint64], ring: Ring, shading: Array
) -> tuple[NDArray[np.uint64], NDArray[np.uint64], NDArray[np.uint64]]:
    width, height = len(ring.column_from_ring), ring.lens.width
    pieces = _before(table, ring_from_part, bits == 0, ring)
    drawing = Drawing(
        np.zeros((1, height)), np.empty((1, height), np.int32), np.zeros((1, height), np.uint64)
    )
    canvas, cover = _canvas(drawing, 0, shading), drawing.cover[0]
    rows, columns = np.zeros(height, np.uint64), np.zeros(width, np.uint64)
    found, count = np.empty(1024, np.uint64), 0
    for u in range(width):
        if pieces.first[u] == pieces.first[u + 1]:
            continue
        _draw_column(table, bits, ring, u, pieces, canvas)
        if count + height > len(found):
            found = np.concatenate((found, np.empty(len(found) + height, np.uint64)))
        for v in range(height):
            if cover[v] != 0:
                rows[v] |= cover[v]
                columns[u] |= cover[v]
                found[count] = cover[v]
                count += 1
        cover[:] = 0
    return found[:count], rows, columns


@njit(cache=True, error_model="numpy")
def draw_ring(
    table: ShapeTable,
    ring_from_part: Array,
    skip: NDArray[np.bool_],
    bits: NDArray[np.uint64],
    ring: Ring,
    first: int,
    shading: Array,
    drawing: Drawing,
    rotation: Array,
    part: NDArray[np.int32],
    depth: NDArray[np.float32],
    normal: NDArray[np.float32],
) -> None:
    """Draw all shapes except those of skipped parts, and convert each column with `shade`.

    Args:
        table: the shapes.
        ring_from_part: (P, 4, 4).
        skip: (P,) parts that are not drawn.
        bits: (P,) bits that a part's silhouette sets in the cover.
        ring: the cameras of all columns around.
        first: number of the first column that is drawn.
        shading: (M, 7) buffer, as in `Canvas`.
        drawing: buffers to draw on, one for each drawn column.
        rotation: (3, 3) world from the panorama's optical frame.
        part: (H, W) output, part numbers, -1 for none.
        depth: (H, W) output, depths [m] along the axis of the column's camera, inf for none.
        normal: (H, W, 3) output, unit normals, world frame, 0 for none.
    """
    pieces, column = _before(table, ring_from_part, skip, ring), np.empty((1, len(normal), 3), np.float32)
    for u in range(len(drawing.nearness)):
        canvas, around = _canvas(drawing, u, shading), first + u
        _draw_column(table, bits, ring, around, pieces, canvas)
        turned = np.empty((3, 3))
        for i in range(3):
            for j in range(3):
                turned[i, j] = 0.0
                for k in range(3):
                    turned[i, j] += rotation[i, k] * ring.column_from_ring[around, j, k]
        row = slice(u, u + 1)
        shade(table.surface_part, ring.lens, canvas, turned, part.T[row], depth.T[row], column)
        for v in range(normal.shape[0]):
            for i in range(3):
                normal[v, u, i] = column[0, v, i]


@njit(cache=True, error_model="numpy")
def _canvas(drawing: Drawing, u: int, shading: Array) -> Canvas:
    """Return the canvas of one column."""
    row = slice(u, u + 1)
    return Canvas(
        drawing.nearness[row],
        drawing.surface[row],
        drawing.cover[row],
        shading,
        np.empty((6, 3)),
        np.empty((3, 4)),
    )


@njit(cache=True, error_model="numpy")
def _draw_column(
    table: ShapeTable, bits: NDArray[np.uint64], ring: Ring, u: int, pieces: Pieces, canvas: Canvas
) -> None:
    """Draw the potentially visible pieces of one column."""
    for i in pieces.among[pieces.first[u] : pieces.first[u + 1]]:
        shape, face = pieces.shape[i], pieces.face[i]
        bit = bits[table.part[shape]]
        compose(ring.column_from_ring[u], pieces.pose[i], canvas.pose)
        if face >= 0:
            none: int = np.int64(0)  # type: ignore[assignment]  # for a literal, kernels would be compiled once more
            whole = (none, none, ring.lens.width - 1, none)
            sign, surface = 1.0 if face < 3 else -1.0, table.first_surface[shape] + face
            draw_face(table.size[shape], face % 3, sign, surface, Brush(bit, ring.lens, whole, canvas))
            continue
        area = pixels(ring.lens, quick_bounds(table, shape, canvas.pose))
        if area[0] <= area[2] and area[1] <= area[3]:
            draw_shape(table, shape, Brush(bit, ring.lens, area, canvas))


@njit(cache=True, error_model="numpy")
def _before(table: ShapeTable, ring_from_part: Array, skip: NDArray[np.bool_], ring: Ring) -> Pieces:
    """Find the potentially visible pieces of the shapes that are not skipped."""
    most, width = 6 * len(table.kind), len(ring.column_from_ring)
    number, faces = np.empty(most, np.int64), np.empty(most, np.int64)
    poses, spans = np.empty((most, 3, 4)), np.empty((most, 2), np.int64)
    offset = ring.column_from_ring[0, :, 3]
    radius, count = math.sqrt((offset * offset).sum()), 0
    for shape in range(len(table.kind)):
        if skip[table.part[shape]]:
            continue
        pose = poses[count]
        compose(ring_from_part[table.part[shape]], table.part_from_shape[shape], pose)
        first, end = (0, 6) if table.kind[shape] == _BOX else (-1, 0)
        low, high = _corners(table, shape)
        if _is_out_of_sight(pose, low, high, ring, radius):
            continue
        for face in range(first, end):
            if face >= 0 and not _may_face(pose, table.size[shape], face, radius):
                continue
            number[count], faces[count] = shape, face
            for i in range(3):
                for j in range(4):
                    poses[count, i, j] = pose[i, j]
            spans[count, 0], spans[count, 1] = _span(table, shape, face, pose, width)
            if spans[count, 1] > 0:
                count += 1
    return Pieces(number, faces, poses, *_by_column(spans[:count], width))


@njit(cache=True)
def _by_column(spans: NDArray[np.int64], width: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Sort the spans (N, 2) by the columns that they include; see `Pieces`."""
    first = np.zeros(width + 1, np.int64)
    for i in range(len(spans)):
        for k in range(spans[i, 1]):
            first[(spans[i, 0] + k) % width + 1] += 1
    first = np.cumsum(first)
    among, free = np.empty(first[width], np.int64), first.copy()
    for i in range(len(spans)):
        for k in range(spans[i, 1]):
            column = (spans[i, 0] + k) % width
            among[free[column]] = i
            free[column] += 1
    return first, among


@njit(cache=True, error_model="numpy")
def _may_face(pose: Array, size: Array, face: int, radius: float) -> bool:
    """Return whether a box's face may be visible from a camera at a distance from the centre."""
    axis, sign = face % 3, 1.0 if face < 3 else -1.0
    distance = size[axis] / 2.0
    for i in range(3):
        distance += sign * pose[i, axis] * pose[i, 3]
    return bool(distance < radius)


@njit(cache=True, error_model="numpy")
def _is_out_of_sight(pose: Array, low: Array, high: Array, ring: Ring, radius: float) -> bool:
    """Return whether the box between two corners is above or below all views, like ceiling and robot.

    Args:
        pose: ring from shape.
        low: one corner, in the shape's frame.
        high: the opposite corner.
        ring: the cameras.
        radius: [m] radius of the ring.
    """
    lens, axis = ring.lens, math.atan2(ring.column_from_ring[0, 2, 1], ring.column_from_ring[0, 0, 1])
    highest = axis + math.atan((-0.5 - lens.centre_u) / lens.focal)
    slope = math.tan(axis + math.atan((lens.width - 0.5 - lens.centre_u) / lens.focal))
    x, _, z = map_point(pose, (low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, (low[2] + high[2]) / 2.0)
    nearest = max(math.hypot(x, z) - math.sqrt(((high - low) ** 2).sum()) / 2.0, 0.0)
    is_above, is_below = highest > 0.0, slope > 0.0
    for corner in range(8):
        x, y, z = map_corner(pose, low, high, corner)
        is_above &= y < math.tan(highest) * nearest
        is_below &= y > slope * (math.hypot(x, z) + radius)
    return bool(is_above or is_below)


@njit(cache=True, error_model="numpy")
def _flattened(corner: Array, axis: int, other: Array) -> Array:
    """Return a corner of a box, moved to the opposite corner's plane along an axis if that is valid."""
    moved = corner.copy()
    if 0 <= axis < 3:
        moved[axis] = other[axis]
    return moved


@njit(cache=True, error_model="numpy")
def _span(table: ShapeTable, shape: int, face: int, pose: Array, width: int) -> tuple[int, int]:
    """Return first column and number of columns in which a shape, or a face of a box, may be visible."""
    kind, size = table.kind[shape], table.size[shape]
    if kind == _SPHERE:
        return _round_span(pose, 0.0, size[0], width)
    if kind == _CAPSULE:
        return _round_span(pose, size[0] / 2.0, size[1], width)
    low, high = _corners(table, shape)
    return _box_span(pose, _flattened(low, face, high), _flattened(high, face - 3, low), width)


@njit(cache=True, error_model="numpy")
def _box_span(pose: Array, low: Array, high: Array, width: int) -> tuple[int, int]:
    """Return the columns in which the box between two corners may be visible."""
    x, _, z = map_point(pose, (low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, (low[2] + high[2]) / 2.0)
    middle, least, most = math.atan2(x, z), 0.0, 0.0
    for corner in range(8):
        x, _, z = map_corner(pose, low, high, corner)
        away = math.atan2(x, z) - middle
        away -= math.tau * math.floor(away / math.tau + 0.5)
        least, most = min(least, away), max(most, away)
    return _columns(middle + least, middle + most, width)


@njit(cache=True, error_model="numpy")
def _round_span(pose: Array, half: float, radius: float, width: int) -> tuple[int, int]:
    """Return the columns in which a capsule, by half its length, or a ball is visible."""
    x, _, z = map_point(pose, 0.0, 0.0, -half)
    middle, reach = math.atan2(x, z), math.asin(min(radius / math.hypot(x, z), 1.0))
    x, _, z = map_point(pose, 0.0, 0.0, half)
    away, other = math.atan2(x, z) - middle, math.asin(min(radius / math.hypot(x, z), 1.0))
    away -= math.tau * math.floor(away / math.tau + 0.5)
    return _columns(middle + min(-reach, away - other), middle + max(reach, away + other), width)


@njit(cache=True, error_model="numpy")
def _columns(least: float, most: float, width: int) -> tuple[int, int]:
    """Return first column and number of columns whose centres are between two angles to the right [rad].

    A span of more than half the horizon encloses the centre, and counts as all columns.
    """
    if not most - least < math.pi:
        return 0, width
    first = math.ceil((least / math.tau + 0.5) * width - 0.5 - _SLACK)
    last = math.floor((most / math.tau + 0.5) * width - 0.5 + _SLACK)
    return first, last - first + 1


@njit(cache=True, error_model="numpy")
def _corners(table: ShapeTable, shape: int) -> tuple[Array, Array]:
    """Return least and greatest corner of a shape's box, in the shape's frame."""
    kind, size = table.kind[shape], table.size[shape]
    if kind == _MESH:
        return table.extent[shape, 0], table.extent[shape, 1]
    half = size / 2.0
    if kind == _PLANE:
        half = np.full(3, FAR_M)
    elif kind == _SPHERE:
        half = np.full(3, size[0])
    elif kind != _BOX:
        # A capsule is longer than a cylinder by its round ends.
        half = np.array([size[1], size[1], size[0] / 2.0 + size[1]])
    return -half, half
