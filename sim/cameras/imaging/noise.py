"""Fast Gaussian noise for whole images."""

import math
from statistics import NormalDist
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.sim.cameras.camera_config import ThermalConfig

_LEVELS = 4096


def _quantiles() -> NDArray[np.float32]:
    """Return the middles of equally likely slices of the normal distribution, scaled to variance 1."""
    values = np.array([NormalDist().inv_cdf((k + 0.5) / _LEVELS) for k in range(_LEVELS)])
    return np.asarray(values / values.std(), np.float32)


QUANTILES = _quantiles()


def gaussian(shape: tuple[int, ...], rng: np.random.Generator) -> NDArray[np.float32]:
    """Draw independent noise of mean 0 and variance 1.

    Each value is one of 4096 equally likely quantiles, up to 3.7 standard deviations. This is much faster
    than exact draws, and the difference is not visible in images.
    """
    noise = np.empty(math.prod(shape), np.float32)
    look_up(QUANTILES, random_words(shape, rng), noise)
    return noise.reshape(shape)


def smooth_gaussian(shape: tuple[int, int], patch_px: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """Draw (H, W) noise of mean 0 and variance 1 that is correlated over patches.

    It is a weighted sum of the knots of a grid with a spacing of `patch_px`, with variance 1 everywhere;
    pixels at a distance of two spacings are independent.
    """
    rows, columns = (length // patch_px + 2 for length in shape)
    return _interpolate(gaussian((rows, columns), rng), shape[0], shape[1], patch_px)


def skip_smooth_gaussian(shape: tuple[int, int], patch_px: int, rng: np.random.Generator) -> None:
    """Advance the generator as `smooth_gaussian` would."""
    rows, columns = (length // patch_px + 2 for length in shape)
    skip_gaussian((rows, columns), rng)


def skip_gaussian(shape: tuple[int, ...], rng: np.random.Generator) -> None:
    """Advance the generator as `gaussian` would."""
    random_words(shape, rng)


def random_words(shape: tuple[int, ...], rng: np.random.Generator) -> NDArray[np.uint64]:
    """Draw 16 random bits for each value of an image, four values to a word."""
    words: NDArray[np.uint64] = rng.bit_generator.random_raw(-(-math.prod(shape) // 4))
    return words


@njit(cache=True)
def look_up(quantiles: NDArray[np.float32], words: NDArray[np.uint64], noise: NDArray[np.float32]) -> None:
    """Fill the noise from quarters of random words."""
    for i in range(noise.shape[0]):
        quarter = words[i >> 2] >> np.uint64(16 * (i & 3))
        noise[i] = quantiles[quarter & np.uint64(_LEVELS - 1)]


@njit(cache=True, fastmath=True)
def _interpolate(knots: NDArray[np.float32], height: int, width: int, patch_px: int) -> NDArray[np.float32]:
    """Sum the four knots around each pixel of an (H, W) image, by weights whose squares sum to 1."""
    image = np.empty((height, width), np.float32)
    before, after = np.empty(patch_px, np.float32), np.empty(patch_px, np.float32)
    for k in range(patch_px):
        share = (k + 0.5) / patch_px
        length = math.hypot(share, 1.0 - share)
        before[k], after[k] = (1.0 - share) / length, share / length
    line = np.empty(knots.shape[1], np.float32)
    for v in range(height):
        row, k = v // patch_px, v % patch_px
        for c in range(len(line)):
            line[c] = before[k] * knots[row, c] + after[k] * knots[row + 1, c]
        for u in range(width):
            c, k = u // patch_px, u % patch_px
            image[v, u] = before[k] * line[c] + after[k] * line[c + 1]
    return image


# Offset drift of an uncooled camera, and the calibrations with a shutter that remove it.

SMOOTH_SHARE: Final = 0.5
PIXEL_SHARE: Final = 0.1
"""Drift of the fixed pattern, by patches and by pixels, relative to that of the common offset."""

_PATCHES: Final = 4  # per image height
_SOON_S: Final = 1e-6


class Drift:
    """The offsets of one run, a function of time only.

    Between calibrations, every pixel drifts at its own rate; after each it restarts from 0 at another rate.
    The column offsets are drawn anew at every calibration, too.

    Args:
        config: settings of the camera.
        name: name of the camera, and of its random streams.
        seed: seed of the run.
    """

    def __init__(self, config: ThermalConfig, name: str, seed: int) -> None:
        self._config, self._name, self._seed = config, name, seed
        self._is_on = config.offset_drift_k_per_min > 0.0 or config.column_noise_k > 0.0
        self._drawn = -1

    def is_closed(self, time_s: float) -> bool:
        """Return whether the shutter is closed."""
        count = self._closures(time_s)
        since_s = time_s - count * self._config.shutter_every_s
        return count > 0 and since_s < self._config.shutter_lasts_s - _SOON_S

    def offset_k(self, time_s: float) -> NDArray[np.float32] | None:
        """Return the (H, W) offsets [K] at a time; None for none."""
        if not self._is_on:
            return None
        count = self._closures(time_s)
        if count != self._drawn:
            self._draw(count)
        calibrated_s = count * self._config.shutter_every_s + self._config.shutter_lasts_s if count else 0.0
        minutes = np.float32(max(time_s - calibrated_s, 0.0) / 60.0)
        return _drifted(self._columns, self._rate, minutes)

    def _closures(self, time_s: float) -> int:
        every = self._config.shutter_every_s
        return math.floor((time_s + _SOON_S) / every) if every > 0.0 else 0

    def _draw(self, count: int) -> None:
        """Draw the columns' offsets [K] and the pixels' rates [K/min] after a calibration."""
        config, rng = self._config, stream(self._seed, f"{self._name}.drift.{count}")
        height, width = config.camera.height, config.camera.width
        common = gaussian((1, 1), rng)
        smooth = smooth_gaussian((height, width), max(height // _PATCHES, 1), rng)
        pixel = gaussian((height, width), rng)
        rate = common + np.float32(SMOOTH_SHARE) * smooth + np.float32(PIXEL_SHARE) * pixel
        self._rate = np.float32(config.offset_drift_k_per_min) * rate
        self._columns = np.float32(config.column_noise_k) * gaussian((1, width), rng)
        self._drawn = count


@njit(cache=True)
def _drifted(
    columns: NDArray[np.float32], rate: NDArray[np.float32], minutes: np.float32
) -> NDArray[np.float32]:
    """Return offsets (H, W) of columns (1, W), and of pixels that drift at rates (H, W) for some minutes."""
    offset = np.empty_like(rate)
    for v in range(rate.shape[0]):
        for u in range(rate.shape[1]):
            offset[v, u] = columns[0, u] + minutes * rate[v, u]
    return offset
