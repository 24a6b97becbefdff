"""Formation of colour images: diffuse shading, patterned surfaces, variable light, sensor noise."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.camera_config import ColourConfig, DepthConfig, LightConfig
from peopleboy.sim.cameras.imaging.blur import rotation_blur
from peopleboy.sim.cameras.imaging.camera_view import LIGHT_STEP, CameraView, MaterialTable
from peopleboy.sim.cameras.imaging.lighting import add_contact_shadows, add_reflections
from peopleboy.sim.cameras.imaging.noise import gaussian
from peopleboy.sim.cameras.imaging.surfaces import (
    PixelRun,
    finish_run,
    paint_run,
    part_from_pixel,
    pattern_value,
    surface_point,
)
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.materials import TEXEL_STEP

# Lamps are overhead and slightly to one side, so that walls and the sides of people differ in shade.
LIGHT = np.array([0.35, 0.25, 0.90]) / np.linalg.norm([0.35, 0.25, 0.90])
_AMBIENT = 0.55

_GLASS = 0.04  # reflectance of glass and varnish at normal incidence, for a refractive index of 1.5
_CHUNK = 640  # values that are encoded together, for vectorisation
_CONTRAST = 0.06  # share of the light; weaker edges are not smoothed
_ROOM = 0.4  # reflected surroundings, as a share of the light


@njit(cache=True, fastmath=True, forceinline=True)
def _is_second(
    v: int,
    u: int,
    p: int,
    depths: NDArray[np.float32],
    matrices: NDArray[np.float64],
    materials: MaterialTable,
) -> bool:
    """Return whether the pattern of a part has its second colour at a pixel."""
    x, y, z = surface_point(matrices, p, u, v, depths[u])
    kind, period = materials.kind[p, 1], materials.period[p, 1]
    return pattern_value(kind, period, x, y, z, materials.phase, p) == 1


@njit(cache=True, fastmath=True, forceinline=True)
def _cover_run(
    image: NDArray[np.float32],
    factor: NDArray[np.float32],
    is_second: NDArray[np.bool_],
    places: NDArray[np.uint32],
    first: int,
    end: int,
    own: NDArray[np.float64],
    other: NDArray[np.float64],
    texels: NDArray[np.int16],
) -> None:
    """Fill neighbouring pixels of a part with a finish, in the part's colours (6,) and the finish's (3,)."""
    one, two, three, step = np.uint64(1), np.uint64(2), np.uint64(3), np.float32(TEXEL_STEP)
    other_red, other_green, other_blue = np.float32(other[0]), np.float32(other[1]), np.float32(other[2])
    for u in range(first, end):
        c = 3 if is_second[u] else 0
        red, green, blue = np.float32(own[c]), np.float32(own[c + 1]), np.float32(own[c + 2])
        texel = texels[places[u]]
        shade, cover = factor[u] * (step * np.float32(texel[1])), step * np.float32(texel[2])
        i = three * np.uint64(u)
        image[i] = shade * (red + cover * (other_red - red))
        image[i + one] = shade * (green + cover * (other_green - green))
        image[i + two] = shade * (blue + cover * (other_blue - blue))


@njit(cache=True, fastmath=True)
def _light_row(
    image: NDArray[np.float32],
    factor: NDArray[np.float32],
    is_second: NDArray[np.bool_],
    places: NDArray[np.uint32],
    v: int,
    part: NDArray[np.int32],
    depths: NDArray[np.float32],
    normal: NDArray[np.float32],
    matrices: NDArray[np.float64],
    materials: MaterialTable,
    light: NDArray[np.float64],
    level: float,
) -> None:
    """Fill a row (3 W,) in full detail, neighbouring pixels of one part together; normals are (3 W,), too.

    With flat rows the compiler knows the stride of pixels, and vectorises the loop.
    """
    colour, kind, finish, texels = materials.colour, materials.kind, materials.finish, materials.texels
    paint, paint_texels = materials.paint, materials.paint_texels
    width = len(part)
    end: int = np.int64(0)  # type: ignore[assignment]  # called with a literal, kernels would be compiled for it, too
    x, y, z = np.float32(light[0]), np.float32(light[1]), np.float32(light[2])
    direct, none = np.float32(level * (1.0 - _AMBIENT)), np.float32(0.0)
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    has_finish, has_paint = len(finish) > 0, paint_texels.shape[1] > 0
    while end < width:
        first, p = end, part[end]
        while end < width and part[end] == p:
            end += 1
        if p < 0:
            continue
        run = PixelRun(first, end, p, v, depths, matrices)
        around, factor[first:end] = np.float32(level * _AMBIENT + colour[p, 6]), np.float32(1.0)
        if has_paint and paint[p, 0] >= 0.0:
            paint_run(factor, run, paint, paint_texels[1], LIGHT_STEP)
        for u in range(first, end):
            i = three * np.uint64(u)
            facing = max(normal[i] * x + normal[i + one] * y + normal[i + two] * z, none)
            factor[u] *= around + direct * facing
        is_second[first:end] = False
        if kind[p, 1] != 0:
            for u in range(first, end):
                is_second[u] = _is_second(v, u, p, depths, matrices, materials)
        if has_finish and finish[p, 0] >= 0.0:
            finish_run(places, run, finish)
            _cover_run(image, factor, is_second, places, first, end, colour[p], finish[p, 5:], texels)
            continue
        red, green, blue = np.float32(colour[p, 0]), np.float32(colour[p, 1]), np.float32(colour[p, 2])
        redder, greener = np.float32(colour[p, 3]) - red, np.float32(colour[p, 4]) - green
        bluer = np.float32(colour[p, 5]) - blue
        for u in range(first, end):
            i, shade, share = three * np.uint64(u), factor[u], np.float32(is_second[u])
            image[i] = shade * (red + share * redder)
            image[i + one] = shade * (green + share * greener)
            image[i + two] = shade * (blue + share * bluer)


@njit(cache=True, fastmath=True)
def light_image(
    part: NDArray[np.int32],
    depth: NDArray[np.float32],
    normal: NDArray[np.float32],
    matrices: NDArray[np.float64],
    materials: MaterialTable,
    light: NDArray[np.float64],
    level: float,
) -> NDArray[np.float32]:
    """Form the linear image (H, W, 3) of a `View`, with the materials of a `MaterialTable`.

    The matrices are those of `part_from_pixel`. The light has a direction (3,), and a level times the
    camera's gain.
    """
    height, width = part.shape
    image = np.zeros((height, width, 3), np.float32)
    if len(materials.finish) > 0 or materials.paint_texels.shape[1] > 0:
        rows, normals = image.reshape(height, 3 * width), normal.reshape(height, 3 * width)
        factor, places = np.empty(width, np.float32), np.empty(width, np.uint32)
        is_second = np.empty(width, np.bool_)
        for v in range(height):
            _light_row(
                rows[v], factor, is_second, places, v, part[v], depth[v], normals[v], matrices, materials,
                light, level,
            )  # fmt: skip
        return image
    # Plain detail uses 64-bit arithmetic, and full detail 32-bit vectors: the last bits differ, so they need
    # separate row kernels.
    shades = np.empty(width)
    rows, normals = image.reshape(height, 3 * width), normal.reshape(height, 3 * width)
    for v in range(height):
        _light_plain_row(rows[v], shades, v, part[v], depth[v], normals[v], matrices, materials, light, level)
    return image


@njit(cache=True, fastmath=True)
def _light_plain_row(
    image: NDArray[np.float32],
    shades: NDArray[np.float64],
    v: int,
    part: NDArray[np.int32],
    depths: NDArray[np.float32],
    normal: NDArray[np.float32],
    matrices: NDArray[np.float64],
    materials: MaterialTable,
    light: NDArray[np.float64],
    level: float,
) -> None:
    """Fill a row (3 W,) in plain detail, neighbouring pixels of one part together; `shades` is a buffer."""
    colour, kind = materials.colour, materials.kind
    width, end = len(part), 0
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    x, y, z = light[0], light[1], light[2]
    while end < width:
        first, p = end, part[end]
        while end < width and part[end] == p:
            end += 1
        if p < 0:
            continue
        for u in range(np.uint64(first), np.uint64(end)):
            i = three * u
            facing = normal[i] * x + normal[i + one] * y + normal[i + two] * z
            shades[u] = level * (_AMBIENT + (1.0 - _AMBIENT) * max(facing, 0.0)) + colour[p, 6]
        red, green, blue = colour[p, 0], colour[p, 1], colour[p, 2]
        for u in range(np.uint64(first), np.uint64(end)):
            i, shade = three * u, shades[u]
            image[i], image[i + one], image[i + two] = shade * red, shade * green, shade * blue
        if kind[p, 1] != 0:
            for u in range(first, end):
                if _is_second(v, u, p, depths, matrices, materials):
                    for c in range(3):
                        image[3 * u + c] = shades[u] * colour[p, 3 + c]


@njit(cache=True, fastmath=True)
def shade_of(normal: NDArray[np.float32], light: NDArray[np.float64], level: float) -> float:
    """Return the irradiance of a surface with a normal (3,), for a light of a level from a direction (3,)."""
    facing = normal[0] * light[0] + normal[1] * light[1] + normal[2] * light[2]
    shade: float = level * (_AMBIENT + (1.0 - _AMBIENT) * max(facing, 0.0))
    return shade


def _gamma_table() -> NDArray[np.uint8]:
    """Return the 8-bit code of 4096 linear levels 0..1, by the sRGB transfer curve (IEC 61966-2-1)."""
    linear = np.linspace(0.0, 1.0, 4096)
    coded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.rint(coded * 255.0).astype(np.uint8)


GAMMA = _gamma_table()


def colour_image(seen: CameraView, config: ColourConfig | DepthConfig) -> NDArray[np.float32]:
    """Form the noise-free image (H, W, 3) in linear light with full scale 1, for a camera and its gain.

    Full detail adds contact shadows on the floor, reflections in shiny surfaces, and smooth edges.
    """
    level, camera, materials = seen.light_level * config.gain, config.camera, seen.materials

    def draw(one: View, matrices: Matrix) -> NDArray[np.float32]:
        return light_image(one.part, one.depth, one.normal, matrices, materials, LIGHT, level)

    image = draw(seen.view, part_from_pixel(camera, seen.world_from_camera, seen.world_from_part))
    if seen.full_detail is not None:
        add_contact_shadows(image, seen.view, camera, seen.world_from_camera, seen.full_detail.contacts)
        reflectance, surroundings = np.full(len(materials.shine), _GLASS), np.full(3, _ROOM * level)
        add_reflections(image, seen, camera, reflectance, surroundings, draw)
        seen.full_detail.smooth(image, _CONTRAST * level)
    return rotation_blur(image, camera, seen.turn_rad_s * config.exposure_s)


def expose(linear: NDArray[np.float32], config: LightConfig, rng: np.random.Generator) -> NDArray[np.uint8]:
    """Add read and shot noise to an (H, W, 3) linear image and encode it as 8-bit sRGB."""
    noise = gaussian(linear.shape, rng)
    return encode(linear, noise, GAMMA, np.float32(config.read_noise), np.float32(config.shot_noise))


@njit(cache=True, fastmath=True)
def encode(
    linear: NDArray[np.float32],
    noise: NDArray[np.float32],
    gamma: NDArray[np.uint8],
    read: np.float32,
    shot: np.float32,
) -> NDArray[np.uint8]:
    """Add read and shot noise to an (H, W, 3) linear image from normal draws, and encode it with `GAMMA`."""
    image, codes = np.empty(linear.shape, np.uint8), np.empty(_CHUNK, np.int32)
    source, random, target = linear.reshape(-1), noise.reshape(-1), image.reshape(-1)
    last = np.float32(gamma.shape[0] - 1)
    half, none, full = np.float32(0.5), np.float32(0.0), np.float32(1.0)
    for first in range(0, source.shape[0], _CHUNK):
        light, draws, coded = source[first:], random[first:], target[first:]
        count = min(_CHUNK, len(light))
        for i in range(count):
            sigma = np.sqrt(read * read + shot * shot * light[i])
            level = min(max(light[i] + sigma * draws[i], none), full)
            codes[i] = np.int32(level * last + half)
        for i in range(count):
            coded[i] = gamma[codes[i]]
    return image
