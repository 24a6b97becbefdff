"""Drawing of skins: a z-buffer for their triangles on the canvas of the ray caster (numba kernels).

1 / z is linear in the pixel's column and row over a triangle, so the nearness is exact at pixel centres. As
in `canvas`, spans are a little wider than the triangle, so that no gap opens at common edges, and the nearest
surface wins. Triangles across the near plane are drawn as polygons of the ray caster, which needs no
clipping.
"""

import math
from typing import NamedTuple

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


class SeenSkins(NamedTuple):
    """Skins in a camera's frame.

    Attributes:
        posed: the K skins with V vertices.
        points: (V, 3) [m] vertices in the optical frame.
        image: (V, 3) position of each vertex at a distance of 1 m, to the right and down, and its nearness
            1 / z [1/m].
    """

    posed: PosedSkins
    points: Array
    image: Array


@njit(cache=True, nogil=True, error_model="numpy")
def see_skins(posed: PosedSkins, camera_from_world: Array) -> SeenSkins:
    """Return skins in the frame of a camera."""
    points, image = np.empty_like(posed.vertices), np.empty_like(posed.vertices)
    for v in range(len(points)):
        x, y, z = map_point(
            camera_from_world, posed.vertices[v, 0], posed.vertices[v, 1], posed.vertices[v, 2]
        )
        points[v, 0], points[v, 1], points[v, 2] = x, y, z
        nearness = 1.0 / z
        image[v, 0], image[v, 1], image[v, 2] = x * nearness, y * nearness, nearness
    return SeenSkins(posed, points, image)


@njit(cache=True, nogil=True)
def to_pixels(image: Array, lens: Lens, pixels: Array) -> None:
    """Write column and row [px] and nearness [1/m] of vertices (V, 3) to the first V rows of an array."""
    for v in range(len(image)):
        pixels[v, 0] = lens.centre_u + lens.focal * image[v, 0]
        pixels[v, 1] = lens.centre_v + lens.focal * image[v, 1]
        pixels[v, 2] = image[v, 2]


@njit(cache=True, nogil=True, error_model="numpy")
def draw_skins(
    seen: SeenSkins, skip: Mask, bits: NDArray[np.uint64], lens: Lens, canvas: Canvas
) -> NDArray[np.int64]:
    """Draw all triangles except those of skipped parts.

    Args:
        seen: the skins.
        skip: (P,) parts that are not drawn.
        bits: (P,) bits that a part's silhouette sets in the cover.
        lens: ray directions of the pixels.
        canvas: canvas to draw on.

    Returns:
        (K, 4) first column and row, and those after the last, of the pixels that each skin may cover.
    """
    skins, points, most = seen.posed.table, seen.points, 0
    area = np.empty((len(skins.part_of_bone), 4), np.int64)
    for k in range(len(skins.part_of_bone)):
        most = max(most, skins.first_vertex[k + 1] - skins.first_vertex[k])
    image = np.empty((most, 3))
    set_shading(canvas, skins.first_surface, _NOTHING, _NOTHING, 0.0)  # `shade_skins` follows
    for k in range(len(skins.part_of_bone)):
        first, end = skins.first_vertex[k], skins.first_vertex[k + 1]
        near = _side(points[first:end])
        to_pixels(seen.image[first:end], lens, image)
        _cover(image[: end - first], near, lens, area[k])
        if area[k, 0] >= area[k, 2] or area[k, 1] >= area[k, 3]:
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
    return area


_AHEAD, _ACROSS, _BEHIND = 0, 1, 2


@njit(cache=True, nogil=True)
def _side(points: Array) -> int:
    """Return on which side of the near plane points (V, 3) are."""
    least, most = math.inf, -math.inf
    for v in range(len(points)):
        least, most = min(least, points[v, 2]), max(most, points[v, 2])
    if least >= NEAR_M:
        return _AHEAD
    return _ACROSS if most >= NEAR_M else _BEHIND


@njit(cache=True, nogil=True)
def _cover(image: Array, near: int, lens: Lens, area: NDArray[np.int64]) -> None:
    """Write the rectangle (4,) of pixels around all points; the whole image across the near plane."""
    left, top, right, bottom = 0.0, 0.0, lens.width - 1.0, lens.height - 1.0
    if near != _ACROSS:
        least, first, most, last = math.inf, math.inf, -math.inf, -math.inf
        for v in range(len(image) if near == _AHEAD else 0):
            least, most = min(least, image[v, 0]), max(most, image[v, 0])
            first, last = min(first, image[v, 1]), max(last, image[v, 1])
        left, top = max(left, least - _SLACK), max(top, first - _SLACK)
        right, bottom = min(right, most + _SLACK), min(bottom, last + _SLACK)
    is_some = left <= right and top <= bottom
    area[0], area[1] = (math.ceil(left), math.ceil(top)) if is_some else (0, 0)
    area[2], area[3] = (math.floor(right) + 1, math.floor(bottom) + 1) if is_some else (0, 0)


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
    seen: SeenSkins,
    area: NDArray[np.int64],
    lens: Lens,
    canvas: Canvas,
    rotation: Array,
    normal: NDArray[np.float32],
) -> None:
    """Write the normals of drawn skins, interpolated between their vertices.

    Arguments are as in `shade`, with the rectangles (K, 4) that `draw_skins` returns.
    """
    skins = seen.posed.table
    for k in range(len(area)):
        first = skins.first_surface + skins.first_triangle[k]
        end = skins.first_surface + skins.first_triangle[k + 1]
        for v in range(area[k, 1], area[k, 3]):
            for u in range(area[k, 0], area[k, 2]):
                surface = canvas.surface[v, u]
                if first <= surface < end and canvas.nearness[v, u] > 0.0:
                    x, y = (u - lens.centre_u) / lens.focal, (v - lens.centre_v) / lens.focal
                    n = _normal_at(seen, surface - skins.first_surface, x, y)
                    d = map_direction(rotation, x, y)
                    # A smooth normal may turn away from the camera near an outline.
                    away = max(dot(n, d) / dot(d, d), 0.0)
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
def _normal_at(seen: SeenSkins, triangle: int, x: float, y: float) -> Point:
    """Return the normal, up to its length, where the ray (x, y, 1) meets a triangle.

    With the corners a, b, c, the ray d meets it at shares in the ratio of d . (b x c), d . (c x a) and
    d . (a x b). Swapped factors make them positive, as the front has negative volumes towards the camera.
    """
    corners, points, normals = seen.posed.table.triangles[triangle], seen.points, seen.posed.normals
    a, b, c = corners[0], corners[1], corners[2]
    p = (points[a, 0], points[a, 1], points[a, 2])
    q = (points[b, 0], points[b, 1], points[b, 2])
    r = (points[c, 0], points[c, 1], points[c, 2])
    d = (x, y, 1.0)
    e, f, g = dot(d, cross(r, q)), dot(d, cross(p, r)), dot(d, cross(q, p))
    return (
        e * normals[a, 0] + f * normals[b, 0] + g * normals[c, 0],
        e * normals[a, 1] + f * normals[b, 1] + g * normals[c, 1],
        e * normals[a, 2] + f * normals[b, 2] + g * normals[c, 2],
    )


# Outlines.


@njit(cache=True, nogil=True, error_model="numpy")
def skin_bounds(seen: SeenSkins, parts: Mask, found: Array) -> None:
    """Extend bounds (N, 4), as in `shapes.bounds`, by the triangles of sets of parts (N, P).

    They are exact for vertices beyond the near plane; edges across it are cut there.
    """
    skins, points = seen.posed.table, seen.points
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
            _vertex_bounds(skins, seen.image, first, end, parts, chosen, found)
        else:
            _edge_bounds(skins, points, k, parts, chosen, found)


@njit(cache=True, nogil=True, error_model="numpy")
def _vertex_bounds(
    skins: SkinTable, image: Array, first: int, end: int, parts: Mask, chosen: Mask, found: Array
) -> None:
    for v in range(first, end):
        x, y = image[v, 0], image[v, 1]
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
