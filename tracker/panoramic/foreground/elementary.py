"""Logarithm and exponential that a compiler can work out for many pixels at once."""

from __future__ import annotations

from typing import Final

import numpy as np
from numba import njit

_LN2: Final = np.float32(0.6931471805599453)
_SQRT2: Final = np.float32(1.4142135623730951)
_FRACTION, _OF_ONE, _FRACTION_BITS, _BIAS = 0x7FFFFF, 0x3F800000, 23, 127  # of a float32, by IEEE 754
_MOST: Final = np.float32(87.0)  # whose exponential a float32 holds


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def logarithm(x: np.float32) -> np.float32:
    """Give the natural logarithm of a positive number, to 1e-6 or the rounding of a float32.

    Of x = 2**e m, with m about 1, that of m is twice the inverse hyperbolic tangent of (m - 1) / (m + 1).
    """
    bits = np.float32(x).view(np.int32)
    m = np.int32((bits & _FRACTION) | _OF_ONE).view(np.float32)
    e = np.float32((bits >> _FRACTION_BITS) - _BIAS)
    if m > _SQRT2:
        m, e = m * np.float32(0.5), e + np.float32(1.0)
    s = (m - np.float32(1.0)) / (m + np.float32(1.0))
    q = s * s
    series = np.float32(1 / 7) + q * np.float32(1 / 9)
    series = np.float32(1.0) + q * (np.float32(1 / 3) + q * (np.float32(1 / 5) + q * series))
    return e * _LN2 + np.float32(2.0) * s * series


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def exponential(x: np.float32) -> np.float32:
    """Give e**x to a relative 1e-5, for x from -87 to 87; beyond, that of the nearer limit.

    It is 2**n, which is only an exponent, times the exponential of what is left, by its series.
    """
    twos = min(max(x, -_MOST), _MOST) / _LN2
    n = np.int32(np.floor(twos + np.float32(0.5)))
    f = (twos - np.float32(n)) * _LN2
    series = np.float32(1 / 24) + f * (np.float32(1 / 120) + f * np.float32(1 / 720))
    series = np.float32(1 / 2) + f * (np.float32(1 / 6) + f * series)
    series = np.float32(1.0) + f * (np.float32(1.0) + f * series)
    return series * np.int32((n + _BIAS) << _FRACTION_BITS).view(np.float32)
