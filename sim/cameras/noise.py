"""Gaussian noise for whole images, quickly."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.special import ndtri

_LEVELS = 4096


def _quantiles() -> NDArray[np.float32]:
    """Return the middles of equally likely slices of the normal distribution, scaled to variance 1."""
    values = ndtri((np.arange(_LEVELS) + 0.5) / _LEVELS)
    return np.asarray(values / values.std(), np.float32)


QUANTILES = _quantiles()


def gaussian(shape: tuple[int, ...], rng: np.random.Generator) -> NDArray[np.float32]:
    """Draw independent noise of mean 0 and variance 1.

    Each value is one of 4096 equally likely quantiles, up to 3.7 standard deviations: much quicker than
    exact draws, and no detector's picture shows the difference.
    """
    noise = np.empty(math.prod(shape), np.float32)
    look_up(QUANTILES, random_words(shape, rng), noise)
    return noise.reshape(shape)


def smooth_gaussian(shape: tuple[int, int], patch_px: int, rng: np.random.Generator) -> NDArray[np.float32]:
    """Draw (H, W) noise of mean 0 and variance 1 that is alike over patches.

    Between the knots of a grid with `patch_px` meshes it is their weighted sum, whose variance is 1
    everywhere; pixels that are two meshes apart have nothing in common.
    """
    rows, columns = (length // patch_px + 2 for length in shape)
    return _interpolate(gaussian((rows, columns), rng), shape[0], shape[1], patch_px)


def skip_smooth_gaussian(shape: tuple[int, int], patch_px: int, rng: np.random.Generator) -> None:
    """Leave the generator as `smooth_gaussian` would."""
    rows, columns = (length // patch_px + 2 for length in shape)
    skip_gaussian((rows, columns), rng)


def skip_gaussian(shape: tuple[int, ...], rng: np.random.Generator) -> None:
    """Leave the generator as `gaussian` would."""
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
