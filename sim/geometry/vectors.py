"""Vectors of three numbers as tuples, and poses as arrays, for use in kernels."""

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numba import njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

Array = NDArray[np.float64]
Point = tuple[float, float, float]


@njit(cache=True)
def dot(a: Point, b: Point) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def cross(a: Point, b: Point) -> Point:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True)
def plus(a: Point, b: Point) -> Point:
    """Sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit(cache=True)
def minus(a: Point, b: Point) -> Point:
    """Difference of two vectors."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(cache=True)
def scaled(a: Point, factor: float) -> Point:
    """A vector times a number."""
    return a[0] * factor, a[1] * factor, a[2] * factor


@njit(cache=True, error_model="numpy")
def compose(a: Array, b: Array, product: Array) -> None:
    """Write the first three rows of the product of two poses."""
    for i in range(3):
        for j in range(4):
            product[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]
        product[i, 3] += a[i, 3]


@njit(cache=True, fastmath=False)
def map_point(pose: Array, x: float, y: float, z: float) -> Point:
    """Map one point by a pose."""
    return (
        pose[0, 0] * x + pose[0, 1] * y + pose[0, 2] * z + pose[0, 3],
        pose[1, 0] * x + pose[1, 1] * y + pose[1, 2] * z + pose[1, 3],
        pose[2, 0] * x + pose[2, 1] * y + pose[2, 2] * z + pose[2, 3],
    )


@njit(cache=True, fastmath=False)
def map_corner(pose: Array, low: Array, high: Array, corner: int) -> Point:
    """Map one of the eight corners of the box between two of its own frame by a pose."""
    return map_point(
        pose,
        high[0] if corner & 1 else low[0],
        high[1] if corner & 2 else low[1],
        high[2] if corner & 4 else low[2],
    )


@njit(cache=True, fastmath=False)
def turn_back(pose: Array, x: float, y: float, z: float) -> Point:
    """Turn a vector of the frame that a pose leads to into the frame that it comes from."""
    return (
        pose[0, 0] * x + pose[1, 0] * y + pose[2, 0] * z,
        pose[0, 1] * x + pose[1, 1] * y + pose[2, 1] * z,
        pose[0, 2] * x + pose[1, 2] * y + pose[2, 2] * z,
    )


# Products of poses as kernels, rounded as the libraries of linear algebra round them.
#
# Each sum is a chain of fused multiply-adds, whatever the processor has: one rounding for each product.
# So images are the same to the byte whether the poses of one world or of many are multiplied.


def _fma(typing_context: Any, a: Any, b: Any, c: Any) -> Any:  # noqa: ARG001  # numba's own signature
    def build(context: Any, builder: Any, signature: Any, numbers: Any) -> Any:  # noqa: ARG001
        return builder.fma(*numbers)

    return types.float64(types.float64, types.float64, types.float64), build


fma = cast(Callable[[float, float, float], float], intrinsic(_fma))
"""a * b + c, rounded once; for kernels."""


@njit(cache=True, nogil=True)
def multiply(a: Array, b: Array, product: Array) -> None:
    """Write the product of two matrices, (n, k) and (k, m)."""
    for i in range(a.shape[0]):
        for j in range(b.shape[1]):
            total = 0.0
            for k in range(a.shape[1]):
                total = fma(a[i, k], b[k, j], total)
            product[i, j] = total


@njit(cache=True, nogil=True)
def invert(pose: Array, inverse: Array) -> None:
    """Write the inverse (4, 4) of a rigid pose."""
    for i in range(3):
        total = 0.0
        for k in range(3):
            inverse[i, k] = pose[k, i]
            total = fma(-pose[k, i], pose[k, 3], total)
        inverse[i, 3] = total
        inverse[3, i] = 0.0
    inverse[3, 3] = 1.0


@njit(cache=True, nogil=True)
def from_each(a_from_world: Array, world_from_part: Array) -> Array:
    """Return a from part, (P, 4, 4), by a from world and (P, 4, 4) world from part."""
    found = np.empty_like(world_from_part)
    for part in range(len(world_from_part)):
        multiply(a_from_world, world_from_part[part], found[part])
    return found


# Angles in kernels.


@njit(cache=True)
def remainder(angle: float) -> float:
    """`math.remainder` by a full turn, which kernels have not; exact up to one and a half turns."""
    if abs(angle) <= math.pi:
        return angle
    return angle - 2.0 * math.pi if angle > 0.0 else angle + 2.0 * math.pi
