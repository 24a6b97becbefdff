"""What optics and rotation do to an image: point spread and motion blur."""

from __future__ import annotations

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from sim.camera import Camera

Image = NDArray[np.float32]


def optics_blur(image: Image, sigma_px: float) -> Image:
    """Spread each point of an (H, W) image over a Gaussian; the sum over the image's inside is kept."""
    if sigma_px <= 0.0:
        return image
    blurred: Image = cv2.GaussianBlur(image, (0, 0), sigma_px, borderType=cv2.BORDER_REPLICATE)
    return blurred


def rotation_blur(image: Image, camera: Camera, turned_rad: float) -> Image:
    """Smear an image by the rotation about the camera's vertical axis during its exposure.

    Column u sweeps f (1 + x^2) times the angle, with x = (u - c) / f: the outer columns sweep more.
    The small vertical sweep of the corners, and the blur of translation, are left out.

    Args:
        image: (H, W) or (H, W, C) float32, linear in radiance.
        camera: gives focal length and centre.
        turned_rad: [rad] angle turned while the shutter was open; its sign does not matter.

    Returns:
        An image of the same shape, each pixel the mean over its sweep, centred on the pixel.
    """
    x = (np.arange(camera.width) - camera.centre_px[0]) / camera.focal_px
    sweep = camera.focal_px * (1.0 + x * x) * abs(turned_rad)
    if sweep.max() < 0.05:
        return image
    smeared: Image = _smear(image.reshape(image.shape[0], image.shape[1], -1), sweep)
    return smeared.reshape(image.shape)


@njit(cache=True, fastmath=True)
def _smear(image: NDArray[np.float32], sweep: NDArray[np.float64]) -> NDArray[np.float32]:
    height, width, channels = image.shape
    result = np.empty_like(image)
    total = np.zeros(width + 1)
    for row in range(height):
        for channel in range(channels):
            for u in range(width):
                total[u + 1] = total[u] + image[row, u, channel]
            for u in range(width):
                half = 0.5 * (1.0 + sweep[u])
                left, right = max(u + 0.5 - half, 0.0), min(u + 0.5 + half, float(width))
                area = _integral(total, right) - _integral(total, left)
                result[row, u, channel] = area / (right - left)
    return result


@njit(cache=True, fastmath=True)
def _integral(total: NDArray[np.float64], at: float) -> float:
    """Interpolate a running sum (W + 1,) at a fractional position."""
    index = min(int(at), total.shape[0] - 2)
    return total[index] + (at - index) * (total[index + 1] - total[index])
