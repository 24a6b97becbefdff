"""Thermal images of many worlds, from poses to greys (numba kernels)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.noise import look_up
from peopleboy.sim.cameras.thermal import radiance_image, to_apparent_c
from peopleboy.sim.fleet.drawing.look_worlds import Eye, Image, Poses, look_into, open_space, smear
from peopleboy.sim.fleet.drawing.scenery import Array, Scenery, looks_of
from peopleboy.sim.rendering.canvas import locate
from peopleboy.sim.shapes.joined_tables import Numbers, table_of


class Radiators(NamedTuple):
    """Tables by which temperatures become radiance and back; see `radiance_image` and `to_apparent_c`."""

    radiance: Array
    span_c: tuple[float, float]
    temperature: Array
    span: tuple[float, float]


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
    margin: int,
    sheet: Image,
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
        margin: M rows above and below each image.
        sheet: (end - first, H + 2 M, W) is filled, with those rows as `optics_blur_sheet` wants them.
    """
    canvas, view = open_space(eye.lens, scenery)
    for row in range(first, end):
        table, looks = table_of(scenery.tables, worlds[row]), looks_of(scenery, worlds[row])
        matrices = look_into(worlds[row], row, table, scenery.part, poses, eye, canvas)
        locate(table.surface_part, eye.lens, canvas, view.part, view.depth)
        radiance = sheet[row - first]
        image = radiance_image(
            view.part, view.depth, matrices, looks.thermal, looks.kind, looks.period, looks.phase,
            looks.finish, looks.texels, looks.paint, looks.paint_texels, tables.radiance, surroundings[row],
            tables.span_c,
        )  # fmt: skip
        for v in range(len(radiance)):
            from_row = min(max(v - margin, 0), eye.lens.height - 1)
            for u in range(eye.lens.width):
                radiance[v, u] = image[from_row, u]


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
    margin: int,
    sheet: Image,
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
        margin: M rows above and below each image.
        sheet: (end - first, H + 2 M, W), what is read of it is lost.
        eye: the camera.
        turned: (G,) [rad] as in `Poses`.
        tables: of radiance.
        detectors: of all worlds.
        quantiles: of the noise.
        words: (end - first, N) random, of these rows.
        temperature_c: (G, H, W) [degC] rows first..end-1 are filled.
        grey: (G, H, W) likewise.
    """
    height, width = temperature_c.shape[1:]
    noise = np.empty(height * width, np.float32)
    black, white = np.float32(0.0), np.float32(255.0)
    for row in range(first, end):
        apparent = smear(sheet[row - first][margin : margin + height], eye.sweep, turned[row], 1)
        to_apparent_c(apparent, tables.temperature, tables.span[0], tables.span[1])
        look_up(quantiles, words[row - first], noise)
        seen, found, greys = apparent.reshape(-1), temperature_c[row].reshape(-1), grey[row].reshape(-1)
        offset_k = detectors.offset_k[worlds[row]].reshape(-1)
        dead = detectors.dead[worlds[row]].reshape(-1)
        for i in range(height * width):
            read = noise[i] * detectors.netd_k + seen[i] + offset_k[i]
            found[i] = detectors.dead_c if dead[i] else read
        for i in range(height * width):
            value = np.rint((found[i] - detectors.lowest_c) * detectors.grey_per_k)
            greys[i] = np.uint8(min(max(value, black), white))
