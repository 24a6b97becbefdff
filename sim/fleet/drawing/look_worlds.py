"""What cameras of plain detail look at in many worlds (numba kernels)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.blur import sweep_weights, weighted_sum
from peopleboy.sim.cameras.surfaces import combine
from peopleboy.sim.fleet.drawing.scenery import Array, Scenery
from peopleboy.sim.geometry.products import from_each, invert
from peopleboy.sim.rendering.canvas import Canvas, Lens
from peopleboy.sim.rendering.raycast import draw
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.shapes.shape_table import ShapeTable

Image = NDArray[np.float32]
_LEAST_SWEEP_PX = 0.05  # as in `rotation_blur`


class Poses(NamedTuple):
    """Where all is that is to be seen.

    Attributes:
        part: (P, 4, 4) world from part, of all worlds of a `Scenery`.
        hidden: (P,) parts that are not there.
        camera: (G, 4, 4) world from camera, of G of the worlds.
        turned: (G,) [rad] by which each has turned about the vertical axis during the exposure.
    """

    part: Array
    hidden: NDArray[np.bool_]
    camera: Array
    turned: Array


class Eye(NamedTuple):
    """A pinhole camera as kernels take it.

    Attributes:
        lens: where its pixels look.
        rays: (3, 3) as `rays_through` gives it.
        sweep: (W,) [px] of each column for a turn by 1 rad.
    """

    lens: Lens
    rays: Array
    sweep: Array


class Buffers(NamedTuple):
    """Space for what one camera sees, (H, W), as in `peopleboy.sim.rendering.view.View`."""

    part: NDArray[np.int32]
    depth: Image
    normal: Image


@njit(cache=True)
def open_space(lens: Lens, scenery: Scenery) -> tuple[Canvas, Buffers]:
    """Space for one image after the other."""
    shape, surfaces, first = (lens.height, lens.width), 0, scenery.tables.surface
    for world in range(len(first) - 1):
        surfaces = max(surfaces, first[world + 1] - first[world])
    canvas = Canvas(
        np.zeros(shape),
        np.empty(shape, np.int32),
        np.zeros(shape, np.uint64),
        np.empty((surfaces, 7)),
        np.empty((6, 3)),
        np.empty((3, 4)),
    )
    return canvas, Buffers(
        np.empty(shape, np.int32), np.empty(shape, np.float32), np.empty((*shape, 3), np.float32)
    )


@njit(cache=True)
def look_into(
    world: int,
    row: int,
    table: ShapeTable,
    first_part: Numbers,
    poses: Poses,
    eye: Eye,
    canvas: Canvas,
) -> Array:
    """Draw one world; gives the matrices of `part_from_pixel`."""
    first, end = first_part[world], first_part[world + 1]
    parts, camera = poses.part[first:end], poses.camera[row]
    camera_from_world = np.empty((4, 4))
    invert(camera, camera_from_world)
    nobody = np.zeros(end - first, np.uint64)
    canvas.nearness[:] = 0.0
    draw(table, from_each(camera_from_world, parts), poses.hidden[first:end], nobody, eye.lens, canvas)
    return combine(eye.rays, camera, parts)


@njit(cache=True)
def smear(lines: Image, sweep_of_one_rad: Array, turned_rad: float, channels: int) -> Image:
    """Do as `rotation_blur` with (H, W C) lines of an image."""
    sweep = sweep_of_one_rad * abs(turned_rad)
    if sweep.max() < _LEAST_SWEEP_PX:
        return lines
    own = sweep_weights(sweep)
    weights = np.empty((own.shape[0], own.shape[1] * channels), np.float32)
    for k in range(own.shape[0]):
        for u in range(own.shape[1]):
            weights[k, channels * u : channels * (u + 1)] = own[k, u]
    return weighted_sum(lines, weights, channels)
