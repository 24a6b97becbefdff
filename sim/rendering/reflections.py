"""Reflections in shiny flat surfaces.

A mirror shows the view of a virtual camera, whose pose is reflected by the mirror's plane. The ray caster
draws that view, too, in the window that may contain mirrored people and warm or bright objects. All other
objects only occlude them; elsewhere the mirror reflects the surroundings. Since real floors are not that
smooth, reflections are drawn at every third pixel.
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.geometry.vectors import Point, compose, dot, map_point, minus, plus, scaled, turn_back
from peopleboy.sim.rendering.raycast import borders_of, draw_shape, is_outside, quick_bounds
from peopleboy.sim.rendering.render_canvas import (
    Brush,
    Canvas,
    Lens,
    Rectangle,
    make_canvas,
    pixels,
    set_shading,
    shade,
)
from peopleboy.sim.rendering.renderer import RenderPass
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.bounds import EMPTY, EVERYTHING, FAR_M, NEAR_M, Bounds, unite
from peopleboy.sim.shapes.rays import hit_shape
from peopleboy.sim.shapes.shape_table import ShapeTable
from peopleboy.sim.shapes.shapes import ShapeKind

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Image = NDArray[np.float32]
Pixels = NDArray[np.int32]
Plane = tuple[float, float, float, float]

_SPHERE = int(ShapeKind.SPHERE)
_CAPSULE = int(ShapeKind.CAPSULE)
_CYLINDER = int(ShapeKind.CYLINDER)
_BOX = int(ShapeKind.BOX)
_FLAT = (_BOX, int(ShapeKind.PLANE))
_NO_AXIS: Point = (0.0, 0.0, 0.0)
_FEWEST = 30  # least pixels of a surface with visible reflections
EVERY = 3  # image pixels per pixel of a reflection, in rows and columns
_MOST = 6  # largest number of mirror planes, those with the most pixels
_SAME_M, _SAME_COS = 2e-3, 0.99999  # tolerances of surfaces in one plane
_SUNK_M = 0.03  # depth by which feet may sink into a mirror
_HAIR_M = 0.004  # depth by which objects and feet may sink into a surface without being occluded by it


@dataclass(frozen=True, slots=True, eq=False)
class Reflection:
    """Reflection in one plane.

    Attributes:
        left, top: [px] the window's first column and row in the image.
        view: (h, w) mirrored view at every third pixel of the window in rows and columns; part is -1 for the
            surroundings.
        world_from_camera: (4, 4) pose of the mirrored camera.
        cosine: (h, w) cosine between the plane's normal and the ray to the pixel.
        is_surface: (M,) whether a surface is in the plane.
    """

    left: int
    top: int
    view: View
    world_from_camera: Matrix
    cosine: NDArray[np.float32]
    is_surface: Mask


def find_reflections(
    seen: RenderPass, camera: Pinhole, is_shiny: Mask, is_mirrored: Mask
) -> tuple[Reflection, ...]:
    """Find the reflections in a camera's view.

    Args:
        seen: view of a pinhole camera.
        camera: that camera.
        is_shiny: (P,) reflecting parts.
        is_mirrored: (P,) parts that appear in reflections.
    """
    view, scene, eye = seen.view, seen.scene, seen.world_from_camera
    if view.surface is None or not is_shiny.any():
        return ()
    lens = Lens(camera.focal_px, *camera.centre_px, camera.width, camera.height)
    planes, windows, is_surface = _find_mirrors(
        view.part, view.surface, view.depth, view.normal, scene.table, is_shiny, eye, lens
    )
    found = []
    for plane, window, its_surfaces in zip(planes, windows, is_surface, strict=True):
        left, top, pose, part, depth, normal, surface, cosine = _look_into(
            scene.table, eye, scene.world_from_part, scene.hidden, is_mirrored, plane, window, lens
        )
        if len(part):
            beyond = View(part, depth, normal, np.zeros(part.shape, np.uint64), surface)
            found.append(Reflection(left, top, beyond, pose, cosine, its_surfaces))
    return tuple(found)


@njit(cache=True)
def _find_mirrors(
    part: Pixels,
    surface: Pixels,
    depth: Image,
    normal: Image,
    table: ShapeTable,
    is_shiny: Mask,
    eye: Array,
    lens: Lens,
) -> tuple[Array, NDArray[np.int64], Mask]:
    """Return the mirror planes, by descending number of pixels.

    Returns:
        (K, 4) normals and distances from the origin along them, world frame; (K, 4) [px] windows of their
        pixels: left, top, right, bottom; (K, M) the surfaces in them.
    """
    count, window, example = _count(part, surface, is_shiny, len(table.surface_part))
    large = np.flatnonzero(count >= _FEWEST)
    planes, windows = np.empty((len(large), 4)), np.empty((len(large), 4), np.int64)
    is_surface, found = np.zeros((len(large), len(count)), np.bool_), 0
    for s in large[np.argsort(-count[large], kind="mergesort")]:
        if table.kind[table.surface_shape[s]] not in _FLAT:
            continue
        v, u = example[s] // lens.width, example[s] % lens.width
        z, across, down = depth[v, u], (u - lens.centre_u) / lens.focal, (v - lens.centre_v) / lens.focal
        offset = 0.0
        for i in range(3):
            offset += normal[v, u, i] * ((eye[i, 0] * across + eye[i, 1] * down + eye[i, 2]) * z + eye[i, 3])
        k = _same_plane(planes[:found], normal[v, u], offset)
        if k == found:
            for i in range(3):
                planes[k, i] = normal[v, u, i]
            for i in range(4):
                windows[k, i] = window[s, i]
            planes[k, 3] = offset
            found += 1
        for i in range(2):
            windows[k, i] = min(windows[k, i], window[s, i])
            windows[k, 2 + i] = max(windows[k, 2 + i], window[s, 2 + i])
        is_surface[k, s] = True
    most = min(found, _MOST)
    return planes[:most], windows[:most], is_surface[:most]


@njit(cache=True)
def _same_plane(planes: Array, normal: Image, offset: float) -> int:
    """Return the number of the plane (K, 4) with a normal (3,) and an offset [m], K for none."""
    for k in range(len(planes)):
        cosine = 0.0
        for i in range(3):
            cosine += planes[k, i] * normal[i]
        if cosine > _SAME_COS and abs(planes[k, 3] - offset) < _SAME_M:
            return k
    return len(planes)


@njit(cache=True, error_model="numpy")
def _look_into(
    table: ShapeTable,
    eye: Array,
    world_from_part: Array,
    hidden: Mask,
    is_mirrored: Mask,
    mirror: Array,
    window: NDArray[np.int64],
    lens: Lens,
) -> tuple[int, int, Array, Pixels, Image, Image, Pixels, Image]:
    """Return all of a `Reflection` except its surfaces; parts are (0, w) if nothing is mirrored.

    Args:
        table: the world's shapes.
        eye: (4, 4) pose of the camera.
        world_from_part: (P, 4, 4).
        hidden: (P,) absent parts.
        is_mirrored: (P,) parts that appear in reflections.
        mirror: (4,) plane of the mirror, as in `_find_mirrors`.
        window: (4,) [px] window of its pixels.
        lens: lens of the camera.
    """
    away = mirror[3] - (mirror[0] * eye[0, 3] + mirror[1] * eye[1, 3] + mirror[2] * eye[2, 3])
    world_from_camera, up = eye.copy(), np.empty(3)
    for j in range(3):
        up[j] = mirror[0] * eye[0, j] + mirror[1] * eye[1, j] + mirror[2] * eye[2, j]
    for i in range(3):
        for j in range(3):
            world_from_camera[i, j] -= 2.0 * mirror[i] * up[j]
        world_from_camera[i, 3] += 2.0 * away * mirror[i]
    plane, left, top = (up[0], up[1], up[2], away), window[0], window[1]
    lens = _every(lens, left, top, window[2], window[3])
    canvas = make_canvas(lens, len(table.surface_part))
    camera_from_part = _seen_from(world_from_camera, world_from_part)
    box = _draw_beyond(table, camera_from_part, hidden, is_mirrored, plane, lens, canvas)
    # A margin of one pixel, since reflections end between pixels.
    column, row = max(box[0] - 1, 0), max(box[1] - 1, 0)
    width, height = min(box[2] + 2, lens.width) - column, min(box[3] + 2, lens.height) - row
    if box[0] > box[2] or box[1] > box[3]:
        column, row, width, height = 0, 0, 0, 0
    canvas = Canvas(
        canvas.nearness[row : row + height, column : column + width].copy(),
        canvas.surface[row : row + height, column : column + width].copy(),
        canvas.cover,
        canvas.shading,
        canvas.edges,
        canvas.pose,
    )
    lens = Lens(lens.focal, lens.centre_u - column, lens.centre_v - row, width, height)
    shape = (height, width)
    cosine, depth = np.empty(shape, np.float32), np.empty(shape, np.float32)
    part, normal = np.empty(shape, np.int32), np.empty((height, width, 3), np.float32)
    if _keep(canvas, table.surface_part, is_mirrored, plane, lens, cosine):
        shade(table.surface_part, lens, canvas, world_from_camera, part, depth, normal)
    else:
        part = part[:0]
    left, top = left + EVERY * column, top + EVERY * row
    return left, top, world_from_camera, part, depth, normal, canvas.surface, cosine


@njit(cache=True)
def _seen_from(world_from_camera: Array, world_from_part: Array) -> Array:
    """Return (P, 3, 4) camera from part, for rigid poses (4, 4) and (P, 4, 4)."""
    inverse, found = np.empty((3, 4)), np.empty((len(world_from_part), 3, 4))
    for i in range(3):
        inverse[i, 3] = 0.0
        for j in range(3):
            inverse[i, j] = world_from_camera[j, i]
            inverse[i, 3] -= world_from_camera[j, i] * world_from_camera[j, 3]
    for part in range(len(found)):
        compose(inverse, world_from_part[part], found[part])
    return found


@njit(cache=True)
def _every(lens: Lens, left: int, top: int, right: int, bottom: int) -> Lens:
    """Return a lens for every n-th pixel of a window."""
    u, v = (lens.centre_u - left) / EVERY, (lens.centre_v - top) / EVERY
    return Lens(lens.focal / EVERY, u, v, (right - left) // EVERY + 2, (bottom - top) // EVERY + 2)


@njit(cache=True, error_model="numpy")
def _draw_beyond(
    table: ShapeTable,
    camera_from_part: Array,
    hidden: Mask,
    is_mirrored: Mask,
    plane: Plane,
    lens: Lens,
    canvas: Canvas,
) -> Rectangle:
    """Draw the view in a mirror with its occluders, and return the pixels that it can cover.

    Only shapes whose centre is in front of the mirror are drawn. Arguments are as in `draw`, except
    `is_mirrored` (P,), the parts that appear in reflections, and the mirror's plane as in `_keep`.
    """
    left, top, right, bottom = lens.width, lens.height, -1, -1
    pose, borders, farthest = canvas.pose, borders_of(lens), 0.0
    least, most = np.full(3, math.inf), np.full(3, -math.inf)
    bounds = (0, 0, lens.width - 1, lens.height - 1)
    for is_wanted in (True, False):
        for shape in range(len(table.kind)):
            part = table.part[shape]
            if hidden[part] or is_mirrored[part] != is_wanted:
                continue
            to_camera, middle = camera_from_part[part], table.part_from_shape[shape]
            x, y, z = map_point(to_camera, middle[0, 3], middle[1, 3], middle[2, 3])
            if plane[0] * x + plane[1] * y + plane[2] * z >= plane[3]:
                continue
            radius = table.reach[shape]
            if is_outside((x, y, z), radius, lens.focal, borders) or (
                not is_wanted and z - radius > farthest
            ):
                continue
            compose(to_camera, middle, pose)
            kind, size = table.kind[shape], table.size[shape]
            is_round = kind in (_CAPSULE, _SPHERE)
            area = pixels(lens, _around_balls(size, pose) if is_round else quick_bounds(table, shape, pose))
            area = (
                max(area[0], bounds[0]), max(area[1], bounds[1]),
                min(area[2], bounds[2]), min(area[3], bounds[3]),
            )  # fmt: skip
            is_behind = (not is_wanted and kind == _BOX) and (
                z - _depth_of(size, pose) > farthest or _is_beside(size, pose, least, most)
            )
            if is_behind or area[0] > area[2] or area[1] > area[3]:
                continue
            if is_wanted:
                left, top = min(left, area[0]), min(top, area[1])
                right, bottom = max(right, area[2]), max(bottom, area[3])
                farthest = max(farthest, z + radius)
                _take_in(kind, size, pose, least, most)
            if is_round:
                _draw_round(kind, size, table.first_surface[shape], lens, area, canvas)
            else:
                draw_shape(table, shape, Brush(np.uint64(0), lens, area, canvas))
        if right < 0:
            break
        # An occluder must be nearer, and within the bounds.
        bounds = (left, top, right, bottom)
        borders = borders_of(
            Lens(lens.focal, lens.centre_u - left, lens.centre_v - top, right - left + 1, bottom - top + 1)
        )
    return left, top, right, bottom


@njit(cache=True, error_model="numpy")
def _draw_round(kind: int, size: Array, surface: int, lens: Lens, area: Rectangle, canvas: Canvas) -> None:
    """Draw a sphere or a capsule by casting the ray of each pixel, which is fast for few pixels."""
    pose = canvas.pose
    centre, axis = (pose[0, 3], pose[1, 3], pose[2, 3]), (pose[0, 2], pose[1, 2], pose[2, 2])
    radius, half = (size[1], 0.5 * size[0]) if kind == _CAPSULE else (size[0], 0.0)
    if kind == _CAPSULE:
        set_shading(canvas, surface, axis, minus(scaled(axis, dot(axis, centre)), centre), 1.0 / radius)
        for i in range(2):
            end = plus(centre, scaled(axis, (2 * i - 1) * half))
            set_shading(canvas, surface + 1 + i, _NO_AXIS, scaled(end, -1.0), 1.0 / radius)
    else:
        set_shading(canvas, surface, _NO_AXIS, scaled(centre, -1.0), 1.0 / radius)
    eye = turn_back(pose, -centre[0], -centre[1], -centre[2])
    step = scaled((pose[0, 0], pose[0, 1], pose[0, 2]), 1.0 / lens.focal)
    extent = (size[0], size[1], size[2])
    for v in range(area[1], area[3] + 1):
        ray = turn_back(pose, -lens.centre_u / lens.focal, (v - lens.centre_v) / lens.focal, 1.0)
        nearness, surfaces = canvas.nearness[v], canvas.surface[v]
        for u in range(area[0], area[2] + 1):
            z, local = hit_shape(kind, extent, eye, plus(ray, scaled(step, float(u))))
            if z * nearness[u] < 1.0 and NEAR_M <= z <= FAR_M:
                nearness[u] = 1.0 / z
                surfaces[u] = surface + local


@njit(cache=True, error_model="numpy")
def _around_balls(size: Array, pose: Array) -> Bounds:
    """Return fast, conservative bounds of a capsule or a sphere: those of a box around each end."""
    is_capsule = size[1] > 0.0
    radius, half = (size[1], 0.5 * size[0]) if is_capsule else (size[0], 0.0)
    bounds = EMPTY
    for i in range(2 if is_capsule else 1):
        along = (2 * i - 1) * half
        x, y, z = map_point(pose, 0.0, 0.0, along)
        if z - radius < NEAR_M:
            return EVERYTHING
        near, far = 1.0 / (z - radius), 1.0 / (z + radius)
        bounds = unite(
            bounds,
            (
                (x - radius) * (near if x < radius else far),
                (y - radius) * (near if y < radius else far),
                (x + radius) * (far if x < -radius else near),
                (y + radius) * (far if y < -radius else near),
            ),
        )
    return bounds


@njit(cache=True)
def _depth_of(size: Array, pose: Array) -> float:
    """Return the extent [m] of a box from its centre towards the camera."""
    depth: float = 0.5 * (abs(pose[2, 0]) * size[0] + abs(pose[2, 1]) * size[1] + abs(pose[2, 2]) * size[2])
    return depth


@njit(cache=True)
def _take_in(kind: int, size: Array, pose: Array, least: Array, most: Array) -> None:
    """Extend the bounds (3,), (3,) [m] of the drawn shapes, in the camera's frame, by one shape."""
    for i in range(3):
        if kind == _BOX:
            wide = 0.5 * (abs(pose[i, 0]) * size[0] + abs(pose[i, 1]) * size[1] + abs(pose[i, 2]) * size[2])
        elif kind in (_CAPSULE, _CYLINDER):
            wide = 0.5 * abs(pose[i, 2]) * size[0] + size[1]
        else:
            wide = size[0] if kind == _SPHERE else math.inf
        least[i], most[i] = min(least[i], pose[i, 3] - wide), max(most[i], pose[i, 3] + wide)


@njit(cache=True)
def _is_beside(size: Array, pose: Array, least: Array, most: Array) -> bool:
    """Return whether camera and bounds (3,), (3,) [m] in its frame are in front of the same face of a box.

    The box then occludes nothing within the bounds, except parts that are sunk into it slightly.
    """
    for j in range(3):
        middle = pose[0, j] * pose[0, 3] + pose[1, j] * pose[1, 3] + pose[2, j] * pose[2, 3]
        for sign in (-1.0, 1.0):
            face = sign * middle + 0.5 * size[j]
            if face > 0.0:
                continue
            nearest = 0.0
            for i in range(3):
                nearest += min(sign * pose[i, j] * least[i], sign * pose[i, j] * most[i])
            if nearest >= face - _HAIR_M:
                return True
    return False


@njit(cache=True)
def _count(
    part: Pixels, surface: Pixels, is_shiny: Mask, surfaces: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return pixel count, window (left, top, right, bottom) and one pixel of each shiny surface.

    Only every other row and column is evaluated.
    """
    height, width = part.shape
    count, example = np.zeros(surfaces, np.int64), np.zeros(surfaces, np.int64)
    window = np.empty((surfaces, 4), np.int64)
    for v in range(0, height, 2):
        end = 0
        while end < width:
            # Adjacent pixels of one surface are counted together.
            first, p, s = end, part[v, end], surface[v, end]
            while end < width and part[v, end] == p and surface[v, end] == s:
                end += 2
            if p < 0 or not is_shiny[p]:
                continue
            if count[s] == 0:
                window[s, 0], window[s, 1], window[s, 2] = first, max(v - 1, 0), first
            count[s] += 2 * (end - first)
            window[s, 0] = min(window[s, 0], max(first - 1, 0))
            window[s, 2] = max(window[s, 2], min(end - 1, width - 1))
            window[s, 3] = min(v + 1, height - 1)
            example[s] = v * width + end - 2
    return count, window, example


@njit(cache=True, error_model="numpy")
def _keep(
    canvas: Canvas,
    surface_part: NDArray[np.int32],
    wanted: Mask,
    plane: Plane,
    lens: Lens,
    cosine: NDArray[np.float32],
) -> bool:
    """Keep only wanted parts of the view behind a mirror, and return whether there are any.

    Args:
        canvas: the drawn view; pixels of unwanted parts, or in front of the mirror, are cleared.
        surface_part: (M,) part of each surface.
        wanted: (P,) whether to keep a part.
        plane: x, y, z of the mirror's normal, and its distance along that, in the camera's frame.
        lens: ray directions of the pixels.
        cosine: (h, w) output, cosine between normal and ray.
    """
    is_any = False
    for v in range(lens.height):
        y = (v - lens.centre_v) / lens.focal
        for u in range(lens.width):
            x = (u - lens.centre_u) / lens.focal
            slope = plane[0] * x + plane[1] * y + plane[2]
            cosine[v, u] = max(-slope, 0.0) / math.sqrt(x * x + y * y + 1.0)
        for u in range(lens.width):
            nearness = canvas.nearness[v, u]
            if nearness == 0.0:
                continue
            slope = plane[0] * (u - lens.centre_u) / lens.focal + plane[1] * y + plane[2]
            is_beyond = slope < 0.0 and (plane[3] / slope - _SUNK_M) * nearness <= 1.0
            if is_beyond and wanted[surface_part[canvas.surface[v, u]]]:
                is_any = True
            else:
                canvas.nearness[v, u] = 0.0
    return is_any
