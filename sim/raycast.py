"""The ray caster: every shape of a table onto an image, exact at each pixel's centre (numba kernels).

The ray through pixel (u, v) is d = (x, y, 1) in the optical frame, so a point at depth z lies at z d. All
surfaces are pieces of planes or of quadrics, and 1 / z (the nearness) along a row of pixels is

    plane g . p = 1:                   1 / z = g . d
    quadric p'Qp + 2 q'p + k = 0:      1 / z = (-q . d + sqrt(d'(qq' - kQ)d)) / k

which needs no division a pixel. Where a row enters and leaves a piece follows from its edges (linear in x) or
from its outline (quadratic in x) before any pixel is looked at. Nothing is clipped: the formulas hold for corners
behind the camera too. Shapes are solid and seen from outside only: a camera within one does not see it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.bounds import FAR_M, NEAR_M, Bounds, Point, box_bounds, map_point, shape_bounds
from sim.shape_table import ShapeTable
from sim.shapes import ShapeKind

Array = NDArray[np.float64]
Form = tuple[float, float, float, float, float, float]
Rectangle = tuple[int, int, int, int]

_SPHERE = int(ShapeKind.SPHERE)
_CAPSULE = int(ShapeKind.CAPSULE)
_CYLINDER = int(ShapeKind.CYLINDER)
_BOX = int(ShapeKind.BOX)
_PLANE = int(ShapeKind.PLANE)
_MESH = int(ShapeKind.MESH)

# Widens every span [px], so that rounding opens no crack between two pieces with a common edge.
_SLACK = 1e-9
_NO_AXIS: Point = (0.0, 0.0, 0.0)


class Lens(NamedTuple):
    """A pinhole camera as kernels take it [px]."""

    focal: float
    centre_u: float
    centre_v: float
    width: int
    height: int


class Canvas(NamedTuple):
    """What the kernels draw on.

    Attributes:
        nearness: (H, W) [1/m] of the nearest surface so far, 0 where none.
        surface: (H, W) its number.
        cover: (H, W) bits of the persons whose silhouettes lie there.
        shading: (M, 7) what gives the normal of surface m: of a plane the normal itself and three zeros; of
            a quadric its axis (0 for a sphere), q, and 1 / radius.
        edges: (6, 3) space for the edges of one polygon: it lies where edge . d >= 0 for all of them.
        pose: (3, 4) space for the pose of one shape, camera from shape.
    """

    nearness: Array
    surface: NDArray[np.int32]
    cover: NDArray[np.uint64]
    shading: Array
    edges: Array
    pose: Array


def make_canvas(lens: Lens, surfaces: int) -> Canvas:
    """Give an empty canvas for a table of so many surfaces."""
    shape = (lens.height, lens.width)
    return Canvas(
        nearness=np.zeros(shape),
        surface=np.empty(shape, np.int32),
        cover=np.zeros(shape, np.uint64),
        shading=np.empty((surfaces, 7)),
        edges=np.empty((6, 3)),
        pose=np.empty((3, 4)),
    )


@njit(cache=True, error_model="numpy")
def draw(
    table: ShapeTable,
    camera_from_part: Array,
    skip: NDArray[np.bool_],
    bits: NDArray[np.uint64],
    lens: Lens,
    canvas: Canvas,
) -> None:
    """Draw all shapes but those of parts to skip.

    Args:
        table: the shapes.
        camera_from_part: (P, 4, 4).
        skip: (P,) parts that are not drawn.
        bits: (P,) what a part's silhouette adds to the cover.
        lens: where pixels look.
        canvas: what to draw on.
    """
    for shape in range(len(table.kind)):
        part = table.part[shape]
        if skip[part]:
            continue
        _compose(camera_from_part[part], table.part_from_shape[shape], canvas.pose)
        bounds = _quick_bounds(table, shape, canvas.pose)
        area = _pixels(lens, bounds)
        if area[0] <= area[2] and area[1] <= area[3]:
            _draw_shape(table, shape, bits[part], lens, area, canvas)


@njit(cache=True, error_model="numpy")
def shade(
    table: ShapeTable,
    lens: Lens,
    canvas: Canvas,
    rotation: Array,
    part: NDArray[np.int32],
    depth: NDArray[np.float32],
    normal: NDArray[np.float32],
) -> None:
    """Turn a drawn canvas into part numbers, depths and normals.

    Args:
        table: the shapes that were drawn.
        lens: the same as in `draw`.
        canvas: as `draw` left it.
        rotation: (3, 3) world from camera.
        part: (H, W) gets the part numbers, -1 where nothing is.
        depth: (H, W) gets the depths [m], inf where nothing is.
        normal: (H, W, 3) gets the unit normals, world frame, 0 where nothing is.
    """
    for v in range(lens.height):
        y = (v - lens.centre_v) / lens.focal
        for u in range(lens.width):
            nearness = canvas.nearness[v, u]
            if nearness == 0.0:
                part[v, u], depth[v, u] = -1, np.inf
                normal[v, u, 0] = normal[v, u, 1] = normal[v, u, 2] = 0.0
                continue
            surface, z = canvas.surface[v, u], 1.0 / nearness
            part[v, u], depth[v, u] = table.surface_part[surface], z
            nx, ny, nz = _normal(canvas.shading[surface], (u - lens.centre_u) / lens.focal * z, y * z, z)
            for i in range(3):
                normal[v, u, i] = rotation[i, 0] * nx + rotation[i, 1] * ny + rotation[i, 2] * nz


@njit(cache=True, error_model="numpy")
def _normal(shading: Array, x: float, y: float, z: float) -> Point:
    """Unit normal at a point of a surface, optical frame."""
    if shading[6] == 0.0:
        return shading[0], shading[1], shading[2]
    along = x * shading[0] + y * shading[1] + z * shading[2]
    return (
        (x - along * shading[0] + shading[3]) * shading[6],
        (y - along * shading[1] + shading[4]) * shading[6],
        (z - along * shading[2] + shading[5]) * shading[6],
    )


@njit(cache=True, error_model="numpy")
def _compose(a: Array, b: Array, product: Array) -> None:
    """Write the first three rows of the product of two poses."""
    for i in range(3):
        for j in range(4):
            product[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]
        product[i, 3] += a[i, 3]


@njit(cache=True, error_model="numpy")
def _quick_bounds(table: ShapeTable, shape: int, pose: Array) -> Bounds:
    """Bounds of a shape; of a mesh those of its box."""
    if table.kind[shape] == _MESH:
        low, high = table.extent[shape, 0], table.extent[shape, 1]
        return box_bounds(pose, low[0], low[1], low[2], high[0], high[1], high[2])
    return shape_bounds(table.kind[shape], table.size[shape], pose, table.triangles[:0])


@njit(cache=True, error_model="numpy")
def _pixels(lens: Lens, bounds: Bounds) -> Rectangle:
    """First and last column and row whose centres lie within bounds: left, top, right, bottom."""
    left = max(lens.centre_u + lens.focal * bounds[0] - _SLACK, 0.0)
    top = max(lens.centre_v + lens.focal * bounds[1] - _SLACK, 0.0)
    right = min(lens.centre_u + lens.focal * bounds[2] + _SLACK, lens.width - 1.0)
    bottom = min(lens.centre_v + lens.focal * bounds[3] + _SLACK, lens.height - 1.0)
    if left > right or top > bottom:
        return 0, 0, -1, -1
    return math.ceil(left), math.ceil(top), math.floor(right), math.floor(bottom)


@njit(cache=True, error_model="numpy")
def _draw_shape(
    table: ShapeTable, shape: int, bit: np.uint64, lens: Lens, area: Rectangle, canvas: Canvas
) -> None:
    kind, size, surface = table.kind[shape], table.size[shape], table.first_surface[shape]
    pose = canvas.pose
    if kind == _SPHERE:
        _draw_ball(map_point(pose, 0.0, 0.0, 0.0), size[0], surface, bit, lens, area, canvas)
    elif kind == _CAPSULE:
        _draw_tube(size[0] / 2.0, size[1], surface, bit, lens, area, canvas)
        for i in range(2):
            end = map_point(pose, 0.0, 0.0, (i - 0.5) * size[0])
            _draw_ball(end, size[1], surface + 1 + i, bit, lens, area, canvas)
    elif kind == _CYLINDER:
        _draw_tube(size[0] / 2.0, size[1], surface, bit, lens, area, canvas)
        for i in range(2):
            _draw_lid((i - 0.5) * size[0], size[1], surface + 1 + i, bit, lens, area, canvas)
    elif kind == _BOX:
        for i in range(6):
            _draw_face(size, i % 3, 1.0 if i < 3 else -1.0, surface + i, bit, lens, area, canvas)
    elif kind == _PLANE:
        normal = (pose[0, 2], pose[1, 2], pose[2, 2])
        _draw_flat(normal, map_point(pose, 0.0, 0.0, 0.0), 0, surface, bit, lens, area, canvas)
    else:
        first, end = table.triangle_range[shape]
        for i in range(first, end):
            _draw_triangle(table.triangles[i], surface + i - first, bit, lens, area, canvas)


@njit(cache=True, error_model="numpy")
def _draw_ball(
    centre: Point, radius: float, surface: int, bit: np.uint64, lens: Lens, area: Rectangle, canvas: Canvas
) -> None:
    k = _dot(centre, centre) - radius * radius
    if k > 0.0:
        q = _scaled(centre, -1.0)
        _draw_round(q, k, radius, _NO_AXIS, -1.0, 1.0, surface, bit, lens, area, canvas)


@njit(cache=True, error_model="numpy")
def _draw_tube(
    half: float, radius: float, surface: int, bit: np.uint64, lens: Lens, area: Rectangle, canvas: Canvas
) -> None:
    """Draw the round side of a cylinder along the pose's z axis."""
    pose = canvas.pose
    axis, centre = (pose[0, 2], pose[1, 2], pose[2, 2]), (pose[0, 3], pose[1, 3], pose[2, 3])
    along = _dot(axis, centre)
    q = _plus(_scaled(axis, along), _scaled(centre, -1.0))
    k = _dot(q, q) - radius * radius
    if k > 0.0:
        _draw_round(q, k, radius, axis, along - half, along + half, surface, bit, lens, area, canvas)


@njit(cache=True, error_model="numpy")
def _draw_round(
    q: Point,
    k: float,
    radius: float,
    axis: Point,
    low: float,
    high: float,
    surface: int,
    bit: np.uint64,
    lens: Lens,
    area: Rectangle,
    canvas: Canvas,
) -> None:
    """Draw the quadric with Q = I - axis axis' between two heights along its axis."""
    _set_shading(canvas, surface, axis, q, 1.0 / radius)
    form = (
        q[0] * q[0] - k * (1.0 - axis[0] * axis[0]),
        q[0] * q[1] + k * axis[0] * axis[1],
        q[0] * q[2] + k * axis[0] * axis[2],
        q[1] * q[1] - k * (1.0 - axis[1] * axis[1]),
        q[1] * q[2] + k * axis[1] * axis[2],
        q[2] * q[2] - k * (1.0 - axis[2] * axis[2]),
    )
    _fill_conic(form, _scaled(q, -1.0 / k), 1.0 / k, axis, low, high, surface, bit, lens, area, canvas)


@njit(cache=True, error_model="numpy")
def _draw_lid(
    height: float, radius: float, surface: int, bit: np.uint64, lens: Lens, area: Rectangle, canvas: Canvas
) -> None:
    """Draw the flat end of a cylinder at a height along the pose's z axis.

    With g . p = 1 its plane and c its centre, d lies on it where |d - (g . d) c| <= r (g . d).
    """
    pose = canvas.pose
    sign = 1.0 if height > 0.0 else -1.0
    normal = (sign * pose[0, 2], sign * pose[1, 2], sign * pose[2, 2])
    c = map_point(pose, 0.0, 0.0, height)
    distance = _dot(normal, c)
    if distance >= 0.0:
        return
    g = _scaled(normal, 1.0 / distance)
    k = radius * radius - _dot(c, c)
    form = (
        k * g[0] * g[0] + 2.0 * c[0] * g[0] - 1.0,
        k * g[0] * g[1] + c[0] * g[1] + c[1] * g[0],
        k * g[0] * g[2] + c[0] * g[2] + c[2] * g[0],
        k * g[1] * g[1] + 2.0 * c[1] * g[1] - 1.0,
        k * g[1] * g[2] + c[1] * g[2] + c[2] * g[1],
        k * g[2] * g[2] + 2.0 * c[2] * g[2] - 1.0,
    )
    _set_shading(canvas, surface, normal, _NO_AXIS, 0.0)
    _fill_conic(form, g, 0.0, _NO_AXIS, -1.0, 1.0, surface, bit, lens, area, canvas)


@njit(cache=True, error_model="numpy")
def _draw_face(
    size: Array,
    axis: int,
    sign: float,
    surface: int,
    bit: np.uint64,
    lens: Lens,
    area: Rectangle,
    canvas: Canvas,
) -> None:
    """Draw one face of a box."""
    pose, j, k = canvas.pose, (axis + 1) % 3, (axis + 2) % 3
    normal = (sign * pose[0, axis], sign * pose[1, axis], sign * pose[2, axis])
    across = (pose[0, j], pose[1, j], pose[2, j])
    up = (pose[0, k], pose[1, k], pose[2, k])
    centre = _plus((pose[0, 3], pose[1, 3], pose[2, 3]), _scaled(normal, size[axis] / 2.0))
    if _dot(normal, centre) >= 0.0:
        return
    for i in range(4):
        side, step = (across, size[j] / 2.0) if i % 2 == 0 else (up, size[k] / 2.0)
        direction = up if i % 2 == 0 else across
        middle = _plus(centre, _scaled(side, step if i < 2 else -step))
        _set_edge(canvas, i, _cross(middle, direction), centre)
    _draw_flat(normal, centre, 4, surface, bit, lens, area, canvas)


@njit(cache=True, error_model="numpy")
def _draw_triangle(
    corners: Array, surface: int, bit: np.uint64, lens: Lens, area: Rectangle, canvas: Canvas
) -> None:
    """Draw both sides of a triangle."""
    pose = canvas.pose
    a = map_point(pose, corners[0, 0], corners[0, 1], corners[0, 2])
    b = map_point(pose, corners[1, 0], corners[1, 1], corners[1, 2])
    c = map_point(pose, corners[2, 0], corners[2, 1], corners[2, 2])
    if min(a[2], b[2], c[2]) >= NEAR_M:
        area = _narrowed(area, a, b, c, lens)
        if area[0] > area[2] or area[1] > area[3]:
            return
    elif max(a[2], b[2], c[2]) < NEAR_M:
        return
    normal = _cross(_minus(b, a), _minus(c, a))
    length = math.sqrt(_dot(normal, normal))
    if length == 0.0:
        return
    normal = _scaled(normal, (-1.0 if _dot(normal, a) > 0.0 else 1.0) / length)
    centre = _scaled(_plus(_plus(a, b), c), 1.0 / 3.0)
    _set_edge(canvas, 0, _cross(a, b), centre)
    _set_edge(canvas, 1, _cross(b, c), centre)
    _set_edge(canvas, 2, _cross(c, a), centre)
    _draw_flat(normal, a, 3, surface, bit, lens, area, canvas)


@njit(cache=True, error_model="numpy")
def _narrowed(area: Rectangle, a: Point, b: Point, c: Point, lens: Lens) -> Rectangle:
    """The pixels of an area within the bounds of a triangle in front of the camera."""
    ax, ay, bx, by, cx, cy = a[0] / a[2], a[1] / a[2], b[0] / b[2], b[1] / b[2], c[0] / c[2], c[1] / c[2]
    own = _pixels(lens, (min(ax, bx, cx), min(ay, by, cy), max(ax, bx, cx), max(ay, by, cy)))
    return max(area[0], own[0]), max(area[1], own[1]), min(area[2], own[2]), min(area[3], own[3])


@njit(cache=True, error_model="numpy")
def _draw_flat(
    normal: Point,
    point: Point,
    edges: int,
    surface: int,
    bit: np.uint64,
    lens: Lens,
    area: Rectangle,
    canvas: Canvas,
) -> None:
    """Draw the polygon of the first `edges` edges in the plane through a point, seen from the normal's side."""
    distance = _dot(normal, point)
    if distance >= 0.0:
        return
    g = _scaled(normal, 1.0 / distance)
    near, far = canvas.edges[edges], canvas.edges[edges + 1]
    near[0], near[1], near[2] = -g[0], -g[1], 1.0 / NEAR_M - g[2]
    far[0], far[1], far[2] = g[0], g[1], g[2] - 1.0 / FAR_M
    _set_shading(canvas, surface, normal, _NO_AXIS, 0.0)
    _fill_polygon(g, edges + 2, surface, bit, lens, area, canvas)


@njit(cache=True, error_model="numpy")
def _fill_polygon(
    g: Point, edges: int, surface: int, bit: np.uint64, lens: Lens, area: Rectangle, canvas: Canvas
) -> None:
    """Fill the pixels inside all edges with the plane g . p = 1."""
    slope = g[0] / lens.focal
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
        if low > high:
            continue
        base = g[1] * y + g[2] - lens.centre_u * slope
        nearness, surfaces, cover = canvas.nearness[v], canvas.surface[v], canvas.cover[v]
        for u in range(math.ceil(low), math.floor(high) + 1):
            here = slope * u + base
            cover[u] |= bit
            if here > nearness[u]:
                nearness[u] = here
                surfaces[u] = surface


@njit(cache=True, error_model="numpy")
def _fill_conic(
    form: Form,
    line: Point,
    root: float,
    axis: Point,
    low: float,
    high: float,
    surface: int,
    bit: np.uint64,
    lens: Lens,
    area: Rectangle,
    canvas: Canvas,
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
        bit: what to add to the cover.
        lens: where pixels look.
        area: the pixels to look at.
        canvas: what to draw on.
    """
    scale = 1.0 / lens.focal
    for v in range(area[1], area[3] + 1):
        y = (v - lens.centre_v) * scale
        a, b = form[0], form[1] * y + form[2]
        c = (form[3] * y + 2.0 * form[4]) * y + form[5]
        first, last = _outline(a, b, c, lens, area)
        line_0, axis_0 = line[1] * y + line[2], axis[1] * y + axis[2]
        nearness, surfaces, cover = canvas.nearness[v], canvas.surface[v], canvas.cover[v]
        for u in range(first, last + 1):
            x = (u - lens.centre_u) * scale
            square = (a * x + 2.0 * b) * x + c
            here = line[0] * x + line_0 + root * math.sqrt(max(square, 0.0))
            along = axis[0] * x + axis_0
            hit = (square >= 0.0) & (along >= here * low) & (along <= here * high)
            hit &= (here >= 1.0 / FAR_M) & (here <= 1.0 / NEAR_M)
            if hit:
                cover[u] |= bit
                if here > nearness[u]:
                    nearness[u] = here
                    surfaces[u] = surface


@njit(cache=True, error_model="numpy")
def _outline(a: float, b: float, c: float, lens: Lens, area: Rectangle) -> tuple[int, int]:
    """First and last pixel of a row between the roots of a x^2 + 2 b x + c, or all if it is not bounded."""
    if a >= 0.0:
        return area[0], area[2]
    square = b * b - a * c
    if square < 0.0:
        return 0, -1
    width = math.sqrt(square)
    low = max(lens.centre_u + lens.focal * (width - b) / a - _SLACK, float(area[0]))
    high = min(lens.centre_u - lens.focal * (width + b) / a + _SLACK, float(area[2]))
    if low > high:
        return 0, -1
    return math.ceil(low), math.floor(high)


@njit(cache=True, error_model="numpy")
def _set_edge(canvas: Canvas, index: int, edge: Point, inside: Point) -> None:
    """Store an edge, turned so that a point inside the polygon lies on its positive side."""
    sign = -1.0 if _dot(edge, inside) < 0.0 else 1.0
    for i in range(3):
        canvas.edges[index, i] = sign * edge[i]


@njit(cache=True, error_model="numpy")
def _set_shading(canvas: Canvas, surface: int, first: Point, second: Point, curvature: float) -> None:
    row = canvas.shading[surface]
    for i in range(3):
        row[i], row[3 + i] = first[i], second[i]
    row[6] = curvature


@njit(cache=True)
def _dot(a: Point, b: Point) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def _cross(a: Point, b: Point) -> Point:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True)
def _plus(a: Point, b: Point) -> Point:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit(cache=True)
def _minus(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(cache=True)
def _scaled(a: Point, factor: float) -> Point:
    return a[0] * factor, a[1] * factor, a[2] * factor
