"""Optical blur and motion blur by rotation."""

import math
from functools import lru_cache

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Pinhole

Image = NDArray[np.float32]


def optics_blur(image: Image, sigma_px: float) -> Image:
    """Blur an (H, W) image with a Gaussian; the sum over the inside of the image is preserved."""
    if sigma_px <= 0.0:
        return image
    return np.asarray(cv2.GaussianBlur(image, (0, 0), sigma_px, borderType=cv2.BORDER_REPLICATE), np.float32)


def optics_blur_sheet(sheet: Image, sigma_px: float) -> Image:
    """Blur many images (N, H + 2 M, W) at once, which needs the GIL only once.

    The first and last row of each are repeated M = `optics_margin` times; these rows are not valid in the
    result. The other rows are bit-identical to those of `optics_blur`.
    """
    return optics_blur(sheet.reshape(-1, sheet.shape[2]), sigma_px).reshape(sheet.shape)


def optics_margin(sigma_px: float) -> int:
    """Return the largest reach [px] of the blur of float32 images."""
    return math.ceil(4.0 * sigma_px) + 1 if sigma_px > 0.0 else 0


def rotation_blur(image: Image, camera: Pinhole, turned_rad: float) -> Image:
    """Smear an image by the rotation about the camera's vertical axis during its exposure.

    Column u sweeps f (1 + x^2) times the angle, with x = (u - c) / f: outer columns sweep more. The small
    vertical sweep of the corners, and the blur by translation, are ignored.

    Args:
        image: (H, W) or (H, W, C) float32, linear in radiance.
        camera: gives focal length and centre.
        turned_rad: [rad] angle turned while the shutter was open; its sign does not matter.

    Returns:
        An image of the same shape, each pixel the mean over its sweep, which is centred on the pixel.
    """
    sweep = sweep_of_one_rad(camera) * abs(turned_rad)
    if sweep.max() < 0.05:
        return image
    lines = image.reshape(image.shape[0], -1)
    channels = lines.shape[1] // camera.width
    weights = np.repeat(sweep_weights(sweep), channels, axis=1)
    return weighted_sum(lines, weights, channels).reshape(image.shape)


@lru_cache(maxsize=16)
def sweep_of_one_rad(camera: Pinhole) -> NDArray[np.float64]:
    """Return the sweep (W,) [px] of each column per 1 rad of rotation."""
    x = (np.arange(camera.width) - camera.centre_px[0]) / camera.focal_px
    sweep: NDArray[np.float64] = camera.focal_px * (1.0 + x * x)
    sweep.setflags(write=False)
    return sweep


@njit(cache=True)
def sweep_weights(sweep: NDArray[np.float64]) -> Image:
    """Return the weights (2 K + 1, W) of pixels -K..K columns away in the mean of each column over its sweep.

    With linear interpolation between pixels, a weight is the mean of a hat function over the sweep. Pixels
    beyond the border have no weight.
    """
    farthest, columns = math.ceil(sweep.max() / 2.0), len(sweep)
    weights = np.empty((2 * farthest + 1, columns), np.float32)
    column = np.empty(2 * farthest + 1)
    for u in range(columns):
        for k in range(2 * farthest + 1):
            away, half = k - farthest, sweep[u] / 2.0
            is_inside = 0 <= u + away < columns
            area = hat_integral(half - away) - hat_integral(-half - away)
            column[k] = area / sweep[u] if is_inside else 0.0
        total = column.sum()
        for k in range(2 * farthest + 1):
            weights[k, u] = column[k] / total
    return weights


@njit(cache=True)
def hat_integral(end: float) -> float:
    """Return the integral up to `end` of the function that falls from 1 at 0 to 0 at -1 and 1."""
    end = min(max(end, -1.0), 1.0)
    return 0.5 + end - 0.5 * end * abs(end)


@njit(cache=True, fastmath=True)
def weighted_sum(lines: Image, weights: Image, channels: int) -> Image:
    """Sum each value of the (H, W C) lines and its neighbours, weighted by (2 K + 1, W C)."""
    height, length = lines.shape
    farthest = weights.shape[0] // 2
    result = np.zeros_like(lines)
    for row in range(height):
        for k in range(weights.shape[0]):
            shift = (k - farthest) * channels
            first, end = max(0, -shift), min(length, length - shift)
            total, weight = result[row, first:end], weights[k, first:end]
            neighbour = lines[row, first + shift : end + shift]
            for i in range(end - first):
                total[i] += weight[i] * neighbour[i]
    return result
