"""Formation of panoramic images, and of the lens's circular image from which they are unrolled."""

import math
from functools import lru_cache

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.camera_config import PanoramaConfig
from peopleboy.sim.cameras.colour import LIGHT, shade_of
from peopleboy.sim.cameras.imaging.blur import hat_integral
from peopleboy.sim.cameras.imaging.camera_view import CameraView, MaterialTable
from peopleboy.sim.cameras.imaging.surfaces import finish_at, painted, pattern_value
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.geometry.vectors import map_point

Linear = NDArray[np.float32]

_FINER = 2  # oversampling of the lens's image in rows and columns


def panorama_image(seen: CameraView, config: PanoramaConfig, camera: Panorama) -> Linear:
    """Form the noise-free panorama (H, W, 3) in linear light with full scale 1.

    Args:
        seen: rendered view, with depths as in `PanoramicRenderer`.
        config: exposure and gain.
        camera: the panorama, or one with higher resolution.
    """
    view, poses = seen.view, seen.world_from_part
    part_from_world = poses[:, :3, :3].transpose(0, 2, 1)
    part_from_camera = np.tile(np.eye(4), (len(poses), 1, 1))
    part_from_camera[:, :3, :3] = part_from_world @ seen.world_from_camera[:3, :3]
    offsets = seen.world_from_camera[:3, 3] - poses[:, :3, 3]
    part_from_camera[:, :3, 3] = (part_from_world @ offsets[:, :, None])[:, :, 0]
    directions, slopes = _lines(camera)
    image = _radiance_image(
        view.part, view.depth, view.normal, part_from_camera, directions, slopes,
        camera.mirror.ring_radius_m, seen.materials, LIGHT, seen.light_level * config.gain,
    )  # fmt: skip
    turned_rad = seen.turn_rad_s * config.exposure_s
    return shift_blur(image, abs(turned_rad) / math.tau * camera.width)


@lru_cache(maxsize=16)
def _lines(camera: Panorama) -> tuple[Matrix, Matrix]:
    """Return the directions (W, 2) of columns, optical x and z, and the fall (H,) of rows per metre."""
    right = -camera.bearing(np.arange(camera.width))
    return np.stack([np.sin(right), np.cos(right)], axis=1), np.tan(
        camera.depression(np.arange(camera.height))
    )


@njit(cache=True, fastmath=True)
def _radiance_image(
    part: NDArray[np.int32],
    depth: Linear,
    normal: Linear,
    part_from_camera: Matrix,
    directions: Matrix,
    slopes: Matrix,
    ring_radius: float,
    materials: MaterialTable,
    light: Matrix,
    level: float,
) -> Linear:
    colour, kind, period, phase = materials.colour, materials.kind, materials.period, materials.phase
    finish, texels, paint = materials.finish, materials.texels, materials.paint
    height, width = part.shape
    image = np.zeros((height, width, 3), np.float32)
    has_finish = len(finish) > 0
    for v in range(height):
        for u in range(width):
            p, out = part[v, u], depth[v, u]
            if p < 0:
                continue
            down = (out - ring_radius) * slopes[v]
            x, y, z = map_point(part_from_camera[p], out * directions[u, 0], down, out * directions[u, 1])
            second = 3 * pattern_value(kind[p, 1], period[p, 1], x, y, z, phase, p)
            shade = shade_of(normal[v, u], light, level) + colour[p, 6]
            if paint[p, 0] >= 0.0:
                shade *= painted(paint, materials.paint_texels, p, x, y, z)[1]
            for c in range(3):
                image[v, u, c] = shade * colour[p, second + c]
            if has_finish and finish[p, 0] >= 0.0:
                _, factor, cover = finish_at(finish, texels, p, x, y, z)
                for c in range(3):
                    over = cover * (shade * finish[p, 5 + c] - image[v, u, c])
                    image[v, u, c] = factor * (image[v, u, c] + over)
    return image


def shift_blur(image: Linear, sweep_px: float) -> Linear:
    """Apply motion blur to an (H, W, C) panorama, by the columns that pass while the robot turns.

    Returns:
        An image of the same shape. Each pixel is the mean over an interval centred on it, with linear
        interpolation between pixels and across the seam.
    """
    if sweep_px < 0.05:
        return image
    farthest, half = math.ceil(sweep_px / 2.0), sweep_px / 2.0
    away = range(-farthest, farthest + 1)
    weights = [(hat_integral(half - k) - hat_integral(-half - k)) / sweep_px for k in away]
    shifted = (
        np.float32(weight) * np.roll(image, -k, axis=1) for k, weight in zip(away, weights, strict=True)
    )
    return np.asarray(sum(shifted), np.float32)


def finer(camera: Panorama) -> Panorama:
    """Return a panorama with sufficient resolution for the lens's circular image."""
    return Panorama(width=8 * _FINER * camera.height, height=_FINER * camera.height, mirror=camera.mirror)


def roll_up(fine: Linear, camera: Panorama) -> Linear:
    """Convert a panorama with `finer` resolution to the circular image of the lens.

    The image is that of a camera that looks up, with the robot's front at the top and the robot's left on the
    right. It is black outside the rim, which includes one more pixel.

    Returns:
        (2 H, 2 H, 3), each pixel the mean over its area.
    """
    u, v, is_inside = _disc(camera)
    # One more column on each side, for interpolation across the seam.
    padded = np.concatenate([fine[:, -1:], fine, fine[:, :1]], axis=1)
    disc = cv2.remap(padded, u + 1.0, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    disc[~is_inside] = 0.0
    size = 2 * camera.height
    return np.asarray(cv2.resize(disc, (size, size), interpolation=cv2.INTER_AREA), np.float32)


def unroll(raw: NDArray[np.uint8], camera: Panorama) -> NDArray[np.uint8]:
    """Unroll the circular image (2 H, 2 H, 3) to the panorama (H, W, 3), by linear interpolation."""
    radius = camera.height - 0.5 - np.arange(camera.height)[:, None]
    bearing, middle = camera.bearing(np.arange(camera.width)), camera.height - 0.5
    x = np.asarray(middle + radius * np.sin(bearing), np.float32)
    y = np.asarray(middle - radius * np.cos(bearing), np.float32)
    return np.asarray(cv2.remap(raw, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE), np.uint8)


@lru_cache(maxsize=4)
def _disc(camera: Panorama) -> tuple[Linear, Linear, NDArray[np.bool_]]:
    """Return columns and rows of the finer panorama for a finer disc's pixels, and which are inside."""
    source, size = finer(camera), 2 * _FINER * camera.height
    right = np.arange(size) - (size - 1) / 2.0
    bearing, radius = np.arctan2(right, -right[:, None]), np.hypot(right, right[:, None])
    u = (math.pi - bearing) / math.tau * source.width - 0.5
    v = source.height - 0.5 - radius
    return np.asarray(u, np.float32), np.asarray(v, np.float32), radius < source.height + 2 * _FINER
