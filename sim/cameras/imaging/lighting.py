"""Reflections of shiny surfaces, added to an image that is linear in light or radiance."""

import math
from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.imaging.camera_view import CameraView
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.rendering.full_detail import REACH_M, Contacts, gap
from peopleboy.sim.rendering.reflections import EVERY
from peopleboy.sim.rendering.render_canvas import Lens, Rectangle
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.bounds import NEAR_M

Image = NDArray[np.float32]


def add_reflections(
    image: Image,
    seen: CameraView,
    camera: Pinhole,
    reflectance: NDArray[np.float64],
    surroundings: NDArray[np.float64],
    draw: Callable[[View, Matrix], Image],
) -> None:
    """Add reflections of shiny surfaces, which replace the uniform surroundings.

    The specular share rises from normal to grazing incidence by Schlick's approximation, times the shine of
    the surface. Emitted and scattered light is unchanged.

    Source: Schlick, An inexpensive BRDF model for physically-based rendering (1994), eq. 15.

    Args:
        image: (H, W, C).
        seen: view in full detail.
        camera: the pinhole camera.
        reflectance: (P,) reflectance of each part at normal incidence.
        surroundings: (C,) value of the surroundings.
        draw: returns the (h, w, C) image of a view for its part_from_pixel (P, 3, 4).
    """
    view = seen.view
    if view.surface is None or seen.full_detail is None:
        return
    for one in seen.full_detail.reflections:
        matrices = _part_from_pixel(
            camera.focal_px,
            camera.centre_px,
            one.left,
            one.top,
            one.world_from_camera,
            seen.world_from_part,
        )
        _mix(
            image, view.part, view.surface, one.is_surface, draw(one.view, matrices), one.view.part,
            one.cosine, one.left, one.top, reflectance, seen.materials.shine, surroundings,
        )  # fmt: skip


@njit(cache=True, fastmath=True)
def _part_from_pixel(
    focal: float,
    centre: tuple[float, float],
    left: int,
    top: int,
    world_from_camera: Matrix,
    world_from_part: Matrix,
) -> Matrix:
    """(P, 3, 4) as `surfaces.part_from_pixel`, for every few of a window's pixels, from its own corner."""
    matrices, rays, offset = np.empty((len(world_from_part), 3, 4)), np.empty((3, 3)), np.empty(3)
    step = EVERY / focal
    for i in range(3):
        across, down, ahead = world_from_camera[i, 0], world_from_camera[i, 1], world_from_camera[i, 2]
        rays[i, 0], rays[i, 1] = across * step, down * step
        rays[i, 2] = across * (left - centre[0]) / focal + down * (top - centre[1]) / focal + ahead
    for p in range(len(matrices)):
        pose = world_from_part[p]
        for i in range(3):
            offset[i] = world_from_camera[i, 3] - pose[i, 3]
        for i in range(3):
            for j in range(3):
                matrices[p, i, j] = (
                    pose[0, i] * rays[0, j] + pose[1, i] * rays[1, j] + pose[2, i] * rays[2, j]
                )
            matrices[p, i, 3] = pose[0, i] * offset[0] + pose[1, i] * offset[1] + pose[2, i] * offset[2]
    return matrices


@njit(cache=True, fastmath=True)
def _mix(
    image: Image,
    part: NDArray[np.int32],
    surface: NDArray[np.int32],
    is_surface: NDArray[np.bool_],
    mirrored: Image,
    beyond: NDArray[np.int32],
    cosine: NDArray[np.float32],
    left: int,
    top: int,
    reflectance: NDArray[np.float64],
    shine: NDArray[np.float64],
    surroundings: NDArray[np.float64],
) -> None:
    """Add the reflection to each pixel of a mirror, by linear interpolation of the window's pixels."""
    (height, width, channels), (rows, columns), step = mirrored.shape, part.shape, 1.0 / EVERY
    _subtract(mirrored, beyond, surroundings)
    for j in range(height - 1):
        for i in range(width - 1):
            if max(beyond[j, i], beyond[j, i + 1], beyond[j + 1, i], beyond[j + 1, i + 1]) < 0:
                continue
            for row in range(top + EVERY * j, min(top + EVERY * (j + 1), rows)):
                down = (row - top) * step - j
                for column in range(left + EVERY * i, min(left + EVERY * (i + 1), columns)):
                    p = part[row, column]
                    if p < 0 or not is_surface[surface[row, column]]:
                        continue
                    share = shine[p] * mirrored_share(reflectance[p], cosine[j, i])
                    across = (column - left) * step - i
                    for c in range(channels):
                        above, below = mirrored[j, i, c], mirrored[j + 1, i, c]
                        above += across * (mirrored[j, i + 1, c] - above)
                        below += across * (mirrored[j + 1, i + 1, c] - below)
                        more = above + down * (below - above)
                        image[row, column, c] = max(image[row, column, c] + share * more, 0.0)


@njit(cache=True, fastmath=True)
def _subtract(mirrored: Image, beyond: NDArray[np.int32], surroundings: NDArray[np.float64]) -> None:
    """Subtract the surroundings from a reflection; 0 where nothing is reflected."""
    for v in range(mirrored.shape[0]):
        for u in range(mirrored.shape[1]):
            for c in range(mirrored.shape[2]):
                mirrored[v, u, c] = mirrored[v, u, c] - surroundings[c] if beyond[v, u] >= 0 else 0.0


@njit(cache=True, fastmath=True)
def mirrored_share(reflectance: float, cosine: float) -> float:
    """Return the reflectance of a smooth surface, from that at normal incidence and the angle."""
    away = 1.0 - min(cosine, 1.0)
    square = away * away
    share: float = reflectance + (1.0 - reflectance) * square * square * away
    return share


# Soft shadows on the floor below people and objects that touch it or are close to it.

Array = NDArray[np.float64]

_EVERY = 4  # step in pixels for computing shadows, in rows and columns
_LEAST_WIDE_M = 0.05  # least width, so that a thin rod casts some shadow, too
_SLOWLY_M = 0.12  # a gap of this height below something halves its shadow
_DEEPEST = 0.85  # largest share of the ambient light that is lost
_NOWHERE_M = 1e9  # where the floor is not visible
_ALL_AROUND = 0.6  # share of ambient light on the floor; the rest comes from the lamps


def add_contact_shadows(
    image: NDArray[np.float32], view: View, camera: Pinhole, world_from_camera: Matrix, contacts: Contacts
) -> None:
    """Darken the floor of an (H, W, 3) image near objects on it, in place.

    Light on the floor's plane is computed at every fourth pixel, and interpolated linearly.
    """
    lens = Lens(camera.focal_px, *camera.centre_px, camera.width, camera.height)
    light = light_on_floor(lens, world_from_camera, contacts.prints)
    _darken(image, view.part, contacts.is_floor, light)


@njit(cache=True, fastmath=True)
def light_on_floor(lens: Lens, world_from_camera: Array, prints: Array) -> NDArray[np.float32]:
    """Return the share of light on the floor at every fourth pixel; 1 where the floor is not visible."""
    height, width = lens.height // _EVERY + 2, lens.width // _EVERY + 2
    light = np.ones((height, width), np.float32)
    x, y = np.full((height, width), _NOWHERE_M), np.full((height, width), _NOWHERE_M)
    pose, first, last = world_from_camera, height, -1
    for j in range(height):
        down = (_EVERY * j - lens.centre_v) / lens.focal
        for i in range(width):
            across = (_EVERY * i - lens.centre_u) / lens.focal
            fall = pose[2, 0] * across + pose[2, 1] * down + pose[2, 2]
            if fall * pose[2, 3] < 0.0:
                z = -pose[2, 3] / fall
                x[j, i] = (pose[0, 0] * across + pose[0, 1] * down + pose[0, 2]) * z + pose[0, 3]
                y[j, i] = (pose[1, 0] * across + pose[1, 1] * down + pose[1, 2]) * z + pose[1, 3]
                first, last = min(first, j), j
    for k in range(len(prints)):
        row = prints[k]
        left, top, right, bottom = _reached(row, lens, pose)
        for j in range(max(top, first), min(bottom, last) + 1):
            for i in range(left, right + 1):
                away = gap(row, x[j, i], y[j, i])
                if away < REACH_M:
                    light[j, i] *= 1.0 - lost_light(row, away)
    for j in range(first, last + 1):
        for i in range(width):
            light[j, i] = 1.0 - _ALL_AROUND * min(1.0 - light[j, i], _DEEPEST)
    return light


@njit(cache=True, error_model="numpy", fastmath=False)
def _reached(row: Array, lens: Lens, pose: Array) -> Rectangle:
    """Return the range of every fourth pixel in which a footprint (9,) may darken the floor."""
    reach = row[6] + REACH_M
    wide = row[4] * abs(row[2]) + row[5] * abs(row[3]) + reach
    deep = row[4] * abs(row[3]) + row[5] * abs(row[2]) + reach
    columns, rows = lens.width // _EVERY + 1, lens.height // _EVERY + 1
    left, top, right, bottom = float(columns), float(rows), 0.0, 0.0
    behind = beyond_left = beyond_right = above = below = 0
    for corner in range(4):
        x = row[0] + (wide if corner & 1 else -wide) - pose[0, 3]
        y = row[1] + (deep if corner & 2 else -deep) - pose[1, 3]
        z = pose[0, 2] * x + pose[1, 2] * y - pose[2, 2] * pose[2, 3]
        across = lens.focal * (pose[0, 0] * x + pose[1, 0] * y - pose[2, 0] * pose[2, 3]) + lens.centre_u * z
        down = lens.focal * (pose[0, 1] * x + pose[1, 1] * y - pose[2, 1] * pose[2, 3]) + lens.centre_v * z
        # Clips a footprint that is partly behind the camera, so that it is known to be beyond a side of the
        # image.
        beyond_left += across < 0.0
        beyond_right += across > _EVERY * columns * z
        above += down < 0.0
        below += down > _EVERY * rows * z
        behind += z < NEAR_M
        u, v = across / (_EVERY * z), down / (_EVERY * z)
        left, right = min(left, u), max(right, u)
        top, bottom = min(top, v), max(bottom, v)
    if max(behind, beyond_left, beyond_right, above, below) == 4:
        return 0, 0, -1, -1
    if behind > 0:
        return 0, 0, columns, rows
    return (
        max(math.ceil(left), 0), max(math.ceil(top), 0),
        min(math.floor(right), columns), min(math.floor(bottom), rows),
    )  # fmt: skip


@njit(cache=True, fastmath=True)
def _darken(
    image: NDArray[np.float32],
    part: NDArray[np.int32],
    is_floor: NDArray[np.bool_],
    light: NDArray[np.float32],
) -> None:
    height, width = part.shape
    step, full = np.float32(1.0 / _EVERY), np.float32(1.0)
    for j in range(light.shape[0] - 1):
        for i in range(light.shape[1] - 1):
            a, b, c, d = light[j, i], light[j, i + 1], light[j + 1, i], light[j + 1, i + 1]
            if min(min(a, b), min(c, d)) >= full:
                continue
            for v in range(_EVERY * j, min(_EVERY * j + _EVERY, height)):
                down = step * np.float32(v - _EVERY * j)
                one, slope = a + down * (c - a), step * (b - a + down * (d - c - b + a))
                for u in range(_EVERY * i, min(_EVERY * i + _EVERY, width)):
                    if part[v, u] >= 0 and is_floor[part[v, u]]:
                        share = one + slope * np.float32(u - _EVERY * i)
                        for channel in range(3):
                            image[v, u, channel] *= share


@njit(cache=True, fastmath=True)
def lost_light(row: Array, away: float) -> float:
    """Return the share of ambient light that a footprint (9,) blocks at a distance [m].

    An infinite wall of height h blocks (1 - d / sqrt(d^2 + h^2)) / 2 at a distance d. A narrow object blocks
    less with increasing distance, and an object above the floor blocks less with increasing height.
    """
    if away >= REACH_M:
        return 0.0
    high, low = row[8], max(row[7], 0.0) / _SLOWLY_M
    wide = _LEAST_WIDE_M + row[5] + row[6] + 0.5 * row[4]
    wall = 0.5 * (1.0 - away / math.sqrt(away * away + high * high))
    fade = 1.0 - away / REACH_M
    lost: float = wall * wide / (wide + away) * fade / (1.0 + low * low)
    return lost
