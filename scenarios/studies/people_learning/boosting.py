"""Boosted trees on many windows of many features: each is split where histograms say that it is best."""

from __future__ import annotations

from typing import Final, NamedTuple, Protocol

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.proposals.cascade import DEPTH, LEAVES, NODES

Bins = NDArray[np.uint8]
Floats = NDArray[np.float32]

_BINS: Final = 64
_LOOKED_AT: Final = 20000  # windows by which bins are told
_LIGHT: Final = 1.0  # weight of a leaf that says nothing, beside that of its windows


class Boosting(NamedTuple):
    """How much is learned, and how carefully.

    Attributes:
        trees: how many.
        rate: how much of what each says is believed.
        features: how many are tried for a level of a tree, drawn at random.
        share: of the windows that a tree learns from.
        smallest: windows in a leaf.
    """

    trees: int
    rate: float
    features: int = 450
    share: float = 0.5
    smallest: int = 20


class TreeLoss(Protocol):
    """What trees are to lower."""

    def __call__(self, told: Floats, /) -> tuple[Floats, Floats]:
        """Give the slope (N,) down which to go from what is told of windows (N,), and its bend (N,)."""
        ...


class Tables(NamedTuple):
    """Trees as a `Cascade` has them: feature (T, 7), threshold (T, 7) and leaf (T, 8)."""

    feature: NDArray[np.int32]
    threshold: Floats
    leaf: Floats


class Binned:
    """Windows (N, F) by the bins in which their features are."""

    def __init__(self, windows: NDArray[np.float16], rng: np.random.Generator) -> None:
        """Sort features into bins that hold about as many windows each."""
        some = windows[rng.permutation(len(windows))[:_LOOKED_AT]].astype(np.float32)
        borders = np.quantile(some, np.arange(1, _BINS) / _BINS, axis=0).astype(np.float32)
        self.edges = np.ascontiguousarray(borders.T)
        self.bins: Bins = np.empty(windows.shape[::-1], np.uint8)
        for number in range(windows.shape[1]):
            _bin(windows[:, number].astype(np.float32), self.edges[number], self.bins[number])

    def boosted(
        self, loss: TreeLoss, boosting: Boosting, rng: np.random.Generator, start: float = 0.0
    ) -> Tables:
        """Teach trees to lower a loss, by Newton's method on histograms (Chen and Guestrin, KDD 2016).

        Args:
            loss: of what is told.
            boosting: how much is learned.
            rng: draws what a tree learns from.
            start: what is told before all trees; it is no part of them.
        """
        features, windows = self.bins.shape
        told = np.full(windows, start, np.float32)
        tables = Tables(
            np.zeros((boosting.trees, NODES), np.int32),
            np.full((boosting.trees, NODES), np.inf, np.float32),
            np.zeros((boosting.trees, LEAVES), np.float32),
        )
        for feature, threshold, leaf in zip(*tables, strict=True):
            some = np.sort(rng.permutation(windows)[: round(boosting.share * windows)])
            tried = rng.integers(0, features, (DEPTH, boosting.features))
            at = np.full(NODES, _BINS - 1)
            _grow(self.bins, some, *loss(told), tried, boosting.smallest, feature, at, leaf)
            leaf *= np.float32(boosting.rate)
            _add(self.bins, feature, at, leaf, told)
            is_split = at < _BINS - 1
            threshold[is_split] = self.edges[feature[is_split], at[is_split]]
        return tables


@njit(cache=True, nogil=True)
def _count_below(edges: Floats, value: np.float32) -> int:  # pragma: no cover
    low, high = 0, len(edges)
    while low < high:
        middle = (low + high) // 2
        if edges[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low


@njit(cache=True, nogil=True)
def _bin(column: Floats, edges: Floats, bins: Bins) -> None:  # pragma: no cover
    for k in range(len(column)):
        bins[k] = _count_below(edges, column[k])


@njit(cache=True, nogil=True)
def _grow(
    bins: Bins,
    some: NDArray[np.int64],
    slope: Floats,
    bend: Floats,
    tried: NDArray[np.int64],
    smallest: int,
    feature: NDArray[np.int32],
    at: NDArray[np.int64],
    leaf: Floats,
) -> None:  # pragma: no cover
    """Grow a tree level by level: each node takes the feature and the bin that lower the loss most."""
    count = len(some)
    node = np.zeros(count, np.int64)
    g, h = np.empty(count, np.float32), np.empty(count, np.float32)
    for k in range(count):
        g[k], h[k] = slope[some[k]], bend[some[k]]
    for depth in range(DEPTH):
        first, nodes = 2**depth - 1, 2**depth
        best = np.zeros(nodes, np.float64)
        for trial in range(tried.shape[1]):
            number = tried[depth, trial]
            row = bins[number]
            sums = np.zeros((nodes, _BINS, 3), np.float32)
            for k in range(count):
                cell = sums[node[k], row[some[k]]]
                cell[0] += g[k]
                cell[1] += h[k]
                cell[2] += np.float32(1.0)
            for n in range(nodes):
                gain, split = _best(sums[n], smallest)
                if gain > best[n]:
                    best[n] = gain
                    feature[first + n], at[first + n] = number, split
        for k in range(count):
            place = first + node[k]
            node[k] = 2 * node[k] + (bins[feature[place], some[k]] > at[place])
    total = np.zeros((LEAVES, 2), np.float64)
    for k in range(count):
        total[node[k], 0] += g[k]
        total[node[k], 1] += h[k]
    for n in range(LEAVES):
        leaf[n] = total[n, 0] / (total[n, 1] + _LIGHT)


@njit(cache=True, nogil=True)
def _best(sums: NDArray[np.float32], smallest: int) -> tuple[float, int]:  # pragma: no cover
    """Give the best split of a node: by how much it lowers the loss, and the last bin to the left."""
    g_all, h_all, n_all = 0.0, 0.0, 0.0
    for b in range(_BINS):
        g_all += sums[b, 0]
        h_all += sums[b, 1]
        n_all += sums[b, 2]
    whole = g_all * g_all / (h_all + _LIGHT)
    gain, split = 0.0, _BINS - 1
    g, h, n = 0.0, 0.0, 0.0
    for b in range(_BINS - 1):
        g += sums[b, 0]
        h += sums[b, 1]
        n += sums[b, 2]
        if n >= smallest and n_all - n >= smallest:
            other = g_all - g
            one = g * g / (h + _LIGHT) + other * other / (h_all - h + _LIGHT) - whole
            if one > gain:
                gain, split = one, b
    return gain, split


@njit(cache=True, nogil=True)
def _add(
    bins: Bins, feature: NDArray[np.int32], at: NDArray[np.int64], leaf: Floats, score: Floats
) -> None:  # pragma: no cover
    """Add what a tree says of each window to its score."""
    for k in range(len(score)):
        node = 0
        for _ in range(DEPTH):
            node = 2 * node + 1 + (bins[feature[node], k] > at[node])
        score[k] += leaf[node - NODES]
