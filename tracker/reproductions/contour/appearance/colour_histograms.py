"""Cumulative colour histograms of regions: the slow method of the thesis, for comparison."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.appearance.regions import Bounds
from peopleboy.tracker.reproductions.contour.particles import Floats

BINS = 20  # of equal width


def cumulative_histograms(
    picture: NDArray[np.uint8], bounds: Bounds, holes: Bounds, bins: int, least_seen: float
) -> Floats:
    """Describe M regions by the share of pixels at or below each bin, counted pixel by pixel.

    Args:
        picture: (H, W, C).
        bounds: (M, 4) first column and row, and those after the last.
        holes: (M, 4) rectangles whose pixels are excluded.
        bins: number of bins of equal width.
        least_seen: least share of the region's area inside the picture; otherwise the region is NaN.

    Returns:
        (M, C, bins) float32; the last bin is 1.

    Source: thesis, equation 6.18.
    """
    histograms: Floats = _cumulative_histograms(picture, bounds, holes, bins, least_seen)
    return histograms


@njit(cache=True, nogil=True)
def _cumulative_histograms(
    picture: NDArray[np.uint8], bounds: Bounds, holes: Bounds, bins: int, least_seen: float
) -> Floats:
    height, width, channels = picture.shape
    result = np.empty((len(bounds), channels, bins), dtype=np.float32)
    for i in range(len(bounds)):
        left, top, right, bottom = bounds[i]
        count = np.zeros((channels, bins), dtype=np.int64)
        area = max(right - left, 0) * max(bottom - top, 0) - _shared_area(bounds[i], holes[i])
        for v in range(max(top, 0), min(bottom, height)):
            for u in range(max(left, 0), min(right, width)):
                if _is_within(u, v, holes[i]):
                    continue
                for c in range(channels):
                    count[c, int(picture[v, u, c]) * bins // 256] += 1
        pixels = count[0].sum()
        if pixels == 0 or pixels < least_seen * area:
            result[i] = np.nan
            continue
        for c in range(channels):
            result[i, c] = np.cumsum(count[c]) / pixels
    return result


@njit(cache=True, nogil=True, inline="always")
def _is_within(u: int, v: int, bounds: Bounds) -> bool:
    return bool(bounds[0] <= u < bounds[2] and bounds[1] <= v < bounds[3])


@njit(cache=True, nogil=True, inline="always")
def _shared_area(one: Bounds, other: Bounds) -> int:
    wide = min(one[2], other[2]) - max(one[0], other[0])
    tall = min(one[3], other[3]) - max(one[1], other[1])
    return int(max(wide, 0) * max(tall, 0))
