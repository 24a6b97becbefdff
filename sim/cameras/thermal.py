"""The thermal image: from surface temperatures to the robot's grey image.

Temperature of each surface point -> band radiance, with emissivity and mirrored surroundings -> optics and
rotation blur -> apparent temperature -> detector noise -> 16 bit at 10 mK.
`electronics.Gain` converts it to 8-bit grey levels.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.camera_config import ThermalConfig
from peopleboy.sim.cameras.imaging.blur import optics_blur, rotation_blur
from peopleboy.sim.cameras.imaging.camera_view import KELVIN_STEP, CameraView, MaterialTable
from peopleboy.sim.cameras.imaging.lighting import add_reflections
from peopleboy.sim.cameras.imaging.noise import gaussian
from peopleboy.sim.cameras.imaging.surfaces import (
    PixelRun,
    finish_run,
    paint_run,
    part_from_pixel,
    pattern_value,
    smooth_variation,
    surface_point,
)
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.materials import TEXEL_STEP

_CONTRAST = 2.0  # [W / (m2 sr)] about three kelvin: the blur hides the aliasing of fainter edges
LOWEST_C, HIGHEST_C, _STEP_K = -40.0, 160.0, 0.05


def band_radiance(temperature_c: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integrate Planck's law over the long-wave band of 8..14 um.

    Args:
        temperature_c: (N,) [degC].

    Returns:
        (N,) [W / (m2 sr)].
    """
    wavelength = np.linspace(8e-6, 14e-6, 241)
    kelvin = temperature_c[:, None] + 273.15
    first, second = 1.191042972e-16, 1.438776877e-2  # 2 h c^2 [W m2], h c / k [m K], CODATA 2018
    spectral = first / wavelength**5 / np.expm1(second / (wavelength * kelvin))
    return np.asarray(np.trapezoid(spectral, wavelength, axis=1))


def _tables() -> tuple[NDArray[np.float64], NDArray[np.float64], float, float]:
    """Return tables of radiance over temperature and temperature over radiance, and the radiance's span."""
    temperature = np.arange(LOWEST_C, HIGHEST_C + _STEP_K, _STEP_K)
    radiance = band_radiance(temperature)
    grid = np.linspace(radiance[0], radiance[-1], 16384)
    return radiance, np.interp(grid, radiance, temperature), float(radiance[0]), float(radiance[-1])


RADIANCE, TEMPERATURE, DIMMEST, BRIGHTEST = _tables()


_MIDDLE_C, _HALF_K = (LOWEST_C + HIGHEST_C) / 2.0, (HIGHEST_C - LOWEST_C) / 2.0


def _polynomial() -> list[np.float32]:
    """Return coefficients of radiance over the temperature, scaled to -1..1 from coldest to hottest."""
    x = np.linspace(-1.0, 1.0, len(RADIANCE))
    fitted = np.polynomial.Chebyshev.fit(x, RADIANCE, 6).convert(kind=np.polynomial.Polynomial)
    return [np.float32(value) for value in fitted.coef]


_B0, _B1, _B2, _B3, _B4, _B5, _B6 = _polynomial()


@lru_cache(maxsize=16)
def mirrored(surroundings_c: float) -> float:
    """Return the band radiance of the surroundings, the same in every image of a run."""
    return float(band_radiance(np.array([surroundings_c]))[0])


@njit(cache=True, fastmath=True)
def _look_up(table: NDArray[np.float64], low: float, high: float, value: float) -> float:
    """Interpolate a table over an evenly spaced grid low..high; values outside take the table's ends."""
    last = table.shape[0] - 1
    position = min(max((value - low) / (high - low) * last, 0.0), last - 1e-9)
    # Of 32 bits, as processors cut several numbers at once to; unsigned, as numba would ask of every other
    # number whether it counts from the end.
    whole = np.int32(position)
    below, above = table[np.uint64(whole)], table[np.uint64(whole) + np.uint64(1)]
    result: float = below + (position - whole) * (above - below)
    return result


@njit(cache=True, fastmath=True, forceinline=True)
def _vary_run(warmer_k: NDArray[np.float32], run: PixelRun, materials: MaterialTable) -> None:
    """Add the variation and pattern of a part [K] to its pixels in a row (W,)."""
    first, end, p, v, depths, matrices = run
    thermal, phase = materials.thermal, materials.phase
    kind, period = materials.kind, materials.period
    if thermal[p, 2] != 0.0:
        for u in range(first, end):
            x, y, z = surface_point(matrices, p, u, v, depths[u])
            warmer_k[u] += thermal[p, 2] * smooth_variation(x, y, z, thermal[p, 3], phase, p)
    if thermal[p, 4] != 0.0:
        for u in range(first, end):
            x, y, z = surface_point(matrices, p, u, v, depths[u])
            warmer_k[u] += thermal[p, 4] * pattern_value(kind[p, 0], period[p, 0], x, y, z, phase, p)


@njit(cache=True, fastmath=True)
def _radiate_row(
    image: NDArray[np.float32],
    warmer_k: NDArray[np.float32],
    places: NDArray[np.uint32],
    v: int,
    part: NDArray[np.int32],
    depths: NDArray[np.float32],
    matrices: NDArray[np.float64],
    materials: MaterialTable,
    surroundings: float,
) -> None:
    """Fill a row (W,) in full detail, neighbouring pixels of one part together."""
    thermal, finish, texels = materials.thermal, materials.finish, materials.texels
    paint, paint_texels = materials.paint, materials.paint_texels
    width = len(part)
    end: int = np.int64(0)  # type: ignore[assignment]  # called with a literal, kernels would be compiled for it, too
    scale, most = np.float32(1.0 / _HALF_K), np.float32(1.0)
    has_finish, has_paint = len(finish) > 0, paint_texels.shape[1] > 0
    while end < width:
        first, p = end, part[end]
        while end < width and part[end] == p:
            end += 1
        if p < 0:
            image[first:end] = np.float32(surroundings)
            continue
        warmer_k[first:end], run = np.float32(0.0), PixelRun(first, end, p, v, depths, matrices)
        if has_paint and paint[p, 0] >= 0.0:
            paint_run(warmer_k, run, paint, paint_texels[0], KELVIN_STEP)
        if has_finish and finish[p, 0] >= 0.0:
            finish_run(places, run, finish)
            for u in range(first, end):
                warmer_k[u] += np.float32(TEXEL_STEP) * np.float32(texels[places[u], 0])
        _vary_run(warmer_k, run, materials)
        base, emissivity = np.float32((thermal[p, 0] - _MIDDLE_C) / _HALF_K), np.float32(thermal[p, 1])
        rest = np.float32((1.0 - thermal[p, 1]) * surroundings)
        for u in range(first, end):
            at = min(max(base + scale * warmer_k[u], -most), most)
            radiance = _B0 + at * (_B1 + at * (_B2 + at * (_B3 + at * (_B4 + at * (_B5 + at * _B6)))))
            image[u] = emissivity * radiance + rest


@njit(cache=True, fastmath=True)
def radiance_image(
    part: NDArray[np.int32],
    depth: NDArray[np.float32],
    matrices: NDArray[np.float64],
    materials: MaterialTable,
    table: NDArray[np.float64],
    surroundings: float,
    span: tuple[float, float],
) -> NDArray[np.float32]:
    """Form the radiance image (H, W) of a `View` with the materials of a `MaterialTable`.

    The matrices are those of `part_from_pixel`; the table has the radiance over a span [degC], evenly; the
    surroundings are given by their radiance.
    """
    height, width = part.shape
    image = np.empty((height, width), np.float32)
    if len(materials.finish) > 0 or materials.paint_texels.shape[1] > 0:
        warmer_k, places = np.empty(width, np.float32), np.empty(width, np.uint32)
        for v in range(height):
            _radiate_row(image[v], warmer_k, places, v, part[v], depth[v], matrices, materials, surroundings)
        return image
    # Plain detail interpolates a table of 64 bits, full detail evaluates a polynomial of 32 bits, which the
    # compiler vectorises. The two differ in the last bits, so one row kernel cannot serve both.
    temperatures = np.empty(width)
    for v in range(height):
        _radiate_plain_row(
            image[v], temperatures, v, part[v], depth[v], matrices, materials, table, surroundings, span
        )
    return image


@njit(cache=True, fastmath=True)
def _radiate_plain_row(
    image: NDArray[np.float32],
    temperatures: NDArray[np.float64],
    v: int,
    part: NDArray[np.int32],
    depths: NDArray[np.float32],
    matrices: NDArray[np.float64],
    materials: MaterialTable,
    table: NDArray[np.float64],
    surroundings: float,
    span: tuple[float, float],
) -> None:
    """Fill a row (W,) in plain detail, neighbouring pixels of one part together; `temperatures` is space."""
    thermal, phase = materials.thermal, materials.phase
    kind, period = materials.kind, materials.period
    width, end = len(part), 0
    while end < width:
        first, p = end, part[end]
        while end < width and part[end] == p:
            end += 1
        if p < 0:
            image[first:end] = np.float32(surroundings)
            continue
        base, varies, waves, contrast = thermal[p, 0], thermal[p, 2], thermal[p, 3], thermal[p, 4]
        if varies == 0.0 and contrast == 0.0:
            emitted = thermal[p, 1] * _look_up(table, span[0], span[1], base)
            image[first:end] = np.float32(emitted + (1.0 - thermal[p, 1]) * surroundings)
            continue
        for u in range(np.uint64(first), np.uint64(end)):
            x, y, z = surface_point(matrices, p, np.int32(u), v, depths[u])
            temperatures[u] = base + varies * smooth_variation(x, y, z, waves, phase, p)
        if contrast != 0.0:
            for u in range(np.uint64(first), np.uint64(end)):
                x, y, z = surface_point(matrices, p, np.int32(u), v, depths[u])
                temperatures[u] += contrast * pattern_value(kind[p, 0], period[p, 0], x, y, z, phase, p)
        for u in range(np.uint64(first), np.uint64(end)):
            emitted = _look_up(table, span[0], span[1], temperatures[u])
            image[u] = thermal[p, 1] * emitted + (1.0 - thermal[p, 1]) * surroundings


@njit(cache=True, fastmath=True)
def to_apparent_c(radiance: NDArray[np.float32], table: NDArray[np.float64], low: float, high: float) -> None:
    """Replace radiance by the temperature of a black body of that radiance, in place."""
    flat = radiance.reshape(-1)
    for i in range(flat.shape[0]):
        flat[i] = _look_up(table, low, high, float(flat[i]))


@dataclass(frozen=True, slots=True, eq=False)
class Detector:
    """Fixed errors of one detector throughout a run.

    Attributes:
        offset_k: (H, W) [K] fixed-pattern offsets.
        dead: (H, W) whether a pixel is dead.
        dead_c: [degC] reading of a dead pixel.
    """

    offset_k: NDArray[np.float32]
    dead: NDArray[np.bool_]
    dead_c: float


def make_detector(config: ThermalConfig, rng: np.random.Generator) -> Detector:
    """Draw the fixed errors of the detector of one run."""
    shape = (config.camera.height, config.camera.width)
    offset = rng.standard_normal(shape, np.float32) * np.float32(config.fixed_pattern_k)
    if config.vignetting_k > 0.0:
        offset += _corners(config)
    return Detector(offset, rng.random(shape) < config.dead_pixels, config.lowest_c)


def _corners(config: ThermalConfig) -> NDArray[np.float32]:
    """Return (H, W) [K] the effect of the warm lens housing, quadratic in the distance to the corners."""
    v, u = (np.linspace(-1.0, 1.0, size) for size in (config.camera.height, config.camera.width))
    return np.asarray(config.vignetting_k * (v[:, None] ** 2 + u**2) / 2.0, np.float32)


def surface_image(seen: CameraView, config: ThermalConfig) -> NDArray[np.float32]:
    """Form the noise-free image (H, W) of apparent temperature [degC] of a camera and its optics.

    A surface of emissivity e at temperature T sends e B(T) + (1 - e) B(surroundings), B being the radiance of
    a black body; blur acts on that radiance. In a world of one temperature the image has one value.
    """
    materials, surroundings = seen.materials, mirrored(seen.surroundings_c)

    def draw(one: View, matrices: Matrix) -> NDArray[np.float32]:
        return radiance_image(
            one.part, one.depth, matrices, materials, RADIANCE, surroundings, (LOWEST_C, HIGHEST_C)
        )

    radiance = draw(seen.view, part_from_pixel(config.camera, seen.world_from_camera, seen.world_from_part))
    if seen.full_detail is not None:
        add_reflections(
            radiance[..., None], seen, config.camera, 1.0 - materials.thermal[:, 1], np.array([surroundings]),
            lambda one, matrices: draw(one, matrices)[..., None],
        )  # fmt: skip
        seen.full_detail.smooth(radiance[..., None], _CONTRAST)
    turned_rad = seen.turn_rad_s * config.exposure_s
    radiance = rotation_blur(optics_blur(radiance, config.blur_px), config.camera, turned_rad)
    radiance = np.ascontiguousarray(radiance)
    to_apparent_c(radiance, TEMPERATURE, DIMMEST, BRIGHTEST)
    return radiance


def detect(
    apparent_c: NDArray[np.float32],
    detector: Detector,
    config: ThermalConfig,
    rng: np.random.Generator,
    drift_k: NDArray[np.float32] | None = None,
) -> NDArray[np.float32]:
    """Add the detector's noise, and its drift, to an (H, W) image of apparent temperature [degC].

    Returns a new image.
    """
    noise = gaussian(apparent_c.shape, rng)
    noise *= np.float32(config.netd_k)
    noise += apparent_c
    noise += detector.offset_k
    if drift_k is not None:
        noise += drift_k
    noise[detector.dead] = detector.dead_c
    return noise


def encode_16bit(temperature_c: NDArray[np.float32]) -> NDArray[np.uint16]:
    """Encode [degC] as hundredths of a kelvin, as radiometric cameras do: round((T + 273.15) * 100)."""
    return np.clip(np.rint((temperature_c.astype(np.float64) + 273.15) * 100.0), 0, 65535).astype(np.uint16)
