"""Depth sensors: structured light and time of flight, with their noise and holes."""

import math
from dataclasses import replace
from statistics import NormalDist
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.camera_config import DEPTH_BASELINE_M, DepthConfig, LaserConfig
from peopleboy.sim.cameras.imaging.camera_view import CameraView, MaterialTable
from peopleboy.sim.cameras.imaging.noise import gaussian, skip_gaussian, skip_smooth_gaussian, smooth_gaussian
from peopleboy.sim.cameras.imaging.surfaces import (
    part_from_pixel,
    pattern_value,
    surface_point,
)
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.rendering.view import View

Metres = NDArray[np.float32]
Amplitude = NDArray[np.uint16]

# Depth images in millimetres: storage, points, and display.

_BRIGHT_AMPLITUDE = 2500.0

Millimetres = NDArray[np.uint16]

_BRIGHT_M, _DARK_M, _DARK = 1.0, 12.0, 50  # [m] brightest and darkest depth, and the latter's brightness


def to_millimetres(depth_m: Metres, config: DepthConfig | LaserConfig) -> Millimetres:
    """Encode (H, W) depths [m] in millimetres; 0 outside the sensor's range, and for NaN and infinity."""
    is_read = (depth_m >= config.nearest_m) & (depth_m <= config.farthest_m)
    return np.where(is_read, np.rint(1000.0 * np.where(is_read, depth_m, 0.0)), 0.0).astype(np.uint16)


def points_of(depth: Millimetres, camera: Pinhole, every: int) -> tuple[Metres, NDArray[np.int64]]:
    """Return the points of a depth image, from every n-th pixel of every n-th row.

    Returns:
        (N, 3) [m] in the optical frame, x right, y down, z forward; and (N, 2) row and column of each.
        Pixels without a reading have no point.
    """
    first = every // 2
    pixels = first + every * np.argwhere(depth[first::every, first::every])
    z = depth[pixels[:, 0], pixels[:, 1]] / 1000.0
    x, y = ((pixels[:, 1 - k] - camera.centre_px[k]) / camera.focal_px * z for k in (0, 1))
    return np.stack([x, y, z], axis=1).astype(np.float32), pixels


def show_depth(depth: Millimetres) -> NDArray[np.uint8]:
    """Convert an (H, W) depth image to RGB: near is bright, far is dark, no reading is black.

    A colour always means the same depth, whatever the sensor's range: brightest up to 1 m, darkest from 12 m
    on, logarithmic in between.
    """
    return _SHADES[depth]


def show_amplitude(amplitude: NDArray[np.uint16]) -> NDArray[np.uint8]:
    """Convert an (H, W) amplitude image to grey: its root, with a white wall at 2 m or nearer as white."""
    share = np.minimum(amplitude / np.float32(_BRIGHT_AMPLITUDE), 1.0)
    return np.rint(255.0 * np.sqrt(share)).astype(np.uint8)


def _shades() -> NDArray[np.uint8]:
    """Return the (65536, 3) RGB colour of each depth [mm]."""
    depth_m = np.maximum(np.arange(65536), 1) / 1000.0
    share = np.clip(np.log(depth_m / _BRIGHT_M) / math.log(_DARK_M / _BRIGHT_M), 0.0, 1.0)
    levels = np.rint(255.0 - (255.0 - _DARK) * share).astype(np.uint8)
    shades = cv2.applyColorMap(levels[:, None], cv2.COLORMAP_INFERNO)[:, 0, ::-1].copy()
    shades[0] = 0
    return np.asarray(shades, np.uint8)


_SHADES = _shades()


# Structured light. Noise and steps of its disparity: Khoshelham & Oude Elberink 2012, Sensors 12:1437.
DISPARITY_SD_PX: Final = 0.062
DISPARITY_STEP_PX: Final = 0.125
_PATCH_PX = 8  # size of patches that share half of the noise's variance
_REACH = 1.05  # factor on the disparity range of shadows
_SLACK_PX = 0.5  # light still reaches this far beside an edge

# Time of flight.
TOF_SD_M: Final = 0.005  # at 2 m, for a surface of reflectance 0.5
_FINER = 2  # rays per pixel, along rows and columns
_BLACKEST = 0.02
AMPLITUDE_AT_1_M: Final = 10_000.0  # for a white surface; it falls with the square of the depth
# Depth noise per relative amplitude noise: c / (4 pi f) [m] at 15 MHz.
_METRES_A_SHARE = 299_792_458.0 / (4.0 * math.pi * 15e6)
AMPLITUDE_SD: Final = AMPLITUDE_AT_1_M * TOF_SD_M * 0.5 / 2.0**2 / _METRES_A_SHARE


def hole_share(depth_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the share of a surface at some depths [m] that structured light cannot read: patches of 8 px."""
    return 0.005 + 0.115 * np.minimum(np.asarray(depth_m) / 10.0, 1.0) ** 2


def _hole_levels() -> NDArray[np.float32]:
    """Return (1025,) levels of smooth noise below which there is a hole, for depths from 0 to 10 m."""
    levels = map(NormalDist().inv_cdf, hole_share(np.linspace(0.0, 10.0, 1025)))
    return np.fromiter(levels, np.float32, 1025)


def _edge_moves() -> NDArray[np.int8]:
    """Return (256,) [px] equally likely integer steps of a Gaussian with a standard deviation of 0.6 px."""
    return np.array([round(NormalDist(0.0, 0.6).inv_cdf((k + 0.5) / 256)) for k in range(256)], np.int8)


_LEVELS, _MOVES = _hole_levels(), _edge_moves()


def structured_light(view: View, config: DepthConfig, rng: np.random.Generator) -> Millimetres:
    """Measure depth by the disparity of a projected pattern.

    Noise and quantisation apply to the disparity, so both grow with the square of the depth. There is no
    reading where the projector's light does not fall, to the right of near objects, and in patches that grow
    in number with depth. Edges are frayed: some pixels measure the adjacent surface.

    Source: Khoshelham & Oude Elberink 2012.
    """
    height, width = view.part.shape
    white, alike, patches, moves = _draw(height, width, rng)
    return _from_disparity(
        view.part, view.depth, white, alike, patches, moves, _MOVES, _LEVELS,
        config.camera.focal_px * DEPTH_BASELINE_M, config.disparity_px_m,
        config.scale * DISPARITY_SD_PX / math.sqrt(2.0), config.nearest_m, config.farthest_m,
    )  # fmt: skip


def skip_structured_light(camera: Pinhole, rng: np.random.Generator) -> None:
    """Advance the generator as `structured_light` would."""
    shape = camera.height, camera.width
    skip_gaussian(shape, rng)
    skip_smooth_gaussian(shape, _PATCH_PX, rng)
    skip_smooth_gaussian(shape, _PATCH_PX, rng)
    _draw_moves(*shape, rng)


def _draw(
    height: int, width: int, rng: np.random.Generator
) -> tuple[Metres, Metres, Metres, NDArray[np.uint8]]:
    shape = height, width
    white, alike = gaussian(shape, rng), smooth_gaussian(shape, _PATCH_PX, rng)
    return white, alike, smooth_gaussian(shape, _PATCH_PX, rng), _draw_moves(height, width, rng)


def _draw_moves(height: int, width: int, rng: np.random.Generator) -> NDArray[np.uint8]:
    """Return (H, W, 2) random bytes."""
    words = rng.integers(0, 2**64, -(-height * width // 4), dtype=np.uint64)
    return words.astype("<u8", copy=False).view(np.uint8)[: 2 * height * width].reshape(height, width, 2)


@njit(cache=True, fastmath=True)
def _from_disparity(
    part: NDArray[np.int32],
    depth: Metres,
    white: Metres,
    alike: Metres,
    patches: Metres,
    moves: NDArray[np.uint8],
    steps: NDArray[np.int8],
    levels: Metres,
    shift: float,
    constant: float,
    sd: float,
    nearest: float,
    farthest: float,
) -> Millimetres:
    height, width = part.shape
    image = np.zeros((height, width), np.uint16)
    for v in range(height):
        lit_to = -1e9
        for u in range(width):
            ray = u + (_REACH * shift / depth[v, u] if part[v, u] >= 0 else 0.0)
            is_dark = ray < lit_to - _SLACK_PX
            lit_to = max(lit_to, ray)
            row = min(max(v + steps[moves[v, u, 0]], 0), height - 1)
            column = min(max(u + steps[moves[v, u, 1]], 0), width - 1)
            if part[row, column] == part[v, u]:
                row, column = v, u
            if is_dark or part[row, column] < 0:
                continue
            z = depth[row, column]
            if patches[v, u] < levels[min(int(102.4 * z), 1024)]:
                continue
            disparity = constant / z + sd * (white[v, u] + alike[v, u])
            read = DISPARITY_STEP_PX * math.floor(disparity / DISPARITY_STEP_PX + 0.5)
            if read > 0.0 and nearest <= constant / read <= farthest:
                image[v, u] = int(1000.0 * constant / read + 0.5)
    return image


def time_of_flight(fine: CameraView, config: DepthConfig, rng: np.random.Generator) -> Millimetres:
    """Measure depth by time of flight.

    Noise grows with the square of the depth and the darkness of the surface. A pixel whose rays meet several
    surfaces reads a depth between them, weighted by the light that each returns.

    Args:
        fine: the view of a camera of `rays_of`.
        config: settings of the camera.
        rng: random generator of the noise.
    """
    camera, view = config.camera, fine.view
    matrices = part_from_pixel(rays_of(camera), fine.world_from_camera, fine.world_from_part)
    noise = gaussian((camera.height, camera.width), rng)
    depth = _mean_of_rays(view.part, view.depth, matrices, fine.materials, noise, config.scale * TOF_SD_M)
    return to_millimetres(depth, config)


def amplitude_of(fine: CameraView, config: DepthConfig, rng: np.random.Generator) -> Amplitude:
    """Measure the returned light of a time-of-flight sensor, which falls with distance.

    Arguments as of `time_of_flight`. Its noise corresponds to that of the depth: a relative error of the
    amplitude is a phase error of as many radians, and each radian is c / (4 pi f) of depth.

    Returns:
        (H, W) uint16: 10000 for a white surface 1 m away.
    """
    camera, view = config.camera, fine.view
    matrices = part_from_pixel(rays_of(camera), fine.world_from_camera, fine.world_from_part)
    light = _light_of_rays(view.part, view.depth, matrices, fine.materials, camera.height, camera.width)
    noise = config.scale * AMPLITUDE_SD * gaussian(light.shape, rng)
    return np.clip(np.rint(AMPLITUDE_AT_1_M * light + noise), 0.0, 65535.0).astype(np.uint16)


def draw_offsets(config: DepthConfig, rng: np.random.Generator) -> NDArray[np.int32]:
    """Return (H, W) [mm] fixed errors of pixels, uniform up to the largest."""
    largest = 1000.0 * config.offset_m
    return np.rint(rng.uniform(-largest, largest, (config.camera.height, config.camera.width))).astype(
        np.int32
    )


def add_offsets(depth: Millimetres, offsets: NDArray[np.int32]) -> Millimetres:
    """Add the fixed errors where there is a depth reading."""
    return np.where(depth > 0, np.clip(depth + offsets, 1, 65535), 0).astype(np.uint16)


@njit(cache=True, fastmath=True)
def _light_of_rays(
    part: NDArray[np.int32],
    depth: Metres,
    matrices: Matrix,
    materials: MaterialTable,
    height: int,
    width: int,
) -> Metres:
    colour, kind, period, phase = materials.colour, materials.kind, materials.period, materials.phase
    image = np.zeros((height, width), np.float32)
    for row in range(_FINER * height):
        for column in range(_FINER * width):
            p = part[row, column]
            if p < 0:
                continue
            z = depth[row, column]
            x, y, up = surface_point(matrices, p, column, row, z)
            second = 3 * pattern_value(kind[p, 1], period[p, 1], x, y, up, phase, p)
            grey = (colour[p, second] + colour[p, second + 1] + colour[p, second + 2]) / 3.0
            image[row // _FINER, column // _FINER] += max(grey, _BLACKEST) / (z * z) / _FINER**2
    return image


def rays_of(camera: Pinhole) -> Pinhole:
    """Return the finer camera whose pixels are the rays that a time-of-flight pixel averages."""
    return replace(camera, width=_FINER * camera.width, height=_FINER * camera.height)


@njit(cache=True, fastmath=True)
def _mean_of_rays(
    part: NDArray[np.int32],
    depth: Metres,
    matrices: Matrix,
    materials: MaterialTable,
    noise: Metres,
    sd_m: float,
) -> Metres:
    colour, kind, period, phase = materials.colour, materials.kind, materials.period, materials.phase
    height, width = noise.shape
    image = np.zeros((height, width), np.float32)
    for v in range(height):
        for u in range(width):
            rays, light, weight, summed = 0, 0.0, 0.0, 0.0
            for row in range(_FINER * v, _FINER * (v + 1)):
                for column in range(_FINER * u, _FINER * (u + 1)):
                    p = part[row, column]
                    if p < 0:
                        continue
                    z = depth[row, column]
                    x, y, up = surface_point(matrices, p, column, row, z)
                    second = 3 * pattern_value(kind[p, 1], period[p, 1], x, y, up, phase, p)
                    grey = (colour[p, second] + colour[p, second + 1] + colour[p, second + 2]) / 3.0
                    sent = max(grey, _BLACKEST) / (z * z)
                    rays, light = rays + 1, light + grey
                    weight, summed = weight + sent, summed + sent * z
            if rays > 0:
                z = summed / weight
                darkness = min(max(0.5 * rays / max(light, 1e-6), 0.5), 6.0)
                image[v, u] = z + sd_m * (z / 2.0) ** 2 * darkness * noise[v, u]
    return image
