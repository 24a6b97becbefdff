"""Vectors of three numbers as tuples, and poses as arrays, for use in kernels."""

from __future__ import annotations

import numpy as np
from numba import njit
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
def turn_back(pose: Array, x: float, y: float, z: float) -> Point:
    """Turn a vector of the frame that a pose leads to into the frame that it comes from."""
    return (
        pose[0, 0] * x + pose[1, 0] * y + pose[2, 0] * z,
        pose[0, 1] * x + pose[1, 1] * y + pose[2, 1] * z,
        pose[0, 2] * x + pose[1, 2] * y + pose[2, 2] * z,
    )
