"""Kernels over a whole filter: weights of samples from evidence, and resampling."""

from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.elementary import exponential, logarithm

Floats = NDArray[np.float32]

NOTHING: Final[Floats] = np.empty(0, dtype=np.float32)
"""Placeholder for a factor, or a likeness, that is not used."""
_LEAST: Final = np.float32(1e-30)  # least likeness whose logarithm is taken


@njit(cache=True, nogil=True, error_model="numpy")
def sharp_weights(fit: Floats, likeness: Floats, sharpness: float, floor: float) -> Floats:
    """Return weights (N,): the exponential of contour and appearance together; the best has 1.

    The floor is the fitness of a person occluded by an unknown object, who fits neither.

    Args:
        fit: (N,) of the contour.
        likeness: (N,) of the appearance, or `NOTHING`.
        sharpness: factor on the sum.
        floor: least value of the sum.
    """
    weight, sharp, least = np.empty(len(fit), dtype=np.float32), np.float32(sharpness), np.float32(floor)
    if len(likeness) > 0:
        for i in range(len(fit)):
            weight[i] = max(fit[i] + logarithm(max(likeness[i], _LEAST)) / sharp, least)
    else:
        for i in range(len(fit)):
            weight[i] = max(fit[i], least)
    best = weight.max()
    for i in range(len(fit)):
        weight[i] = exponential(sharp * (weight[i] - best))
    return weight


@njit(cache=True, nogil=True, error_model="numpy")
def shared_out(weight: Floats, is_inside: NDArray[np.bool_], factor: Floats, outside: float) -> Floats:
    """Return weights (N,) that sum to 1: multiplied by their factors, and very low outside the limits.

    Args:
        weight: (N,) non-negative.
        is_inside: (N,) whether a sample is within the limits.
        factor: (N,) on the weights, or `NOTHING`.
        outside: factor on those outside the limits.
    """
    shared, few = np.empty(len(weight), dtype=np.float32), np.float32(outside)
    for i in range(len(weight)):
        shared[i] = weight[i] if is_inside[i] else few * weight[i]
    if len(factor) > 0:
        for i in range(len(weight)):
            shared[i] *= factor[i]
    scale_to_one(shared)
    return shared


@njit(cache=True, nogil=True, error_model="numpy")
def scale_to_one(weight: Floats) -> None:
    """Normalise (N,) non-negative weights, in place, to sum to 1; equal weights where none is positive."""
    total = 0.0
    for i in range(len(weight)):
        total += weight[i]
    for i in range(len(weight)):
        weight[i] = np.float32(weight[i] / total) if total > 0 else np.float32(1 / len(weight))


@njit(cache=True, nogil=True)
def systematic_rows(weight: Floats, count: int, offset: float) -> NDArray[np.int64]:
    """Return the rows (count,) under `count` evenly spaced marks on cumulated weights; offset in [0, 1)."""
    rows = np.empty(count, dtype=np.int64)
    total, last = 0.0, 0
    for k in range(len(weight)):
        total += weight[k]
        if weight[k] > 0:
            last = k
    row = 0
    cumulated = float(weight[0])
    for j in range(count):
        mark = total * (offset + j) / count
        while mark >= cumulated and row < last:
            row += 1
            cumulated += weight[row]
        rows[j] = row
    return rows
