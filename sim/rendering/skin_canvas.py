"""Drawing of skins: a z-buffer for their triangles on the canvas of the ray caster (numba kernels).

1 / z is linear in the pixel's column and row over a triangle, so the nearness is exact at pixel centres. As
in `canvas`, spans are a little wider than the triangle, so that no gap opens at common edges, and the nearest
surface wins. Triangles across the near plane are drawn as polygons of the ray caster, which needs no
clipping.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import Point, cross, dot, map_point
from peopleboy.sim.rendering.raycast import draw_triangle
from peopleboy.sim.rendering.render_canvas import Brush, Canvas, Lens, set_shading
from peopleboy.sim.shapes.bounds import EMPTY, NEAR_M, Bounds, segment_bounds, unite
from peopleboy.sim.shapes.skins import PosedSkins, SkinTable

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_SLACK = 1e-9  # [px] as that of the canvas
_NOTHING: Point = (0.0, 0.0, 0.0)


@njit(cache=True, nogil=True)
def see_skins(posed: PosedSkins, camera_from_world: Array) -> Array:
    """Return the vertices (V, 3) [m] in the optical frame."""
    points = np.empty_like(posed.vertices)
    for v in range(len(points)):
        points[v, 0], points[v, 1], points[v, 2] = map_point(
            camera_from_world, posed.vertices[v, 0], posed.vertices[v, 1], posed.vertices[v, 2]
        )
    return points


@njit(cache=True, nogil=True, error_model="numpy")
def draw_skins(
    skins: SkinTable, points: Array, skip: Mask, bits: NDArray[np.uint64], lens: Lens, canvas: Canvas
) -> None:
    """Draw all triangles except those of skipped parts.

    Args:
        skins: the skins.
        points: (V, 3) [m] vertices in the optical frame, see `see_skins`.
        skip: (P,) parts that are not drawn.
        bits: (P,) bits that a part's silhouette sets in the cover.
        lens: ray directions of the pixels.
        canvas: canvas to draw on.
    """
    most = 0
    for k in range(len(skins.part_of_bone)):
        most = max(most, skins.first_vertex[k + 1] - skins.first_vertex[k])
    image = np.empty((most, 3))
    set_shading(canvas, skins.first_surface, _NOTHING, _NOTHING, 0.0)  # `shade_skins` follows
    for k in range(len(skins.part_of_bone)):
        first, end = skins.first_vertex[k], skins.first_vertex[k + 1]
        near = _project(points[first:end], lens, image)
        if near == _BEHIND or (near == _AHEAD and _is_outside(image[: end - first], lens)):
            continue
        for t in range(skins.first_triangle[k], skins.first_triangle[k + 1]):
            part = skins.part[t]
            if skip[part]:
                continue
            a, b, c = skins.triangles[t, 0], skins.triangles[t, 1], skins.triangles[t, 2]
            if near == _ACROSS and min(points[a, 2], points[b, 2], points[c, 2]) < NEAR_M:
                _draw_across(points, a, b, c, skins.first_surface + t, bits[part], lens, canvas)
            else:
                _fill(
                    image, a - first, b - first, c - first, skins.first_surface + t, bits[part], lens, canvas
                )


_AHEAD, _ACROSS, _BEHIND = 0, 1, 2


@njit(cache=True, nogil=True, error_model="numpy")
def _project(points: Array, lens: Lens, image: Array) -> int:
    """Write column, row [px] and nearness [1/m] of points (V, 3); return on which side of the near plane."""
    least, most = math.inf, -math.inf
    for v in range(len(points)):
        x, y, z = points[v, 0], points[v, 1], points[v, 2]
        nearness = 1.0 / z
        image[v, 0] = lens.centre_u + lens.focal * x * nearness
        image[v, 1] = lens.centre_v + lens.focal * y * nearness
        image[v, 2] = nearness
        least, most = min(least, z), max(most, z)
    if least >= NEAR_M:
        return _AHEAD
    return _ACROSS if most >= NEAR_M else _BEHIND


@njit(cache=True, nogil=True)
def _is_outside(image: Array, lens: Lens) -> bool:
    """Return whether all points are beyond one border of the image."""
    left, top, right, bottom = math.inf, math.inf, -math.inf, -math.inf
    for v in range(len(image)):
        left, right = min(left, image[v, 0]), max(right, image[v, 0])
        top, bottom = min(top, image[v, 1]), max(bottom, image[v, 1])
    return right < 0.0 or bottom < 0.0 or left > lens.width - 1.0 or top > lens.height - 1.0


@njit(cache=True, nogil=True, error_model="numpy")
def _fill(
    image: Array, a: int, b: int, c: int, surface: int, bit: np.uint64, lens: Lens, canvas: Canvas
) -> None:
    """Fill the front of a triangle, whose corners are rows of `image`."""
    ax, ay, bx, by, cx, cy = image[a, 0], image[a, 1], image[b, 0], image[b, 1], image[c, 0], image[c, 1]
    # Twice the area, positive from the front as rows go down.
    area = (cx - ax) * (by - ay) - (bx - ax) * (cy - ay)
    first_row = math.ceil(max(min(ay, by, cy) - _SLACK, 0.0))
    last_row = math.floor(min(max(ay, by, cy) + _SLACK, lens.height - 1.0))
    least, most = max(min(ax, bx, cx) - _SLACK, 0.0), min(max(ax, bx, cx) + _SLACK, lens.width - 1.0)
    if not area > 0.0 or first_row > last_row or math.ceil(least) > math.floor(most):
        return
    scale = 1.0 / area
    az, bz, cz = image[a, 2], image[b, 2] - image[a, 2], image[c, 2] - image[a, 2]
    slope_u = (cz * (by - ay) - bz * (cy - ay)) * scale
    slope_v = (bz * (cx - ax) - cz * (bx - ax)) * scale
    own = np.int32(surface)
    for v in range(first_row, last_row + 1):
        low, high = _cross(ax, ay, bx, by, float(v), least, most)
        low, high = _cross(bx, by, cx, cy, float(v), low, high)
        low, high = _cross(cx, cy, ax, ay, float(v), low, high)
        if not low <= high:
            continue
        base = az + slope_v * (v - ay) - slope_u * ax
        nearness, surfaces, cover = canvas.nearness[v], canvas.surface[v], canvas.cover[v]
        for u in range(np.uint64(math.ceil(low)), np.uint64(math.floor(high) + 1)):
            here = slope_u * np.int32(u) + base
            cover[u] |= bit
            is_nearer = here > nearness[u]
            nearness[u] = here if is_nearer else nearness[u]
            surfaces[u] = own if is_nearer else surfaces[u]


@njit(cache=True, nogil=True, error_model="numpy")
def _cross(
    px: float, py: float, qx: float, qy: float, v: float, low: float, high: float
) -> tuple[float, float]:
    """Narrow a span of a row to the inner side of the edge from p to q, which is on the left going down."""
    if py == qy:
        return low, high
    at = px + (v - py) * (qx - px) / (qy - py)
    if qy > py:
        return max(low, at - _SLACK), high
    return low, min(high, at + _SLACK)


@njit(cache=True, nogil=True, error_model="numpy")
def _draw_across(
    points: Array, a: int, b: int, c: int, surface: int, bit: np.uint64, lens: Lens, canvas: Canvas
) -> None:
    """Draw a triangle across the near plane."""
    corners, none = np.empty((3, 3)), 0
    whole = (none, none, lens.width - 1, lens.height - 1)
    for i in range(3):
        corners[0, i], corners[1, i], corners[2, i] = points[a, i], points[b, i], points[c, i]
        for j in range(4):
            canvas.pose[i, j] = 1.0 if i == j else 0.0
    draw_triangle(corners, surface, Brush(bit, lens, whole, canvas))


@njit(cache=True, nogil=True, error_model="numpy")
def shade_skins(
    posed: PosedSkins,
    points: Array,
    lens: Lens,
    canvas: Canvas,
    rotation: Array,
    normal: NDArray[np.float32],
) -> None:
    """Write the normals of skins, interpolated between their vertices; arguments as in `shade`.

    With the corners a, b, c, the ray d meets the triangle at shares in the ratio of d . (b x c), d . (c x a)
    and d . (a x b), so the normal is linear in d before it is scaled to 1.
    """
    skins, linear = posed.table, np.empty((3, 3))
    for v in range(lens.height):
        known = -1
        for u in range(lens.width):
            surface = canvas.surface[v, u]
            if canvas.nearness[v, u] == 0.0 or surface < skins.first_surface:
                continue
            if surface != known:
                known = surface
                _interpolate(posed, points, surface - skins.first_surface, linear)
            x, y = (u - lens.centre_u) / lens.focal, (v - lens.centre_v) / lens.focal
            n = map_direction(linear, x, y)
            d = map_direction(rotation, x, y)
            # A smooth normal may turn away from the camera near an outline.
            away = dot(n, d) / dot(d, d)
            if away > 0.0:
                n = (n[0] - away * d[0], n[1] - away * d[1], n[2] - away * d[2])
            size = 1.0 / math.sqrt(max(dot(n, n), 1e-60))
            for i in range(3):
                normal[v, u, i] = n[i] * size


@njit(cache=True, nogil=True)
def map_direction(matrix: Array, x: float, y: float) -> Point:
    """Return the product of a matrix (3, 3) and the ray (x, y, 1)."""
    return (
        matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2],
        matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2],
        matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2],
    )


@njit(cache=True, nogil=True, error_model="numpy")
def _interpolate(posed: PosedSkins, points: Array, triangle: int, linear: Array) -> None:
    """Write the matrix (3, 3) that maps rays to normals, up to their length, of one triangle."""
    corners = posed.table.triangles[triangle]
    a, b, c = points[corners[0]], points[corners[1]], points[corners[2]]
    p, q, r = (a[0], a[1], a[2]), (b[0], b[1], b[2]), (c[0], c[1], c[2])
    # The sign makes shares positive on the triangle, whose front has negative volumes towards the camera.
    e, f, g = cross(r, q), cross(p, r), cross(q, p)
    for i in range(3):
        na, nb, nc = posed.normals[corners[0], i], posed.normals[corners[1], i], posed.normals[corners[2], i]
        for j in range(3):
            linear[i, j] = na * e[j] + nb * f[j] + nc * g[j]


# Outlines.


@njit(cache=True, nogil=True, error_model="numpy")
def skin_bounds(skins: SkinTable, points: Array, parts: Mask, found: Array) -> None:
    """Extend bounds (N, 4), as in `shapes.bounds`, by the triangles of sets of parts (N, P).

    They are exact for vertices beyond the near plane; edges across it are cut there.
    """
    for k in range(len(skins.part_of_bone)):
        first, end = skins.first_vertex[k], skins.first_vertex[k + 1]
        chosen = np.zeros(len(parts), np.bool_)
        for n in range(len(parts)):
            for t in range(skins.part_of_bone.shape[1]):
                chosen[n] |= parts[n, skins.part_of_bone[k, t]]
        if not chosen.any():
            continue
        is_ahead = True
        for v in range(first, end):
            is_ahead &= points[v, 2] >= NEAR_M
        if is_ahead:
            _vertex_bounds(skins, points, first, end, parts, chosen, found)
        else:
            _edge_bounds(skins, points, k, parts, chosen, found)


@njit(cache=True, nogil=True, error_model="numpy")
def _vertex_bounds(
    skins: SkinTable, points: Array, first: int, end: int, parts: Mask, chosen: Mask, found: Array
) -> None:
    for v in range(first, end):
        x, y = points[v, 0] / points[v, 2], points[v, 1] / points[v, 2]
        p, q = skins.vertex_parts[v, 0], skins.vertex_parts[v, 1]
        for n in range(len(parts)):
            if chosen[n] and (parts[n, p] or parts[n, q]):
                found[n, 0], found[n, 1] = min(found[n, 0], x), min(found[n, 1], y)
                found[n, 2], found[n, 3] = max(found[n, 2], x), max(found[n, 3], y)


@njit(cache=True, nogil=True, error_model="numpy")
def _edge_bounds(skins: SkinTable, points: Array, k: int, parts: Mask, chosen: Mask, found: Array) -> None:
    for t in range(skins.first_triangle[k], skins.first_triangle[k + 1]):
        own: Bounds = EMPTY
        for i in range(3):
            a, b = skins.triangles[t, i], skins.triangles[t, (i + 1) % 3]
            p = (points[a, 0], points[a, 1], points[a, 2])
            q = (points[b, 0], points[b, 1], points[b, 2])
            own = unite(own, segment_bounds(p, q))
        for n in range(len(parts)):
            if chosen[n] and parts[n, skins.part[t]]:
                bounds = unite((found[n, 0], found[n, 1], found[n, 2], found[n, 3]), own)
                found[n, 0], found[n, 1], found[n, 2], found[n, 3] = bounds
