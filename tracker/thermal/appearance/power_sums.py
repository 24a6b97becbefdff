"""Sums of a picture's values, their squares and cubes over any rectangle, in constant time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.thermal.appearance.regions import Bounds, covered

Integers = NDArray[np.int64]

# With this many pixels of 255, n S2 and S1^2 still fit an int64.
_MOST_PIXELS = 1 << 23


@dataclass(frozen=True, slots=True, eq=False)
class RegionSums:
    """Power sums over M regions.

    Attributes:
        power: (M, C, K) int64 sum of the k-th powers of each channel, k = 1..K, over the pixels in the image.
        pixels: (M,) int64 how many those are.
        area: (M,) int64 pixels of the region, also outside the image.
    """

    power: Integers
    pixels: Integers
    area: Integers

    def __sub__(self, part: RegionSums) -> RegionSums:
        """Leave out regions that lie inside these."""
        return RegionSums(self.power - part.power, self.pixels - part.pixels, self.area - part.area)


@dataclass(frozen=True, slots=True, eq=False)
class PowerSums:
    """Integral images of an (H, W, C) picture's first K powers.

    Attributes:
        integral: (H + 1, W + 1, C, K) int64, or int32 for K = 1; entry [v, u] sums over the pixels above
            row v and left of column u. Exact.

    Source: thesis, equations 6.5 to 6.7.
    """

    integral: NDArray[np.integer[Any]]

    @classmethod
    def build(cls, picture: NDArray[np.uint8], degree: int) -> PowerSums:
        """Add up a picture (H, W, C) and its powers up to `degree`.

        Raises:
            BadInput: a picture too large for exact sums.
        """
        if picture.shape[0] * picture.shape[1] > _MOST_PIXELS:
            raise BadInput(f"picture must have at most {_MOST_PIXELS} pixels, got {picture.shape}")
        if degree == 1:
            # OpenCV knows no higher powers of integers, but is three times as fast with these.
            height, width, channels = picture.shape
            sums = np.asarray(cv2.integral(picture), dtype=np.int32)
            return cls(sums.reshape(height + 1, width + 1, channels, 1))
        power = np.arange(256, dtype=np.int64) ** np.arange(1, degree + 1, dtype=np.int64)[:, None]
        return cls(_integrate(picture, power))

    def over(self, bounds: Bounds) -> RegionSums:
        """Sum over rectangles (M, 4): first column and row, and those after the last."""
        height, width = self.integral.shape[0] - 1, self.integral.shape[1] - 1
        return RegionSums(_sum_over(self.integral, bounds), *covered(bounds, height, width))


@njit(cache=True, nogil=True)
def _integrate(picture: NDArray[np.uint8], power: Integers) -> Integers:
    height, width, channels = picture.shape
    result = np.empty((height + 1, width + 1, channels, len(power)), dtype=np.int64)
    result[0] = 0
    for v in range(height):
        result[v + 1, 0] = 0
        for c in range(channels):
            for k in range(len(power)):
                row = np.int64(0)
                for u in range(width):
                    row += power[k, picture[v, u, c]]
                    result[v + 1, u + 1, c, k] = result[v, u + 1, c, k] + row
    return result


@njit(cache=True, nogil=True)
def _sum_over(integral: NDArray[np.integer[Any]], bounds: Bounds) -> Integers:
    height, width, channels, degree = integral.shape
    flat = integral.reshape(height, width, channels * degree)
    power = np.empty((len(bounds), channels * degree), dtype=np.int64)
    for i in range(len(bounds)):
        left, right = min(max(bounds[i, 0], 0), width - 1), min(max(bounds[i, 2], 0), width - 1)
        top, bottom = min(max(bounds[i, 1], 0), height - 1), min(max(bounds[i, 3], 0), height - 1)
        right, bottom = max(left, right), max(top, bottom)
        a, b, c, d = flat[top, left], flat[top, right], flat[bottom, left], flat[bottom, right]
        for j in range(channels * degree):
            power[i, j] = d[j] + a[j] - (b[j] + c[j])
    return power.reshape(len(bounds), channels, degree)
