"""Who is mirrored where: shiny flat surfaces, and what is seen in them.

What a mirror shows is what a camera behind it would see, its pose reflected by the mirror's plane: so the ray
caster draws that as well, in the window in which mirrored people and warm or bright things may be. All else
only hides them there: what is mirrored besides is taken as the surroundings. As no floor is that smooth, it
is drawn at every other pixel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose
from peopleboy.sim.geometry.vectors import compose
from peopleboy.sim.rendering.canvas import Lens, pixels
from peopleboy.sim.rendering.raycast import quick_bounds
from peopleboy.sim.rendering.sight import Seen
from peopleboy.sim.rendering.view import NOBODY, View
from peopleboy.sim.shapes.bounds import EMPTY, Bounds, unite
from peopleboy.sim.shapes.shape_table import ShapeTable
from peopleboy.sim.shapes.shapes import ShapeKind

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Pixels = NDArray[np.int32]

_FLAT = (int(ShapeKind.BOX), int(ShapeKind.PLANE))
_FEWEST = 30  # pixels of a surface in which anything would be seen
EVERY = 2  # pixels of the image for one of a reflection, in row and column
_MOST = 6  # planes that mirror at a time, those of most pixels
_SAME_M, _SAME_COS = 2e-3, 0.99999  # between surfaces in one plane
_SUNK_M = 0.03  # how far feet may sink into a mirror


@dataclass(frozen=True, slots=True, eq=False)
class Reflection:
    """What is mirrored in one plane.

    Attributes:
        left, top: [px] the window's first column and row in the image.
        view: (h, w) what is seen beyond the mirror at every other pixel of the window in row and column; part
            is -1 where only the surroundings are.
        world_from_camera: (4, 4) pose of the mirrored camera.
        cosine: (h, w) between the plane's normal and the ray to the pixel.
        is_surface: (M,) surfaces that lie in the plane.
    """

    left: int
    top: int
    view: View
    world_from_camera: Matrix
    cosine: NDArray[np.float32]
    is_surface: Mask


@dataclass(frozen=True, slots=True, eq=False)
class _Mirror:
    """A plane n . x = offset (world frame), the surfaces in it, and the window [px] of their pixels."""

    normal: Array
    offset: float
    surfaces: list[int]
    window: tuple[int, int, int, int]


def find_reflections(
    seen: Seen, camera: Pinhole, is_shiny: Mask, is_mirrored: Mask
) -> tuple[Reflection, ...]:
    """Find what is mirrored in what a camera sees.

    Args:
        seen: by a pinhole camera.
        camera: the same.
        is_shiny: (P,) parts that mirror.
        is_mirrored: (P,) parts that are seen in mirrors.
    """
    if seen.view.surface is None or not is_shiny.any():
        return ()
    mirrors = _find_mirrors(seen, camera, is_shiny)
    found = (_reflect(seen, camera, mirror, is_mirrored) for mirror in mirrors)
    return tuple(reflection for reflection in found if reflection is not None)


def _find_mirrors(seen: Seen, camera: Pinhole, is_shiny: Mask) -> list[_Mirror]:
    """The planes that most pixels lie in, most first."""
    view, table = seen.view, seen.scene.table
    assert view.surface is not None
    count, window, example = _count(view.part, view.surface, is_shiny, len(table.surface_part))
    large = np.flatnonzero(count >= _FEWEST)
    mirrors: list[_Mirror] = []
    for surface in large[np.argsort(-count[large], kind="stable")].tolist():
        if table.kind[table.surface_shape[surface]] not in _FLAT:
            continue
        v, u = divmod(int(example[surface]), camera.width)
        normal = view.normal[v, u].astype(np.float64)
        ray = np.array([u - camera.centre_px[0], v - camera.centre_px[1], camera.focal_px]) / camera.focal_px
        pose = seen.world_from_camera
        offset = float(normal @ (pose[:3, :3] @ ray * view.depth[v, u] + pose[:3, 3]))
        box = (*window[surface].tolist(),)
        for i, mirror in enumerate(mirrors):
            if mirror.normal @ normal > _SAME_COS and abs(mirror.offset - offset) < _SAME_M:
                mirrors[i] = _Mirror(
                    mirror.normal, mirror.offset, [*mirror.surfaces, surface], _around(mirror.window, box)
                )
                break
        else:
            mirrors.append(_Mirror(normal, offset, [surface], box))
    return mirrors[:_MOST]


def _around(a: tuple[int, ...], b: tuple[int, ...]) -> tuple[int, int, int, int]:
    return min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])


def _reflect(seen: Seen, camera: Pinhole, mirror: _Mirror, is_mirrored: Mask) -> Reflection | None:
    """Draw what is seen in a mirror; None if that is nothing."""
    from peopleboy.sim.rendering.render import cast_window  # here, as kinds are told without PyBullet

    scene = seen.scene
    householder = np.eye(4)
    householder[:3, :3] -= 2.0 * np.outer(mirror.normal, mirror.normal)
    householder[:3, 3] = 2.0 * mirror.offset * mirror.normal
    pose = householder @ seen.world_from_camera
    hidden = scene.hidden | ~_is_before(scene.table, scene.world_from_part, mirror.normal, mirror.offset)
    wanted = is_mirrored & ~hidden
    if not wanted.any():
        return None
    lens = Lens(camera.focal_px, *camera.centre_px, camera.width, camera.height)
    camera_from_part = invert_pose(pose) @ scene.world_from_part
    box = pixels(lens, _bounds(scene.table, camera_from_part, wanted))
    left, top = max(box[0], mirror.window[0]), max(box[1], mirror.window[1])
    right, bottom = min(box[2], mirror.window[2]), min(box[3], mirror.window[3])
    if left > right or top > bottom:
        return None
    lens = Lens(
        lens.focal / EVERY, (lens.centre_u - left) / EVERY, (lens.centre_v - top) / EVERY,
        (right - left) // EVERY + 2, (bottom - top) // EVERY + 2,
    )  # fmt: skip
    nobody = np.full(len(wanted), NOBODY, np.int64)
    beyond = cast_window(scene.table, lens, pose, scene.world_from_part, nobody, hidden)
    is_surface = np.zeros(len(scene.table.surface_part), np.bool_)
    is_surface[mirror.surfaces] = True
    up = mirror.normal @ seen.world_from_camera[:3, :3]
    away = mirror.offset - float(mirror.normal @ seen.world_from_camera[:3, 3])
    cosine = np.empty(beyond.part.shape, np.float32)
    plane = (float(up[0]), float(up[1]), float(up[2]), away)
    is_any = _keep(beyond.part, beyond.depth, wanted, plane, lens, cosine)
    return Reflection(left, top, beyond, pose, cosine, is_surface) if is_any else None


@njit(cache=True, error_model="numpy")
def _is_before(table: ShapeTable, world_from_part: Array, normal: Array, offset: float) -> Mask:
    """(P,) whether the middle of any of a part's shapes lies on the side of a plane to which it faces."""
    is_before = np.zeros(len(world_from_part), np.bool_)
    pose = np.empty((3, 4))
    for shape in range(len(table.kind)):
        part = table.part[shape]
        compose(world_from_part[part], table.part_from_shape[shape], pose)
        height = pose[0, 3] * normal[0] + pose[1, 3] * normal[1] + pose[2, 3] * normal[2]
        is_before[part] |= height > offset
    return is_before


@njit(cache=True)
def _count(
    part: Pixels, surface: Pixels, is_shiny: Mask, surfaces: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Count the pixels of each shiny surface; its window (left, top, right, bottom), and one pixel of it."""
    height, width = part.shape
    count, example = np.zeros(surfaces, np.int64), np.zeros(surfaces, np.int64)
    window = np.empty((surfaces, 4), np.int64)
    for v in range(height):
        for u in range(width):
            p = part[v, u]
            if p < 0 or not is_shiny[p]:
                continue
            s = surface[v, u]
            if count[s] == 0:
                window[s, 0] = window[s, 2] = u
                window[s, 1] = v
            count[s] += 1
            window[s, 0], window[s, 2] = min(window[s, 0], u), max(window[s, 2], u)
            window[s, 3] = v
            example[s] = v * width + u
    return count, window, example


@njit(cache=True)
def _bounds(table: ShapeTable, camera_from_part: Array, parts: Mask) -> Bounds:
    """Bounds of some parts (P,) as a mirrored camera sees them."""
    pose = np.empty((3, 4))
    bounds = EMPTY
    for shape in range(len(table.kind)):
        if parts[table.part[shape]]:
            compose(camera_from_part[table.part[shape]], table.part_from_shape[shape], pose)
            bounds = unite(bounds, quick_bounds(table, shape, pose))
    return bounds


@njit(cache=True, error_model="numpy")
def _keep(
    beyond: Pixels,
    far: NDArray[np.float32],
    wanted: Mask,
    plane: tuple[float, float, float, float],
    lens: Lens,
    cosine: NDArray[np.float32],
) -> bool:
    """Keep of what is beyond a mirror what is wanted, and tell whether that is anything.

    Args:
        beyond: (h, w) parts; gets -1 for what is not wanted, or lies before the mirror.
        far: (h, w) [m] their depths.
        wanted: (P,) parts.
        plane: x, y, z of the mirror's normal, and its distance along that, in the camera's frame.
        lens: where the pixels look.
        cosine: (h, w) gets the cosine between normal and ray.
    """
    is_any = False
    for v in range(beyond.shape[0]):
        y = (v - lens.centre_v) / lens.focal
        for u in range(beyond.shape[1]):
            x = (u - lens.centre_u) / lens.focal
            slope = plane[0] * x + plane[1] * y + plane[2]
            cosine[v, u] = max(-slope, 0.0) / math.sqrt(x * x + y * y + 1.0)
            p = beyond[v, u]
            if p < 0:
                continue
            if not wanted[p] or slope >= 0.0 or far[v, u] < plane[3] / slope - _SUNK_M:
                beyond[v, u] = -1
            else:
                is_any = True
    return is_any
