"""Vectorised logarithm and exponential with the same bits on every processor.

The last bits of NumPy's and the C library's versions differ between processors. These are sums and products
of float32 in a fixed order, and products are never fused with sums. numba needs `fastmath=False` for that, or
a kernel inherits such liberties from its first caller.
"""

from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

_LN2: Final = np.float32(0.6931471805599453)
# ln 2 in two parts: products of the first with integers below 2^9 are exact.
_LN2_HIGH: Final = np.float32(0.693359375)
_LN2_LOW: Final = np.float32(-2.12194440e-4)
_TWOS: Final = np.float32(1.4426950408889634)  # 1 / ln 2
_SQRT2: Final = np.float32(1.4142135623730951)
_FRACTION, _OF_ONE, _FRACTION_BITS, _BIAS = 0x7FFFFF, 0x3F800000, 23, 127  # of a float32, by IEEE 754
_MOST: Final = np.float32(87.0)  # largest argument whose exponential fits a float32


@njit(cache=True, nogil=True, error_model="numpy", fastmath=False)
def logarithm(x: np.float32) -> np.float32:
    """Return the natural logarithm of a positive normal number, to 3e-7 relative and 1e-7 absolute.

    For x = 2**e m, with m near 1, the logarithm of m is 2 artanh((m - 1) / (m + 1)).
    """
    bits = np.float32(x).view(np.int32)
    m = np.int32((bits & _FRACTION) | _OF_ONE).view(np.float32)
    e = np.float32((bits >> _FRACTION_BITS) - _BIAS)
    is_large = m > _SQRT2
    m, e = m * np.float32(0.5) if is_large else m, e + np.float32(1.0) if is_large else e
    s = (m - np.float32(1.0)) / (m + np.float32(1.0))
    q = s * s
    series = np.float32(1 / 7) + q * np.float32(1 / 9)
    series = np.float32(1.0) + q * (np.float32(1 / 3) + q * (np.float32(1 / 5) + q * series))
    return e * _LN2 + np.float32(2.0) * s * series


@njit(cache=True, nogil=True, error_model="numpy", fastmath=False)
def exponential(x: np.float32) -> np.float32:
    """Return e**x to a relative 1.5e-7, for x from -87 to 87; beyond, that of the nearer limit.

    The result is 2**n, which only sets the exponent, times the series of the remainder's exponential.
    """
    x = min(max(x, -_MOST), _MOST)
    n = np.floor(x * _TWOS + np.float32(0.5))
    f = (x - n * _LN2_HIGH) - n * _LN2_LOW
    series = np.float32(1 / 120) + f * (np.float32(1 / 720) + f * np.float32(1 / 5040))
    series = np.float32(1 / 6) + f * (np.float32(1 / 24) + f * series)
    series = np.float32(1.0) + f * (np.float32(1.0) + f * (np.float32(1 / 2) + f * series))
    two_to_n: np.float32 = np.int32((np.int32(n) + _BIAS) << _FRACTION_BITS).view(np.float32)
    result: np.float32 = series * two_to_n
    return result


@njit(cache=True, nogil=True, fastmath=False)
def exponentials(x: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the exponential (N,) of each number (N,)."""
    result = np.empty_like(x)
    for i in range(len(x)):
        result[i] = exponential(x[i])
    return result
