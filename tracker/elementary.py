"""Logarithm, exponential and normal quantile, the same on every processor, worked out for many at once.

Those of numpy and of the C library take other roads on other processors, and their last bits differ. These
are sums and products of float32 in an order that is written down; no product is joined with a sum. numba has
to be told so (`fastmath=False`), or a kernel inherits such liberties from the one that first calls it.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

_LN2: Final = np.float32(0.6931471805599453)
# The same in two parts: products of the first with whole numbers below 2^9 are exact.
_LN2_HIGH: Final = np.float32(0.693359375)
_LN2_LOW: Final = np.float32(-2.12194440e-4)
_TWOS: Final = np.float32(1.4426950408889634)  # 1 / ln 2
_SQRT2: Final = np.float32(1.4142135623730951)
_FRACTION, _OF_ONE, _FRACTION_BITS, _BIAS = 0x7FFFFF, 0x3F800000, 23, 127  # of a float32, by IEEE 754
_MOST: Final = np.float32(87.0)  # whose exponential a float32 holds
# Of the inverse error function, Giles' polynomials for float32, the highest power first: by w - 2.5 up to
# w = 5, by sqrt(w) - 3 beyond. Each is multiplied by sqrt(2), to give quantiles of the normal distribution.
_NEAR: Final = tuple(
    np.float32(math.sqrt(2.0) * c)
    for c in (
        2.81022636e-08, 3.43273939e-07, -3.5233877e-06, -4.39150654e-06, 0.00021858087,
        -0.00125372503, -0.00417768164, 0.246640727, 1.50140941,
    )
)  # fmt: skip
_FAR: Final = tuple(
    np.float32(math.sqrt(2.0) * c)
    for c in (
        -0.000200214257, 0.000100950558, 0.00134934322, -0.00367342844, 0.00573950773,
        -0.0076224613, 0.00943887047, 1.00167406, 2.83297682,
    )
)  # fmt: skip


@njit(cache=True, nogil=True, error_model="numpy", fastmath=False)
def logarithm(x: np.float32) -> np.float32:
    """Give the natural logarithm of a positive number, not subnormal, to 3e-7 of it and 1e-7.

    Of x = 2**e m, with m about 1, that of m is twice the inverse hyperbolic tangent of (m - 1) / (m + 1).
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
    """Give e**x to a relative 1.5e-7, for x from -87 to 87; beyond, that of the nearer limit.

    It is 2**n, which is only an exponent, times the exponential of what is left, by its series.
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
    """Give the exponential (N,) of each number (N,)."""
    result = np.empty_like(x)
    for i in range(len(x)):
        result[i] = exponential(x[i])
    return result


@njit(cache=True, nogil=True, error_model="numpy", fastmath=False)
def write_quantiles(chance: NDArray[np.float32]) -> None:
    """Put normal quantiles in place of chances (N,), to 1e-6 of them.

    Chances are whole multiples of 2^-24 in [0, 1); the quantile is that of half such a step above.

    Source: Giles, Approximating the erfinv function, GPU Computing Gems, 2011, its single-precision form.
    """
    one, edge = np.float32(1.0), np.float32(5.0)
    for i in range(len(chance)):
        x = (chance[i] + chance[i] - one) + np.float32(2.0**-24)
        w = -logarithm((one - x) * (one + x))
        near, far = w - np.float32(2.5), np.sqrt(w) - np.float32(3.0)
        inner, outer = _NEAR[0], _FAR[0]
        for k in range(1, 9):
            inner, outer = _NEAR[k] + inner * near, _FAR[k] + outer * far
        chance[i] = x * (inner if w < edge else outer)
