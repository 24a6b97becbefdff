"""The ten basic maps of an image: four colours, four orientations, bright and dark."""

from __future__ import annotations

from functools import cache
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float32]

COLOURS: Final = slice(0, 4)
ORIENTATIONS: Final = slice(4, 8)
INTENSITIES: Final = slice(8, 10)
NAMES: Final = ("red", "yellow", "green", "blue", "0 deg", "45 deg", "90 deg", "135 deg", "bright", "dark")

_KERNEL_PX: Final = 11
_SIGMA_PX: Final = 2.5
_WAVE_PX: Final = 6.0
_DARKEST: Final = 0.1  # intensity below which colours are not raised any more


def basic_maps(image: NDArray[np.uint8], *, inhibits: bool) -> Floats:
    """Give the maps (H, W, 10), in the order of `NAMES`, of an image (H, W, 3).

    Colours are those of the image over its intensity, those of orientation magnitudes of Gabor filters.

    Args:
        image: RGB.
        inhibits: whether neighbours inhibit each other.

    Source: situation-awareness thesis, section 5.2, which names no filters.
    """
    maps = np.empty((*image.shape[:2], 10), np.float32)
    _fill_colours(image, maps)
    intensity = np.ascontiguousarray(maps[:, :, 8])
    for number, kernel in enumerate(_gabor_kernels(), ORIENTATIONS.start):
        maps[:, :, number] = np.abs(cv2.filter2D(intensity, -1, kernel))
    return _inhibited(maps) if inhibits else maps


@njit(cache=True, nogil=True)
def _fill_colours(image: NDArray[np.uint8], maps: Floats) -> None:
    for v in range(image.shape[0]):
        for u in range(image.shape[1]):
            r, g, b = np.float32(image[v, u, 0]), np.float32(image[v, u, 1]), np.float32(image[v, u, 2])
            bright = (r + g + b) / np.float32(3.0 * 255.0)
            over = np.float32(1.0 / 255.0) / max(bright, np.float32(_DARKEST))
            r, g, b = r * over, g * over, b * over
            half = np.float32(0.5)
            maps[v, u, 0] = max(r - half * (g + b), np.float32(0))
            maps[v, u, 1] = max(half * (r + g) - half * abs(r - g) - b, np.float32(0))
            maps[v, u, 2] = max(g - half * (r + b), np.float32(0))
            maps[v, u, 3] = max(b - half * (r + g), np.float32(0))
            maps[v, u, 8] = bright
            maps[v, u, 9] = np.float32(1) - bright


@cache
def _gabor_kernels() -> tuple[Floats, ...]:
    """Make filters of mean 0 and gain 1 for lines at 0, 45, 90 and 135 degrees from the row."""
    kernels = []
    for turn in (90.0, 45.0, 0.0, 135.0):  # OpenCV counts that of the wave, and rows downwards
        size = (_KERNEL_PX, _KERNEL_PX)
        kernel = cv2.getGaborKernel(size, _SIGMA_PX, np.deg2rad(turn), _WAVE_PX, 1.0, 0.0)
        kernel -= kernel.mean()
        kernels.append((kernel / np.abs(kernel).sum()).astype(np.float32))
    return tuple(kernels)


def _inhibited(maps: Floats) -> Floats:
    """Raise each map by what its neighbours have less: C + n C - sum C_j, at least 0 (equation 5.1).

    Neighbours of a colour are those beside it on the circle red, yellow, green, blue, of an orientation the
    two next to it, of bright dark. The source does not say that nothing goes below 0; we do.
    """
    result = np.empty_like(maps)
    for part in (COLOURS, ORIENTATIONS):
        own = maps[:, :, part]
        result[:, :, part] = 3.0 * own - np.roll(own, 1, axis=2) - np.roll(own, -1, axis=2)
    own = maps[:, :, INTENSITIES]
    result[:, :, INTENSITIES] = 2.0 * own - own[:, :, ::-1]
    return np.maximum(result, 0.0, out=result)
