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
_FIRST_BITS, _NEXT_BITS = 11, 10  # of 31: the sign bit is 0


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


@njit(cache=True, nogil=True)
def ranked(weight: Floats, rank: int) -> np.float32:
    """Return the weight (N,) that a given number of others do not exceed; weights are non-negative.

    Such floats are ordered like their bits: the first 11 bits are counted, then the next 10. Comparisons
    would cause unpredictable branches.
    """
    some, place = weight.view(np.uint32), np.int64(rank)
    shift, bits = np.uint32(20), np.uint32(_FIRST_BITS)
    while True:
        counts = np.zeros(1 << bits, dtype=np.int32)
        digits = np.uint32((1 << bits) - 1)
        for i in range(np.uint64(len(some))):
            counts[(some[i] >> shift) & digits] += np.int32(1)
        digit = np.uint32(0)
        while counts[digit] <= place:
            place -= counts[digit]
            digit += np.uint32(1)
        if shift == 0:
            break
        left, count = np.empty(len(some), dtype=np.uint32), np.uint64(0)
        for i in range(np.uint64(len(some))):
            left[count] = some[i]
            count += np.uint64(((some[i] >> shift) & digits) == digit)
        some, shift, bits = left[:count], shift - np.uint32(10), np.uint32(_NEXT_BITS)
    for i in range(np.uint64(len(some))):
        if (some[i] & digits) == digit:
            found: np.float32 = some[i : i + np.uint64(1)].view(np.float32)[0]
            return found
    return np.float32(0.0)
