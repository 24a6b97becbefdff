"""What cameras of plain detail see in many worlds, from poses to images (numba kernels)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.blur import sweep_weights, weighted_sum
from peopleboy.sim.cameras.colour import encode, light_image
from peopleboy.sim.cameras.noise import look_up
from peopleboy.sim.cameras.surfaces import combine
from peopleboy.sim.cameras.thermal import radiance_image, to_apparent_c
from peopleboy.sim.fleet.scenery import Array, Scenery, scenery_of
from peopleboy.sim.fleet.side_by_side import Numbers
from peopleboy.sim.geometry.products import from_each, invert
from peopleboy.sim.rendering.canvas import Canvas, Lens, locate, shade
from peopleboy.sim.rendering.raycast import draw
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


class Radiators(NamedTuple):
    """Tables by which temperatures become radiance and back; see `radiance_image` and `to_apparent_c`."""

    radiance: Array
    span_c: tuple[float, float]
    temperature: Array
    span: tuple[float, float]


class Buffers(NamedTuple):
    """Space for what one camera sees, (H, W), as in `peopleboy.sim.rendering.view.View`."""

    part: NDArray[np.int32]
    depth: Image
    normal: Image


@njit(cache=True, nogil=True)
def radiate_worlds(
    first: int,
    end: int,
    worlds: Numbers,
    scenery: Scenery,
    poses: Poses,
    eye: Eye,
    tables: Radiators,
    surroundings: Array,
    radiance: Image,
) -> None:
    """Form thermal images before optics.

    Args:
        first: row of the first world of these.
        end: row after the last one.
        worlds: (G,) their numbers in the scenery.
        scenery: of all.
        poses: of all.
        eye: the camera, the same in all worlds.
        tables: of radiance.
        surroundings: (G,) radiance of what surfaces mirror.
        radiance: (G, H, W) rows first..end-1 are filled.
    """
    canvas, view = _space(eye.lens, scenery)
    for row in range(first, end):
        table, looks = scenery_of(scenery, worlds[row])
        matrices = _look(worlds[row], row, table, scenery.part, poses, eye, canvas)
        locate(table.surface_part, eye.lens, canvas, view.part, view.depth)
        radiance[row] = radiance_image(
            view.part, view.depth, matrices, looks.thermal, looks.kind, looks.period, looks.phase,
            looks.finish, looks.texels, looks.paint, looks.paint_texels, tables.radiance, surroundings[row],
            tables.span_c,
        )  # fmt: skip


class Detectors(NamedTuple):
    """The thermal detectors of B worlds, and what they make of an image.

    Attributes:
        offset_k, dead: (B, H, W) as in `peopleboy.sim.cameras.thermal.Detector`.
        dead_c: [degC].
        netd_k: [K].
        lowest_c: [degC] of grey 0.
        grey_per_k: how many greys a kelvin has.
    """

    offset_k: Image
    dead: NDArray[np.bool_]
    dead_c: np.float32
    netd_k: np.float32
    lowest_c: np.float32
    grey_per_k: np.float32


@njit(cache=True, nogil=True)
def detect_worlds(
    first: int,
    end: int,
    worlds: Numbers,
    radiance: Image,
    eye: Eye,
    turned: Array,
    tables: Radiators,
    detectors: Detectors,
    quantiles: Image,
    words: NDArray[np.uint64],
    temperature_c: Image,
    grey: NDArray[np.uint8],
) -> None:
    """Make thermal images of radiance behind the optics.

    Args:
        first: row of the first world of these.
        end: row after the last one.
        worlds: (G,) their numbers.
        radiance: (G, H, W), what is read of it is lost.
        eye: the camera.
        turned: (G,) [rad] as in `Poses`.
        tables: of radiance.
        detectors: of all worlds.
        quantiles: of the noise.
        words: (G, N) random.
        temperature_c: (G, H, W) [degC] rows first..end-1 are filled.
        grey: (G, H, W) likewise.
    """
    height, width = radiance.shape[1:]
    noise = np.empty(height * width, np.float32)
    black, white = np.float32(0.0), np.float32(255.0)
    for row in range(first, end):
        apparent = _smear(radiance[row], eye.sweep, turned[row], 1)
        to_apparent_c(apparent, tables.temperature, tables.span[0], tables.span[1])
        look_up(quantiles, words[row], noise)
        seen, found, greys = apparent.reshape(-1), temperature_c[row].reshape(-1), grey[row].reshape(-1)
        offset_k = detectors.offset_k[worlds[row]].reshape(-1)
        dead = detectors.dead[worlds[row]].reshape(-1)
        for i in range(height * width):
            read = noise[i] * detectors.netd_k + seen[i] + offset_k[i]
            found[i] = detectors.dead_c if dead[i] else read
        for i in range(height * width):
            value = np.rint((found[i] - detectors.lowest_c) * detectors.grey_per_k)
            greys[i] = np.uint8(min(max(value, black), white))


class Film(NamedTuple):
    """How a colour camera exposes: gain, and noise as in `LightConfig`; (3,) direction of the light."""

    read_noise: np.float32
    shot_noise: np.float32
    light: Array
    gamma: NDArray[np.uint8]


@njit(cache=True, nogil=True)
def expose_worlds(
    first: int,
    end: int,
    worlds: Numbers,
    scenery: Scenery,
    poses: Poses,
    eye: Eye,
    film: Film,
    level: Array,
    quantiles: Image,
    words: NDArray[np.uint64],
    image: NDArray[np.uint8],
) -> None:
    """Make colour images, as `radiate_worlds` and `detect_worlds` make thermal ones.

    Args:
        first: row of the first world of these.
        end: row after the last one.
        worlds: (G,) their numbers in the scenery.
        scenery: of all.
        poses: of all.
        eye: the camera, the same in all worlds.
        film: how it exposes.
        level: (G,) of the light, times the camera's gain.
        quantiles: of the noise.
        words: (G, N) random.
        image: (G, H, W, 3) rows first..end-1 are filled.
    """
    canvas, view = _space(eye.lens, scenery)
    noise = np.empty((eye.lens.height, eye.lens.width, 3), np.float32)
    for row in range(first, end):
        table, looks = scenery_of(scenery, worlds[row])
        matrices = _look(worlds[row], row, table, scenery.part, poses, eye, canvas)
        rotation = np.ascontiguousarray(poses.camera[row, :3, :3])
        shade(table.surface_part, eye.lens, canvas, rotation, view.part, view.depth, view.normal)
        linear = light_image(
            view.part, view.depth, view.normal, matrices, looks.colour, looks.kind, looks.period, looks.phase,
            looks.finish, looks.texels, looks.paint, looks.paint_texels, film.light, level[row],
        )  # fmt: skip
        lines = linear.reshape(eye.lens.height, 3 * eye.lens.width)
        smeared = _smear(lines, eye.sweep, poses.turned[row], 3)
        look_up(quantiles, words[row], noise.reshape(-1))
        image[row] = encode(smeared.reshape(noise.shape), noise, film.gamma, film.read_noise, film.shot_noise)


@njit(cache=True)
def _space(lens: Lens, scenery: Scenery) -> tuple[Canvas, Buffers]:
    """Space for one image after the other."""
    shape, surfaces = (lens.height, lens.width), 0
    for world in range(len(scenery.surface) - 1):
        surfaces = max(surfaces, scenery.surface[world + 1] - scenery.surface[world])
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
def _look(
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
def _smear(lines: Image, sweep_of_one_rad: Array, turned_rad: float, channels: int) -> Image:
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
