"""Weak classifiers: a threshold on one feature, or on a weighted sum of two or three."""

from dataclasses import dataclass
from itertools import combinations, product

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.occlusion.pair_features import Features

FRACTIONS = 20
"""N_f: the weights other than 1 are +-1/20, +-2/20, ... +-1."""


def weighted_sums(features: int, most: int, fractions: int = FRACTIONS) -> Features:
    """List all weighted sums of up to `most` of the features, as rows of weights (T, features).

    In a sum of two, one weight is 1, and the other is one of +-1/N_f .. +-1, in either order: 4 N_f sums per
    pair. In a sum of three, the second and the third each have such a ratio to the first, and all are scaled
    so that the largest is 1: (4 N_f)^2 per triplet. This reading gives the thesis's own numbers: 6 single
    features, 1206 with pairs and 129206 with triplets, and 243 for the pairs of three features.

    Source: thesis, equation 7.4, section 7.4 and table 7.2.
    """
    steps = np.arange(1, fractions + 1) / fractions
    small = np.concatenate([steps, -steps])
    ratios = np.concatenate([small, 1 / small])
    rows = [np.eye(features)]
    for size in range(2, most + 1):
        relations = np.array(list(product(ratios, repeat=size - 1)))
        weights = np.column_stack([np.ones(len(relations)), relations])
        weights /= np.abs(weights).max(axis=1, keepdims=True)
        for chosen in combinations(range(features), size):
            block = np.zeros((len(weights), features))
            block[:, chosen] = weights
            rows.append(block)
    return np.concatenate(rows)


@dataclass(frozen=True, slots=True, eq=False)
class SortedSums:
    """The weighted sums of N examples, each sorted, so that all thresholds are tested in one pass.

    Attributes:
        value: (T, N) float32 increasing sums.
        example: (T, N) int32 their examples.
    """

    value: NDArray[np.float32]
    example: NDArray[np.int32]

    @classmethod
    def build(cls, examples: Features, weights: Features) -> "SortedSums":
        """Sort the sums of examples (N, features) by rows of weights (T, features)."""
        sums = (weights @ examples.T).astype(np.float32)
        order = np.argsort(sums, axis=1).astype(np.int32)
        return cls(np.take_along_axis(sums, order, axis=1), order)


@dataclass(frozen=True, slots=True)
class Stump:
    """A weak classifier: 1 if p f < p theta (thesis, equation 7.2), f being one of the weighted sums.

    Attributes:
        row: index of the sum.
        threshold: theta.
        parity: p, 1 or -1.
    """

    row: int
    threshold: float
    parity: int


def best_stump(
    sums: SortedSums, is_positive: NDArray[np.bool_], example_weight: NDArray[np.float64]
) -> Stump:
    """Return the sum, threshold and parity with the smallest weighted error; the first of equals.

    Args:
        sums: of N examples.
        is_positive: (N,) label of each example.
        example_weight: (N,) weight of each example.

    Source: thesis, equation 7.3 and algorithm 5.
    """
    signed = np.where(is_positive, example_weight, -example_weight)
    row, threshold, parity = _best_stump(sums.value, sums.example, signed)
    return Stump(int(row), float(threshold), int(parity))


@njit(cache=True, nogil=True)
def _best_stump(
    value: NDArray[np.float32], example: NDArray[np.int32], signed: NDArray[np.float64]
) -> tuple[int, float, int]:
    best_gain, best_row, best_threshold, best_parity = -1.0, 0, 0.0, 1
    total = signed.sum()
    for j in range(len(value)):
        below = 0.0
        for i in range(value.shape[1] - 1):
            below += signed[example[j, i]]
            # Correct minus wrong votes, if all below the threshold are called positive.
            gain = 2 * below - total
            if abs(gain) > best_gain + 1e-12 and value[j, i] < value[j, i + 1]:
                best_gain, best_row, best_parity = abs(gain), j, 1 if gain > 0 else -1
                best_threshold = 0.5 * (value[j, i] + value[j, i + 1])
    return best_row, best_threshold, best_parity
