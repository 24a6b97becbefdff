"""Canvas of the ray caster, drawn row by row in pieces of planes and quadrics (numba kernels).

The ray through pixel (u, v) is d = (x, y, 1) in the optical frame, so a point at depth z lies at z d. The
canvas holds 1 / z, the nearness, which along a row of pixels is

    plane g . p = 1:                   1 / z = g . d
    quadric p'Qp + 2 q'p + k = 0:      1 / z = (-q . d + sqrt(d'(qq' - kQ)d)) / k

and needs no division. The span of a piece in a row follows from its edges (linear in x) or from its outline
(quadratic in x), before any pixel is evaluated.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import Point, dot
from peopleboy.sim.shapes.bounds import FAR_M, NEAR_M, Bounds

Array = NDArray[np.float64]
Form = tuple[float, float, float, float, float, float]
Rectangle = tuple[int, int, int, int]

# Margin of every span [px], so that rounding does not open gaps between pieces with a common edge.
_SLACK = 1e-9


class Lens(NamedTuple):
    """A pinhole camera in the format of the kernels [px]."""

    focal: float
    centre_u: float
    centre_v: float
    width: int
    height: int


class Canvas(NamedTuple):
    """The image buffers of the kernels.

    Attributes:
        nearness: (H, W) [1/m] of the nearest surface so far, 0 where none.
        surface: (H, W) its number.
        cover: (H, W) bits of the people whose silhouettes include the pixel.
        shading: (M, 7) data for the normal of surface m: for a plane the normal and zeros; for a quadric its
            axis (0 for a sphere), q, and 1 / radius. All surfaces of skins, which come last, share row M - 1.
        edges: (6, 3) buffer for the edges of one polygon: inside, edge . d >= 0 for all of them.
        pose: (3, 4) buffer for the pose of one shape, camera from shape.
    """

    nearness: Array
    surface: NDArray[np.int32]
    cover: NDArray[np.uint64]
    shading: Array
    edges: Array
    pose: Array


class Brush(NamedTuple):
    """Settings for drawing one piece of a shape.

    Attributes:
        bit: bit to set in the cover.
        lens: ray directions of the pixels.
        area: pixels to evaluate.
        canvas: canvas to draw on.
    """

    bit: np.uint64
    lens: Lens
    area: Rectangle
    canvas: Canvas


@njit(cache=True, nogil=True)
def make_canvas(lens: Lens, surfaces: int) -> Canvas:
    """Return an empty canvas for a table with this number of surfaces."""
    shape = (lens.height, lens.width)
    nearness, surface, cover = np.zeros(shape), np.empty(shape, np.int32), np.zeros(shape, np.uint64)
    return Canvas(nearness, surface, cover, np.empty((surfaces, 7)), np.empty((6, 3)), np.empty((3, 4)))


@njit(cache=True, error_model="numpy")
def pixels(lens: Lens, bounds: Bounds) -> Rectangle:
    """Return first and last column and row whose centres are within bounds: left, top, right, bottom."""
    left = max(lens.centre_u + lens.focal * bounds[0] - _SLACK, 0.0)
    top = max(lens.centre_v + lens.focal * bounds[1] - _SLACK, 0.0)
    right = min(lens.centre_u + lens.focal * bounds[2] + _SLACK, lens.width - 1.0)
    bottom = min(lens.centre_v + lens.focal * bounds[3] + _SLACK, lens.height - 1.0)
    # Written so that NaN, from an invalid pose, gives no pixels.
    if not (left <= right and top <= bottom):
        return 0, 0, -1, -1
    return math.ceil(left), math.ceil(top), math.floor(right), math.floor(bottom)


@njit(cache=True, error_model="numpy")
def set_shading(canvas: Canvas, surface: int, first: Point, second: Point, curvature: float) -> None:
    """Store the data for a surface's normals; see `Canvas`."""
    row = canvas.shading[min(surface, len(canvas.shading) - 1)]
    for i in range(3):
        row[i], row[3 + i] = first[i], second[i]
    row[6] = curvature


@njit(cache=True, error_model="numpy")
def set_edge(canvas: Canvas, index: int, edge: Point, inside: Point) -> None:
    """Store an edge, oriented so that a point inside the polygon is on its positive side."""
    sign = -1.0 if dot(edge, inside) < 0.0 else 1.0
    for i in range(3):
        canvas.edges[index, i] = sign * edge[i]


@njit(cache=True, error_model="numpy")
def fill_polygon(g: Point, edges: int, surface: int, brush: Brush) -> None:
    """Fill the pixels inside all edges with the plane g . p = 1."""
    bit, lens, area, canvas = brush
    edges = _edges_across(edges, lens, area, canvas)
    slope, own = g[0] / lens.focal, np.int32(surface)
    for v in range(area[1], area[3] + 1):
        y = (v - lens.centre_v) / lens.focal
        low, high = float(area[0]), float(area[2])
        for i in range(edges):
            a, c = canvas.edges[i, 0], canvas.edges[i, 1] * y + canvas.edges[i, 2]
            if a > 0.0:
                low = max(low, lens.centre_u - lens.focal * c / a - _SLACK)
            elif a < 0.0:
                high = min(high, lens.centre_u - lens.focal * c / a + _SLACK)
            elif c < 0.0:
                high = -1.0
        if not low <= high:
            continue
        base = g[1] * y + g[2] - lens.centre_u * slope
        nearness, surfaces, cover = canvas.nearness[v], canvas.surface[v], canvas.cover[v]
        first, end = math.ceil(low), math.floor(high) + 1
        if bit != 0:
            for u in range(np.uint64(first), np.uint64(end)):
                cover[u] |= bit
        for u in range(np.uint64(first), np.uint64(end)):
            here = slope * np.int32(u) + base
            is_nearer = here > nearness[u]
            nearness[u] = here if is_nearer else nearness[u]
            surfaces[u] = own if is_nearer else surfaces[u]


@njit(cache=True, error_model="numpy")
def _edges_across(edges: int, lens: Lens, area: Rectangle, canvas: Canvas) -> int:
    """Remove edges with all pixels of an area inside, which are most edges; return the number of others."""
    left, right = (area[0] - lens.centre_u) / lens.focal, (area[2] - lens.centre_u) / lens.focal
    top, bottom = (area[1] - lens.centre_v) / lens.focal, (area[3] - lens.centre_v) / lens.focal
    kept = 0
    for i in range(edges):
        a, b, c = canvas.edges[i, 0], canvas.edges[i, 1], canvas.edges[i, 2]
        least = min(a * left, a * right) + min(b * top, b * bottom) + c
        if not least > 1e-9 * (abs(a) + abs(b) + abs(c)):
            canvas.edges[kept, 0], canvas.edges[kept, 1], canvas.edges[kept, 2] = a, b, c
            kept += 1
    return kept


@njit(cache=True, error_model="numpy")
def fill_conic(
    form: Form, line: Point, root: float, axis: Point, low: float, high: float, surface: int, brush: Brush
) -> None:
    """Fill the pixels where d'Fd >= 0 with the nearness line . d + root sqrt(d'Fd).

    Args:
        form: F's entries 00, 01, 02, 11, 12, 22.
        line: linear term.
        root: factor of the square root.
        axis: unit vector, or 0.
        low: [m] only points whose height along the axis is at least this are drawn.
        high: [m] and at most this.
        surface: number of the surface.
        brush: how to draw.
    """
    bit, lens, area, canvas = brush
    scale, nobody, own = 1.0 / lens.focal, np.uint64(0), np.int32(surface)
    for v in range(area[1], area[3] + 1):
        y = (v - lens.centre_v) * scale
        a, b = form[0], form[1] * y + form[2]
        c = (form[3] * y + 2.0 * form[4]) * y + form[5]
        first, last = _outline(a, b, c, lens, area)
        line_0, axis_0 = line[1] * y + line[2], axis[1] * y + axis[2]
        nearness, surfaces, cover = canvas.nearness[v], canvas.surface[v], canvas.cover[v]
        for u in range(np.uint64(first), np.uint64(last + 1)):
            x = (np.int32(u) - lens.centre_u) * scale
            square = (a * x + 2.0 * b) * x + c
            here = line[0] * x + line_0 + root * math.sqrt(max(square, 0.0))
            along = axis[0] * x + axis_0
            hit = (square >= 0.0) & (along >= here * low) & (along <= here * high)
            hit &= (here >= 1.0 / FAR_M) & (here <= 1.0 / NEAR_M)
            cover[u] |= bit if hit else nobody
            is_nearer = hit & (here > nearness[u])
            nearness[u] = here if is_nearer else nearness[u]
            surfaces[u] = own if is_nearer else surfaces[u]


@njit(cache=True, error_model="numpy")
def _outline(a: float, b: float, c: float, lens: Lens, area: Rectangle) -> tuple[int, int]:
    """Return first and last pixel of a row between the roots of a x^2 + 2 b x + c, or all if unbounded."""
    if a >= 0.0:
        return area[0], area[2]
    square = b * b - a * c
    if square < 0.0:
        return 0, -1
    width = math.sqrt(square)
    low = max(lens.centre_u + lens.focal * (width - b) / a - _SLACK, float(area[0]))
    high = min(lens.centre_u - lens.focal * (width + b) / a + _SLACK, float(area[2]))
    if not low <= high:
        return 0, -1
    return math.ceil(low), math.floor(high)


@njit(cache=True, error_model="numpy")
def shade(
    surface_part: NDArray[np.int32],
    lens: Lens,
    canvas: Canvas,
    rotation: Array,
    part: NDArray[np.int32],
    depth: NDArray[np.float32],
    normal: NDArray[np.float32],
) -> None:
    """Convert a drawn canvas to part numbers, depths and normals.

    Args:
        surface_part: (M,) number of the part that a surface belongs to.
        lens: the same as in `draw`.
        canvas: canvas after `draw`.
        rotation: (3, 3) world from camera.
        part: (H, W) output, part numbers, -1 for none.
        depth: (H, W) output, depths [m], inf for none.
        normal: (H, W, 3), contiguous, output, unit normals, world frame, 0 for none.
    """
    locate(surface_part, lens, canvas, part, depth)
    normals = normal.reshape(lens.height, 3 * lens.width)
    for v in range(lens.height):
        _face_row(lens, v, canvas, rotation, normals[v])


@njit(cache=True, error_model="numpy")
def locate(
    surface_part: NDArray[np.int32],
    lens: Lens,
    canvas: Canvas,
    part: NDArray[np.int32],
    depth: NDArray[np.float32],
) -> None:
    """Convert a drawn canvas to part numbers and depths only; arguments as in `shade`."""
    for v in range(lens.height):
        nearness, surfaces, parts, depths = canvas.nearness[v], canvas.surface[v], part[v], depth[v]
        for u in range(lens.width):
            depths[u] = 1.0 / nearness[u]
        for u in range(lens.width):
            parts[u] = surface_part[surfaces[u]] if nearness[u] != 0.0 else -1


@njit(cache=True, error_model="numpy")
def _face_row(lens: Lens, v: int, canvas: Canvas, rotation: Array, normal: NDArray[np.float32]) -> None:
    """Write the normals of a row, (3 W,), neighbouring pixels of one surface together."""
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    y, nearness, surfaces, end = (v - lens.centre_v) / lens.focal, canvas.nearness[v], canvas.surface[v], 0
    while end < lens.width:
        first, surface = end, surfaces[end]
        if nearness[first] == 0.0:
            normal[3 * first : 3 * first + 3] = 0.0
            end += 1
            continue
        while end < lens.width and surfaces[end] == surface and nearness[end] != 0.0:
            end += 1
        shading = canvas.shading[min(surface, len(canvas.shading) - 1)]
        if shading[6] == 0.0:
            nx, ny, nz = _turned(rotation, (shading[0], shading[1], shading[2]))
            for u in range(np.uint64(first), np.uint64(end)):
                i = three * u
                normal[i], normal[i + one], normal[i + two] = nx, ny, nz
            continue
        for u in range(np.uint64(first), np.uint64(end)):
            i, z = three * u, 1.0 / nearness[u]
            own = _round_normal(shading, (np.float64(u) - lens.centre_u) / lens.focal * z, y * z, z)
            normal[i], normal[i + one], normal[i + two] = _turned(rotation, own)


@njit(cache=True, error_model="numpy")
def _turned(rotation: Array, vector: Point) -> Point:
    """Return a vector, rotated by (3, 3)."""
    x, y, z = vector
    return (
        rotation[0, 0] * x + rotation[0, 1] * y + rotation[0, 2] * z,
        rotation[1, 0] * x + rotation[1, 1] * y + rotation[1, 2] * z,
        rotation[2, 0] * x + rotation[2, 1] * y + rotation[2, 2] * z,
    )


@njit(cache=True, error_model="numpy")
def _round_normal(shading: Array, x: float, y: float, z: float) -> Point:
    """Return the unit normal at a point of a quadric, optical frame."""
    along = x * shading[0] + y * shading[1] + z * shading[2]
    return (
        (x - along * shading[0] + shading[3]) * shading[6],
        (y - along * shading[1] + shading[4]) * shading[6],
        (z - along * shading[2] + shading[5]) * shading[6],
    )
