"""Ray caster that renders every shape of a table as pieces of planes and quadrics (numba kernels).

There is no clipping: the formulas of `canvas` are valid for corners behind the camera, too. Shapes are solid
and visible from outside only: a camera inside a shape does not see it. TinyRenderer culls the same sides.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import Point, compose, cross, dot, map_point, minus, plus, scaled
from peopleboy.sim.rendering.render_canvas import (
    Brush,
    Canvas,
    Lens,
    Rectangle,
    fill_conic,
    fill_polygon,
    pixels,
    set_edge,
    set_shading,
)
from peopleboy.sim.shapes.bounds import FAR_M, NEAR_M, Bounds, box_bounds, shape_bounds
from peopleboy.sim.shapes.shape_table import ShapeTable
from peopleboy.sim.shapes.shapes import ShapeKind

Array = NDArray[np.float64]
Border = tuple[float, float]
Borders = tuple[Border, Border, Border, Border]

_SPHERE = int(ShapeKind.SPHERE)
_CAPSULE = int(ShapeKind.CAPSULE)
_CYLINDER = int(ShapeKind.CYLINDER)
_BOX = int(ShapeKind.BOX)
_PLANE = int(ShapeKind.PLANE)
_MESH = int(ShapeKind.MESH)

_NO_AXIS: Point = (0.0, 0.0, 0.0)


@njit(cache=True, error_model="numpy")
def draw(
    table: ShapeTable,
    camera_from_part: Array,
    skip: NDArray[np.bool_],
    bits: NDArray[np.uint64],
    lens: Lens,
    canvas: Canvas,
) -> None:
    """Draw all shapes except stand-ins, and those of skipped parts; skins are drawn by `draw_skins`.

    Args:
        table: the shapes.
        camera_from_part: (P, 4, 4).
        skip: (P,) parts that are not drawn.
        bits: (P,) bits that a part's silhouette sets in the cover.
        lens: ray directions of the pixels.
        canvas: canvas to draw on.
    """
    borders = borders_of(lens)
    for shape in range(len(table.kind)):
        part = table.part[shape]
        origin = table.part_from_shape[shape]
        middle = map_point(camera_from_part[part], origin[0, 3], origin[1, 3], origin[2, 3])
        if (
            skip[part]
            or table.is_stand_in[shape]
            or is_outside(middle, table.reach[shape], lens.focal, borders)
        ):
            continue
        compose(camera_from_part[part], table.part_from_shape[shape], canvas.pose)
        bounds = quick_bounds(table, shape, canvas.pose)
        area = pixels(lens, bounds)
        if area[0] <= area[2] and area[1] <= area[3]:
            draw_shape(table, shape, Brush(bits[part], lens, area, canvas))


@njit(cache=True, error_model="numpy")
def borders_of(lens: Lens) -> Borders:
    """Return the planes through the image's borders, enlarged by a pixel: left, right, up, down.

    Each is (slope, length): f x - slope z is the length times the distance of a point (x, z) from the plane.
    """
    left, right = -1.0 - lens.centre_u, lens.width - lens.centre_u
    up, down = -1.0 - lens.centre_v, lens.height - lens.centre_v
    square = lens.focal * lens.focal
    return (
        (left, math.sqrt(square + left * left)),
        (right, math.sqrt(square + right * right)),
        (up, math.sqrt(square + up * up)),
        (down, math.sqrt(square + down * down)),
    )


@njit(cache=True, error_model="numpy")
def is_outside(middle: Point, reach: float, focal: float, borders: Borders) -> bool:
    """Return whether a ball around a point is completely outside the image or behind the camera."""
    x, y, z = middle
    left, right, up, down = borders
    is_out: bool = (
        (z < -reach)
        | (focal * x - left[0] * z < -reach * left[1])
        | (focal * x - right[0] * z > reach * right[1])
        | (focal * y - up[0] * z < -reach * up[1])
        | (focal * y - down[0] * z > reach * down[1])
    )
    return is_out


@njit(cache=True, error_model="numpy")
def quick_bounds(table: ShapeTable, shape: int, pose: Array) -> Bounds:
    """Return the bounds of a shape; for a mesh those of its box."""
    if table.kind[shape] == _MESH:
        low, high = table.extent[shape, 0], table.extent[shape, 1]
        return box_bounds(pose, low[0], low[1], low[2], high[0], high[1], high[2])
    return shape_bounds(table.kind[shape], table.size[shape], pose, table.triangles[:0])


@njit(cache=True, error_model="numpy")
def draw_shape(table: ShapeTable, shape: int, brush: Brush) -> None:
    """Draw a shape, by number, at the canvas's pose."""
    kind, size, surface = table.kind[shape], table.size[shape], table.first_surface[shape]
    pose = brush.canvas.pose
    if kind == _SPHERE:
        _draw_ball(map_point(pose, 0.0, 0.0, 0.0), size[0], surface, brush)
    elif kind == _CAPSULE:
        _draw_tube(size[0] / 2.0, size[1], surface, brush)
        for i in range(2):
            end = map_point(pose, 0.0, 0.0, (i - 0.5) * size[0])
            _draw_ball(end, size[1], surface + 1 + i, brush)
    elif kind == _CYLINDER:
        _draw_tube(size[0] / 2.0, size[1], surface, brush)
        for i in range(2):
            _draw_lid((i - 0.5) * size[0], size[1], surface + 1 + i, brush)
    elif kind == _BOX:
        for i in range(6):
            draw_face(size, i % 3, 1.0 if i < 3 else -1.0, surface + i, brush)
    elif kind == _PLANE:
        normal = (pose[0, 2], pose[1, 2], pose[2, 2])
        _draw_flat(normal, map_point(pose, 0.0, 0.0, 0.0), np.int64(0), surface, brush)
    else:
        first, end = table.triangle_range[shape]
        for i in range(first, end):
            draw_triangle(table.triangles[i], surface + i - first, brush)


@njit(cache=True, error_model="numpy")
def _draw_ball(centre: Point, radius: float, surface: int, brush: Brush) -> None:
    k = dot(centre, centre) - radius * radius
    if k > 0.0:
        q = scaled(centre, -1.0)
        _draw_round(q, k, radius, _NO_AXIS, -1.0, 1.0, surface, brush)


@njit(cache=True, error_model="numpy")
def _draw_tube(half: float, radius: float, surface: int, brush: Brush) -> None:
    """Draw the round side of a cylinder along the pose's z axis."""
    pose = brush.canvas.pose
    axis, centre = (pose[0, 2], pose[1, 2], pose[2, 2]), (pose[0, 3], pose[1, 3], pose[2, 3])
    along = dot(axis, centre)
    q = plus(scaled(axis, along), scaled(centre, -1.0))
    k = dot(q, q) - radius * radius
    if k > 0.0:
        _draw_round(q, k, radius, axis, along - half, along + half, surface, brush)


@njit(cache=True, error_model="numpy")
def _draw_round(
    q: Point, k: float, radius: float, axis: Point, low: float, high: float, surface: int, brush: Brush
) -> None:
    """Draw the quadric with Q = I - axis axis' between two heights along its axis."""
    set_shading(brush.canvas, surface, axis, q, 1.0 / radius)
    form = (
        q[0] * q[0] - k * (1.0 - axis[0] * axis[0]),
        q[0] * q[1] + k * axis[0] * axis[1],
        q[0] * q[2] + k * axis[0] * axis[2],
        q[1] * q[1] - k * (1.0 - axis[1] * axis[1]),
        q[1] * q[2] + k * axis[1] * axis[2],
        q[2] * q[2] - k * (1.0 - axis[2] * axis[2]),
    )
    fill_conic(form, scaled(q, -1.0 / k), 1.0 / k, axis, low, high, surface, brush)


@njit(cache=True, error_model="numpy")
def _draw_lid(height: float, radius: float, surface: int, brush: Brush) -> None:
    """Draw the flat end of a cylinder at a height along the pose's z axis.

    With the plane g . p = 1 and the centre c, the ray d hits it where |d - (g . d) c| <= r (g . d).
    """
    pose = brush.canvas.pose
    sign = 1.0 if height > 0.0 else -1.0
    normal = (sign * pose[0, 2], sign * pose[1, 2], sign * pose[2, 2])
    c = map_point(pose, 0.0, 0.0, height)
    distance = dot(normal, c)
    if distance >= 0.0:
        return
    g = scaled(normal, 1.0 / distance)
    k = radius * radius - dot(c, c)
    form = (
        k * g[0] * g[0] + 2.0 * c[0] * g[0] - 1.0,
        k * g[0] * g[1] + c[0] * g[1] + c[1] * g[0],
        k * g[0] * g[2] + c[0] * g[2] + c[2] * g[0],
        k * g[1] * g[1] + 2.0 * c[1] * g[1] - 1.0,
        k * g[1] * g[2] + c[1] * g[2] + c[2] * g[1],
        k * g[2] * g[2] + 2.0 * c[2] * g[2] - 1.0,
    )
    set_shading(brush.canvas, surface, normal, _NO_AXIS, 0.0)
    fill_conic(form, g, 0.0, _NO_AXIS, -1.0, 1.0, surface, brush)


@njit(cache=True, error_model="numpy")
def draw_face(size: Array, axis: int, sign: float, surface: int, brush: Brush) -> None:
    """Draw one face of a box."""
    pose, j, k = brush.canvas.pose, (axis + 1) % 3, (axis + 2) % 3
    normal = (sign * pose[0, axis], sign * pose[1, axis], sign * pose[2, axis])
    across = (pose[0, j], pose[1, j], pose[2, j])
    up = (pose[0, k], pose[1, k], pose[2, k])
    centre = plus((pose[0, 3], pose[1, 3], pose[2, 3]), scaled(normal, size[axis] / 2.0))
    if dot(normal, centre) >= 0.0:
        return
    for i in range(4):
        side, step = (across, size[j] / 2.0) if i % 2 == 0 else (up, size[k] / 2.0)
        direction = up if i % 2 == 0 else across
        middle = plus(centre, scaled(side, step if i < 2 else -step))
        set_edge(brush.canvas, i, cross(middle, direction), centre)
    _draw_flat(normal, centre, np.int64(4), surface, brush)


@njit(cache=True, error_model="numpy")
def draw_triangle(corners: Array, surface: int, brush: Brush) -> None:
    """Draw the front of a triangle, from which its corners are counterclockwise."""
    pose = brush.canvas.pose
    a = map_point(pose, corners[0, 0], corners[0, 1], corners[0, 2])
    b = map_point(pose, corners[1, 0], corners[1, 1], corners[1, 2])
    c = map_point(pose, corners[2, 0], corners[2, 1], corners[2, 2])
    # Half of all triangles face away, and most others of a fine mesh fall between pixels: cull these first.
    normal = cross(minus(b, a), minus(c, a))
    if dot(normal, a) >= 0.0 or max(a[2], b[2], c[2]) < NEAR_M:
        return
    if min(a[2], b[2], c[2]) >= NEAR_M:
        area = _narrowed(brush.area, a, b, c, brush.lens)
        if area[0] > area[2] or area[1] > area[3]:
            return
        brush = Brush(brush.bit, brush.lens, area, brush.canvas)
    normal = scaled(normal, 1.0 / math.sqrt(dot(normal, normal)))
    centre = scaled(plus(plus(a, b), c), 1.0 / 3.0)
    for i, edge in enumerate((cross(a, b), cross(b, c), cross(c, a))):
        set_edge(brush.canvas, i, edge, centre)
    _draw_flat(normal, a, np.int64(3), surface, brush)


@njit(cache=True, error_model="numpy")
def _narrowed(area: Rectangle, a: Point, b: Point, c: Point, lens: Lens) -> Rectangle:
    """Return the pixels of an area within the bounds of a triangle in front of the camera."""
    ax, ay, bx, by, cx, cy = a[0] / a[2], a[1] / a[2], b[0] / b[2], b[1] / b[2], c[0] / c[2], c[1] / c[2]
    own = pixels(lens, (min(ax, bx, cx), min(ay, by, cy), max(ax, bx, cx), max(ay, by, cy)))
    return max(area[0], own[0]), max(area[1], own[1]), min(area[2], own[2]), min(area[3], own[3])


@njit(cache=True, error_model="numpy")
def _draw_flat(normal: Point, point: Point, edges: np.int64, surface: int, brush: Brush) -> None:
    """Draw the polygon of the first `edges` edges in the plane through a point, from the side of the normal.

    Pass `edges` as a variable: each literal would be compiled separately.
    """
    distance = dot(normal, point)
    if distance >= 0.0:
        return
    g = scaled(normal, 1.0 / distance)
    near, far = brush.canvas.edges[edges], brush.canvas.edges[edges + 1]
    near[0], near[1], near[2] = -g[0], -g[1], 1.0 / NEAR_M - g[2]
    far[0], far[1], far[2] = g[0], g[1], g[2] - 1.0 / FAR_M
    set_shading(brush.canvas, surface, normal, _NO_AXIS, 0.0)
    fill_polygon(g, int(edges) + 2, surface, brush)
