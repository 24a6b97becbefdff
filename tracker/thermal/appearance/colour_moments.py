"""Mean, variance and skewness of the pixels in a region, by k-statistics."""

from __future__ import annotations

import numpy as np
from numba import njit

from peopleboy.tracker.thermal.appearance.power_sums import Integers, RegionSums
from peopleboy.tracker.thermal.filter.particles import Floats

WHITE = 255.0


def normalised_moments(sums: RegionSums, least_seen: float) -> Floats:
    """Describe M regions by m1 = k1, m2 = k2 / k1 and m3 = k3 / k2^1.5, values scaled to 0..1.

    What a region is too small or too plain for is 0: m2 of one pixel or of black, m3 of two pixels or of a
    region of one value. A region of which less than `least_seen` lies in the image, or not one pixel, is NaN.

    Args:
        sums: of C channels and K powers, K = 1..3.
        least_seen: share of the region's area.

    Returns:
        (M, C, K) float32.

    Source: thesis, equations 6.8 to 6.14.
    """
    moments: Floats = _normalised_moments(sums.power, sums.pixels, sums.area, least_seen)
    return moments


# Without numpy's rules a kernel would test every division.
@njit(cache=True, nogil=True, error_model="numpy")
def _normalised_moments(power: Integers, pixels: Integers, area: Integers, least_seen: float) -> Floats:
    count, channels, degree = power.shape
    result = np.zeros((count, channels, degree), dtype=np.float32)
    for i in range(count):
        n = pixels[i]
        if n == 0 or n < least_seen * area[i]:
            result[i] = np.nan
            continue
        share, pairs, triples = 1.0 / n, 1.0 / (n * (n - 1.0)), n * n / ((n - 1.0) * (n - 2.0))
        for c in range(channels):
            s1 = power[i, c, 0]
            k1 = s1 * share
            result[i, c, 0] = k1 / WHITE
            if degree < 2 or n < 2 or s1 == 0:
                continue
            # In integers, so that a plain region has exactly no variance.
            spread = n * power[i, c, 1] - s1 * s1
            k2 = spread * pairs
            result[i, c, 1] = k2 / (k1 * WHITE)
            if degree < 3 or n < 3 or spread == 0:
                continue
            # Equation 6.11 with S1 = n k1, divided through by n^3 against the loss of digits.
            third = 2.0 * k1 * k1 * k1 + share * (power[i, c, 2] - 3.0 * k1 * power[i, c, 1])
            result[i, c, 2] = triples * third / (k2 * np.sqrt(k2))
    return result
