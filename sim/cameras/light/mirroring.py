"""What shiny surfaces mirror, added to an image that is linear in light or radiance."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.rendering.reflections import EVERY, Reflection
from peopleboy.sim.rendering.view import View

Image = NDArray[np.float32]


def add_reflections(
    image: Image,
    view: View,
    camera: Pinhole,
    world_from_part: Matrix,
    reflections: Sequence[Reflection],
    reflectance: NDArray[np.float64],
    shine: NDArray[np.float64],
    surroundings: NDArray[np.float64],
    draw: Callable[[View, Matrix], Image],
) -> None:
    """Add what shiny surfaces mirror, in place of the surroundings that they are taken to mirror otherwise.

    The share of light that is mirrored rises from normal to grazing by Schlick's approximation, times how
    shiny the surface is. What it emits or scatters itself stays as it is.

    Source: Schlick, An inexpensive BRDF model for physically-based rendering (1994), eq. 15.

    Args:
        image: (H, W, C).
        view: what each pixel sees.
        camera: the pinhole camera.
        world_from_part: (P, 4, 4).
        reflections: found in the same view.
        reflectance: (P,) of each part for rays along its normal.
        shine: (P,) of each part, 0..1.
        surroundings: (C,) what is mirrored otherwise.
        draw: gives the (h, w, C) image of a view by its part_from_pixel (P, 3, 4).
    """
    if view.surface is None:
        return
    for one in reflections:
        matrices = _part_from_pixel(
            camera.focal_px, camera.centre_px, one.left, one.top, one.world_from_camera, world_from_part
        )
        _mix(
            image, view.part, view.surface, one.is_surface, draw(one.view, matrices), one.view.part,
            one.cosine, one.left, one.top, reflectance, shine, surroundings,
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
    """Add to each pixel of a mirror what the window sees in it, linearly between the window's pixels."""
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
    """Leave what is seen beyond a mirror, less the surroundings; nothing where nothing is."""
    for v in range(mirrored.shape[0]):
        for u in range(mirrored.shape[1]):
            for c in range(mirrored.shape[2]):
                mirrored[v, u, c] = mirrored[v, u, c] - surroundings[c] if beyond[v, u] >= 0 else 0.0


@njit(cache=True, fastmath=True)
def mirrored_share(reflectance: float, cosine: float) -> float:
    """The share of light that a smooth surface mirrors, by that along its normal and the angle to it."""
    away = 1.0 - min(cosine, 1.0)
    square = away * away
    share: float = reflectance + (1.0 - reflectance) * square * square * away
    return share
