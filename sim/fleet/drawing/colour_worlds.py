"""Colour images of many worlds, from poses to sRGB (numba kernels)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.colour import encode, light_image
from peopleboy.sim.cameras.noise import look_up
from peopleboy.sim.fleet.drawing.look_worlds import Eye, Image, Poses, look_into, open_space, smear
from peopleboy.sim.fleet.drawing.scenery import Array, Scenery, looks_of
from peopleboy.sim.rendering.canvas import shade
from peopleboy.sim.shapes.joined_tables import Numbers, table_of


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
        words: (end - first, N) random, of these rows.
        image: (G, H, W, 3) rows first..end-1 are filled.
    """
    canvas, view = open_space(eye.lens, scenery)
    noise = np.empty((eye.lens.height, eye.lens.width, 3), np.float32)
    for row in range(first, end):
        table, looks = table_of(scenery.tables, worlds[row]), looks_of(scenery, worlds[row])
        matrices = look_into(worlds[row], row, table, scenery.part, poses, eye, canvas)
        rotation = np.ascontiguousarray(poses.camera[row, :3, :3])
        shade(table.surface_part, eye.lens, canvas, rotation, view.part, view.depth, view.normal)
        linear = light_image(
            view.part, view.depth, view.normal, matrices, looks.colour, looks.kind, looks.period, looks.phase,
            looks.finish, looks.texels, looks.paint, looks.paint_texels, film.light, level[row],
        )  # fmt: skip
        lines = linear.reshape(eye.lens.height, 3 * eye.lens.width)
        smeared = smear(lines, eye.sweep, poses.turned[row], 3)
        look_up(quantiles, words[row - first], noise.reshape(-1))
        coded = encode(smeared.reshape(noise.shape), noise, film.gamma, film.read_noise, film.shot_noise)
        source, target = coded.reshape(-1), image[row].reshape(-1)
        for i in range(len(target)):
            target[i] = source[i]
