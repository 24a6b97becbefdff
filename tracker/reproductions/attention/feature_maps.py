"""Feature maps in which people are described and located."""

import math
from functools import cache
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.attention.attention_config import AttentionConfig

# The ten basic maps of an image: four colours, four orientations, bright and dark.

Floats = NDArray[np.float32]

COLOURS: Final = slice(0, 4)
ORIENTATIONS: Final = slice(4, 8)
INTENSITIES: Final = slice(8, 10)
BASIC_NAMES: Final = (
    "red",
    "yellow",
    "green",
    "blue",
    "0 deg",
    "45 deg",
    "90 deg",
    "135 deg",
    "bright",
    "dark",
)

_KERNEL_PX: Final = 11
_SIGMA_PX: Final = 2.5
_WAVE_PX: Final = 6.0
_DARKEST: Final = 0.1  # intensity below which colours are not amplified


def basic_maps(image: NDArray[np.uint8], *, inhibits: bool) -> Floats:
    """Return the maps (H, W, 10), in the order of `BASIC_NAMES`, of an image (H, W, 3).

    Colour maps are divided by the intensity; orientation maps are magnitudes of Gabor filters.

    Args:
        image: RGB.
        inhibits: whether neighbouring maps inhibit each other.

    Source: situation-awareness thesis, section 5.2, which does not specify the filters.
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
    for turn in (90.0, 45.0, 0.0, 135.0):  # OpenCV uses the angle of the wave, and rows point downwards
        size = (_KERNEL_PX, _KERNEL_PX)
        kernel = cv2.getGaborKernel(size, _SIGMA_PX, np.deg2rad(turn), _WAVE_PX, 1.0, 0.0)
        kernel -= kernel.mean()
        kernels.append((kernel / np.abs(kernel).sum()).astype(np.float32))
    return tuple(kernels)


def _inhibited(maps: Floats) -> Floats:
    """Apply lateral inhibition between maps: C + n C - sum C_j, at least 0 (equation 5.1).

    Neighbours of a colour are the adjacent ones on the circle red, yellow, green, blue; of an orientation the
    two adjacent ones; of bright, dark. The lower limit of 0 is not in the source.
    """
    result = np.empty_like(maps)
    for part in (COLOURS, ORIENTATIONS):
        own = maps[:, :, part]
        result[:, :, part] = 3.0 * own - np.roll(own, 1, axis=2) - np.roll(own, -1, axis=2)
    own = maps[:, :, INTENSITIES]
    result[:, :, INTENSITIES] = 2.0 * own - own[:, :, ::-1]
    return np.maximum(result, 0.0, out=result)


CELL_PX: Final = 2
"""Size of a cell of the maps [px]; full resolution would more than double the time without a benefit."""

PLAIN: Final = slice(0, 10)
SURROUND: Final = slice(10, 20)
SUMS: Final = slice(20, 23)
NAMES: Final = (
    *BASIC_NAMES,
    *(f"{name}, centre-surround" for name in BASIC_NAMES),
    "colour",
    "orientation",
    "intensity",
)
"""Names of the 23 maps; the local binary patterns are the 24th, which cannot be added to others."""

LEVELS: Final = 6
_SURROUND_PX: Final = 7
_PEAK_PX: Final = 7
_LEAST: Final = 1e-6  # maximum below which a map counts as empty
_PEAK: Final = 0.5  # share of a map's maximum from which a peak counts
_OPPONENTS: Final = ((0, 2), (3, 1), (8, 9))  # red and green, blue and yellow, bright and dark


def feature_maps(image: NDArray[np.uint8], config: AttentionConfig) -> Floats:
    """Return the maps (H / 2, W / 2, 23) of an image (H, W, 3), in the order of `NAMES`.

    Maps with centre-surround are 0 unless requested.

    Source: situation-awareness thesis, section 5.2.
    """
    height, width = image.shape[0] // CELL_PX, image.shape[1] // CELL_PX
    basic = basic_maps(image, inhibits=config.inhibits)
    maps = np.zeros((height, width, len(NAMES)), np.float32)
    maps[:, :, PLAIN] = _resized(basic, (width, height), cv2.INTER_AREA)
    if config.surround:
        maps[:, :, SURROUND] = _resized(_centre_surround(basic), (width, height), cv2.INTER_AREA)
        for number, part in enumerate((COLOURS, ORIENTATIONS, INTENSITIES), SUMS.start):
            around = slice(SURROUND.start + part.start, SURROUND.start + part.stop)
            maps[:, :, number] = maps[:, :, around].sum(axis=2)
    if config.has_range:
        maps /= np.maximum(maps.max(axis=(0, 1)), _LEAST)
    return _by_peaks(maps) if config.divides_by_peaks else maps


def in_use(config: AttentionConfig) -> NDArray[np.bool_]:
    """Return which of the maps (23,) a configuration uses."""
    used = np.zeros(len(NAMES), np.bool_)
    used[PLAIN] = config.plain
    used[SURROUND] = used[SUMS] = config.surround
    return used


def _centre_surround(basic: Floats) -> Floats:
    """Sum, over the levels of a pyramid, the amount by which a map exceeds its surroundings.

    The surround of red is that of green, and so on: the difference of the two is compared with its mean,
    because only then uniform areas vanish, as the text says. Orientations have no opposite.
    """
    level = _opponents(basic)
    sides = []
    for _ in range(LEVELS):
        sides.append(level - cv2.blur(level, (_SURROUND_PX, _SURROUND_PX), borderType=cv2.BORDER_REFLECT))
        level = np.dstack([cv2.pyrDown(level[:, :, :4]), cv2.pyrDown(level[:, :, 4:])])
    total = _both_ways(sides[-1])
    for side in reversed(sides[:-1]):
        total = _resized(total, (side.shape[1], side.shape[0]), cv2.INTER_LINEAR) + _both_ways(side)
    return total


def _opponents(basic: Floats) -> Floats:
    """Return the three opponent differences and the orientations (H, W, 7)."""
    pairs = [basic[:, :, one] - basic[:, :, other] for one, other in _OPPONENTS]
    return np.dstack([*pairs, basic[:, :, ORIENTATIONS]])


def _both_ways(side: Floats) -> Floats:
    """Split differences (H, W, 7) into positive and negative parts, in the order of the basic maps."""
    maps = np.empty((*side.shape[:2], len(BASIC_NAMES)), np.float32)
    for number, (one, other) in enumerate(_OPPONENTS):
        maps[:, :, one] = np.maximum(side[:, :, number], 0.0)
        maps[:, :, other] = np.maximum(-side[:, :, number], 0.0)
    maps[:, :, ORIENTATIONS] = np.maximum(side[:, :, 3:], 0.0)
    return maps


def _resized(maps: Floats, size: tuple[int, int], way: int) -> Floats:
    """Resize maps (H, W, C), four channels at a time, the limit of OpenCV."""
    parts = [maps[:, :, k : k + 4] for k in range(0, maps.shape[2], 4)]
    return np.dstack([cv2.resize(part, size, interpolation=way) for part in parts])


def _by_peaks(maps: Floats) -> Floats:
    """Divide maps by the root of their number of peaks of at least half their maximum (equation 5.3)."""
    size = (maps.shape[1] // 2, maps.shape[0] // 2)
    kernel = np.ones((_PEAK_PX, _PEAK_PX), np.uint8)
    result = np.empty_like(maps)
    for k in range(maps.shape[2]):
        small = cv2.resize(maps[:, :, k], size, interpolation=cv2.INTER_AREA)
        is_peak = (small == cv2.dilate(small, kernel)) & (small > _PEAK * small.max())
        result[:, :, k] = maps[:, :, k] / math.sqrt(max(int(np.count_nonzero(is_peak)), 1))
    return result
