"""Thermal and colour images of cameras of plain detail in many worlds (numba kernels)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.colour import encode, light_image
from peopleboy.sim.cameras.imaging.blur import sweep_weights, weighted_sum
from peopleboy.sim.cameras.imaging.camera_view import MaterialTable
from peopleboy.sim.cameras.imaging.noise import look_up
from peopleboy.sim.cameras.imaging.surfaces import combine
from peopleboy.sim.cameras.thermal import radiance_image, to_apparent_c
from peopleboy.sim.geometry.vectors import from_each, invert
from peopleboy.sim.rendering.raycast import draw
from peopleboy.sim.rendering.render_canvas import Canvas, Lens, locate, make_canvas, shade
from peopleboy.sim.shapes.shape_table import JoinedTables, Numbers, ShapeTable, ends, join_tables, table_of

Array = NDArray[np.float64]


class JoinedScene(NamedTuple):
    """Joined scenes of B worlds; indices within them are those of each single world.

    Attributes:
        tables: visible shapes of all worlds.
        materials: of their parts; in plain detail none has a texture.
        part: (B + 1,) where each world's parts begin, and where the last end.
    """

    tables: JoinedTables
    materials: MaterialTable
    part: Numbers


def join_scenes(tables: Sequence[ShapeTable], materials: Sequence[MaterialTable]) -> JoinedScene:
    """Copy tables and materials of worlds of plain detail into joint arrays."""
    joined = materials[0]._replace(
        **{name: np.concatenate([getattr(each, name) for each in materials]) for name in _OF_PARTS}
    )
    return JoinedScene(join_tables(tables), joined, ends([len(each.thermal) for each in materials]))


_OF_PARTS = ("thermal", "colour", "kind", "period", "phase", "shine")


@njit(cache=True, nogil=True)
def materials_of(scene: JoinedScene, world: int) -> MaterialTable:
    """Return the materials of the parts of one world."""
    materials, p, p_end = scene.materials, scene.part[world], scene.part[world + 1]
    return MaterialTable(
        materials.thermal[p:p_end],
        materials.colour[p:p_end],
        materials.kind[p:p_end],
        materials.period[p:p_end],
        materials.phase[p:p_end],
        materials.finish,
        materials.texels,
        materials.shine[p:p_end],
        materials.paint,
        materials.paint_texels,
    )


Image = NDArray[np.float32]
_LEAST_SWEEP_PX = 0.05  # as in `rotation_blur`


class Poses(NamedTuple):
    """Poses of all visible parts.

    Attributes:
        part: (P, 4, 4) world from part, of all worlds of a `JoinedScene`.
        hidden: (P,) parts that are not there.
        camera: (G, 4, 4) world from camera, of G of the worlds.
        turned: (G,) [rad] by which each has turned about the vertical axis during the exposure.
    """

    part: Array
    hidden: NDArray[np.bool_]
    camera: Array
    turned: Array


class KernelCamera(NamedTuple):
    """A pinhole camera in the format of the kernels.

    Attributes:
        lens: where its pixels look.
        rays: (3, 3) as `rays_through` gives it.
        sweep: (W,) [px] of each column for a turn by 1 rad.
    """

    lens: Lens
    rays: Array
    sweep: Array


class ViewBatch(NamedTuple):
    """The views of G worlds' cameras, one each, with equal settings.

    Attributes:
        worlds: (G,) numbers of the worlds in the scene.
        scene: of all worlds.
        poses: where all is, and the cameras.
        camera: the one of every world.
    """

    worlds: Numbers
    scene: JoinedScene
    poses: Poses
    camera: KernelCamera


class Buffers(NamedTuple):
    """Space for what one camera sees, (H, W), as in `peopleboy.sim.rendering.view.View`."""

    part: NDArray[np.int32]
    depth: Image
    normal: Image


@njit(cache=True)
def make_buffers(lens: Lens, scene: JoinedScene) -> tuple[Canvas, Buffers]:
    """Return buffers that are reused for each image."""
    shape, surfaces, first = (lens.height, lens.width), 0, scene.tables.surface
    for world in range(len(first) - 1):
        surfaces = max(surfaces, first[world + 1] - first[world])
    return make_canvas(lens, surfaces), Buffers(
        np.empty(shape, np.int32), np.empty(shape, np.float32), np.empty((*shape, 3), np.float32)
    )


@njit(cache=True)
def render_view(views: ViewBatch, row: int, table: ShapeTable, canvas: Canvas) -> Array:
    """Draw the shapes of one world; returns the matrices of `part_from_pixel`."""
    world, poses = views.worlds[row], views.poses
    first, end = views.scene.part[world], views.scene.part[world + 1]
    parts, camera = poses.part[first:end], poses.camera[row]
    camera_from_world = np.empty((4, 4))
    invert(camera, camera_from_world)
    no_person = np.zeros(end - first, np.uint64)
    canvas.nearness[:] = 0.0
    lens, hidden = views.camera.lens, poses.hidden[first:end]
    draw(table, from_each(camera_from_world, parts), hidden, no_person, lens, canvas)
    return combine(views.camera.rays, camera, parts)


@njit(cache=True)
def blur_by_rotation(lines: Image, sweep_of_one_rad: Array, turned_rad: float, channels: int) -> Image:
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


class ColourResponse(NamedTuple):
    """Exposure of a colour camera.

    Attributes:
        read_noise, shot_noise: as in `LightConfig`.
        quantiles: of the noise.
        light: (3,) direction of the light.
        gamma: table from linear values to sRGB.
    """

    read_noise: np.float32
    shot_noise: np.float32
    quantiles: Image
    light: Array
    gamma: NDArray[np.uint8]


@njit(cache=True, nogil=True)
def render_colour(
    first: int,
    end: int,
    views: ViewBatch,
    response: ColourResponse,
    level: Array,
    words: NDArray[np.uint64],
    image: NDArray[np.uint8],
) -> None:
    """Render colour images, as `render_radiance` and `detect_thermal` do thermal ones.

    Args:
        first: row of the first world of these.
        end: row after the last one.
        views: of all worlds.
        response: how the camera exposes.
        level: (G,) of the light, times the camera's gain.
        words: (end - first, N) random, of these rows.
        image: (G, H, W, 3) rows first..end-1 are filled.
    """
    lens, scene = views.camera.lens, views.scene
    canvas, view = make_buffers(lens, scene)
    noise = np.empty((lens.height, lens.width, 3), np.float32)
    for row in range(first, end):
        table, own = table_of(scene.tables, views.worlds[row]), materials_of(scene, views.worlds[row])
        matrices = render_view(views, row, table, canvas)
        rotation = np.ascontiguousarray(views.poses.camera[row, :3, :3])
        shade(table.surface_part, lens, canvas, rotation, view.part, view.depth, view.normal)
        linear = light_image(
            view.part, view.depth, view.normal, matrices, own, response.light, level[row],
        )  # fmt: skip
        lines = linear.reshape(lens.height, 3 * lens.width)
        smeared = blur_by_rotation(lines, views.camera.sweep, views.poses.turned[row], 3)
        look_up(response.quantiles, words[row - first], noise.reshape(-1))
        coded = encode(
            smeared.reshape(noise.shape), noise, response.gamma, response.read_noise, response.shot_noise
        )
        source, target = coded.reshape(-1), image[row].reshape(-1)
        for i in range(len(target)):
            target[i] = source[i]


class RadianceTables(NamedTuple):
    """Tables from temperature to radiance and back; see `radiance_image` and `to_apparent_c`."""

    radiance: Array
    span_c: tuple[float, float]
    temperature: Array
    span: tuple[float, float]


@njit(cache=True, nogil=True)
def render_radiance(
    first: int,
    end: int,
    views: ViewBatch,
    tables: RadianceTables,
    surroundings: Array,
    margin: int,
    sheet: Image,
) -> None:
    """Form thermal images before optics.

    Args:
        first: row of the first world of these.
        end: row after the last one.
        views: of all worlds.
        tables: of radiance.
        surroundings: (G,) radiance of what surfaces mirror.
        margin: M rows above and below each image.
        sheet: (end - first, H + 2 M, W) is filled, with those rows as `optics_blur_sheet` wants them.
    """
    lens, scene = views.camera.lens, views.scene
    canvas, view = make_buffers(lens, scene)
    for row in range(first, end):
        table, own = table_of(scene.tables, views.worlds[row]), materials_of(scene, views.worlds[row])
        matrices = render_view(views, row, table, canvas)
        locate(table.surface_part, lens, canvas, view.part, view.depth)
        radiance = sheet[row - first]
        image = radiance_image(
            view.part, view.depth, matrices, own, tables.radiance, surroundings[row], tables.span_c,
        )  # fmt: skip
        for v in range(len(radiance)):
            from_row = min(max(v - margin, 0), lens.height - 1)
            for u in range(lens.width):
                radiance[v, u] = image[from_row, u]


class Detectors(NamedTuple):
    """The thermal detectors of B worlds.

    Attributes:
        offset_k, dead: (B, H, W) as in `peopleboy.sim.cameras.thermal.Detector`.
        dead_c: [degC].
        netd_k: [K].
        lowest_c: [degC] of grey 0.
        grey_per_k: how many greys a kelvin has.
        quantiles: of the noise.
    """

    offset_k: Image
    dead: NDArray[np.bool_]
    dead_c: np.float32
    netd_k: np.float32
    lowest_c: np.float32
    grey_per_k: np.float32
    quantiles: Image


@njit(cache=True, nogil=True)
def detect_thermal(
    first: int,
    end: int,
    views: ViewBatch,
    tables: RadianceTables,
    detectors: Detectors,
    margin: int,
    sheet: Image,
    words: NDArray[np.uint64],
    temperature_c: Image,
    grey: NDArray[np.uint8],
) -> None:
    """Make thermal images from radiance behind the optics.

    Args:
        first: row of the first world of these.
        end: row after the last one.
        views: of all worlds.
        tables: of radiance.
        detectors: of all worlds.
        margin: M rows above and below each image.
        sheet: (end - first, H + 2 M, W), what is read of it is lost.
        words: (end - first, N) random, of these rows.
        temperature_c: (G, H, W) [degC] rows first..end-1 are filled.
        grey: (G, H, W) likewise.
    """
    height, width = temperature_c.shape[1:]
    noise = np.empty(height * width, np.float32)
    black, white = np.float32(0.0), np.float32(255.0)
    for row in range(first, end):
        lines, turned_rad = sheet[row - first][margin : margin + height], views.poses.turned[row]
        apparent = blur_by_rotation(lines, views.camera.sweep, turned_rad, 1)
        to_apparent_c(apparent, tables.temperature, tables.span[0], tables.span[1])
        look_up(detectors.quantiles, words[row - first], noise)
        seen, found, greys = apparent.reshape(-1), temperature_c[row].reshape(-1), grey[row].reshape(-1)
        offset_k = detectors.offset_k[views.worlds[row]].reshape(-1)
        dead = detectors.dead[views.worlds[row]].reshape(-1)
        for i in range(height * width):
            read = noise[i] * detectors.netd_k + seen[i] + offset_k[i]
            found[i] = detectors.dead_c if dead[i] else read
        for i in range(height * width):
            value = np.rint((found[i] - detectors.lowest_c) * detectors.grey_per_k)
            greys[i] = np.uint8(min(max(value, black), white))
