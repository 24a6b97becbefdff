"""Products of poses as kernels, rounded as the libraries of linear algebra round them.

Each sum is a chain of fused multiply-adds, whatever the processor has: one rounding for each product. So
images are the same to the byte whether the poses of one world or of many are multiplied.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numpy as np
from numba import njit, types
from numba.extending import intrinsic
from numpy.typing import NDArray

Array = NDArray[np.float64]


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
    """Give a from part, (P, 4, 4), by a from world and (P, 4, 4) world from part."""
    found = np.empty_like(world_from_part)
    for part in range(len(world_from_part)):
        multiply(a_from_world, world_from_part[part], found[part])
    return found
