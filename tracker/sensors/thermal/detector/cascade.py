"""Soft cascade of boosted trees that classifies windows.

Source: Bourdev and Brandt, CVPR 2005. After each tree, windows are rejected whose score is below that of
nearly all people at that stage.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.sensors.thermal.detector.channels import Cells
from peopleboy.tracker.sensors.thermal.detector.patches import Patches, Sums, patch
from peopleboy.tracker.sensors.thermal.detector.vector_trees import (
    DEPTH,
    LANES,
    NODES,
    PACKED,
    Trees,
    add_tree,
    pack,
)
from peopleboy.tracker.sensors.thermal.detector.window import COLUMNS, ROWS

STRIDE: Final = 2  # [cells] between windows of the coarse scan
_EARLY: Final = 32
"""Trees that nearly no window passes; from the next one on, windows are worth packing."""
_REPACKED: Final = 256
"""Trees after which the remaining windows are packed again."""
PROMISING: Final = 256
"""Number of passed trees from which the neighbours of a window are evaluated, too."""

_BESIDE: Final = (5, 2)
"""Rows and columns within which windows show mostly the same."""
_WORSE: Final = 3.0  # log-odds below the best neighbour: a twentieth of its weight


class Hits(NamedTuple):
    """Windows that passed the cascade.

    Attributes:
        row: (N,) row of the first cell, including the border.
        column: (N,) column of the first cell.
        score: (N,) sum of all trees.
    """

    row: NDArray[np.int64]
    column: NDArray[np.int64]
    score: NDArray[np.float64]

    def take(self, these: NDArray[np.bool_]) -> "Hits":
        """Return some of them."""
        return Hits(self.row[these], self.column[these], self.score[these])

    def best(self) -> "Hits":
        """Return those that are not much worse than a neighbour."""
        is_kept = np.empty(len(self.score), np.bool_)
        _compare(*self, is_kept)
        return self.take(is_kept)


@dataclass(frozen=True, eq=False)
class Cascade:
    """Trees of depth 3; each node sends a window to the right if its patch is above a threshold.

    Attributes:
        patches: all patches that the nodes use.
        feature: (T, 7) int32 number of a patch by node, level by level: the children of k are 2 k + 1 and
            2 k + 2.
        threshold: (T, 7) float32.
        leaf: (T, 8) float32, score of each leaf.
        least: (T,) float32 score below which a window is rejected after that tree.
    """

    patches: Patches
    feature: NDArray[np.int32]
    threshold: NDArray[np.float32]
    leaf: NDArray[np.float32]
    least: NDArray[np.float32]

    @cached_property
    def _packed(self) -> Trees:
        """The trees for packed windows."""
        return Trees.packed(self.patches, self.feature, self.threshold, self.leaf)

    def scan(
        self,
        sums: Sums,
        rows: tuple[int, int],
        is_known: NDArray[np.bool_] | None = None,
        *,
        stride: int = STRIDE,
        promising: int = PROMISING,
    ) -> Hits:
        """Evaluate all windows of a level whose first cell is in a range of rows, including borders.

        Args:
            sums: (9, h + 1, w + 1) integral images of its channels.
            rows: the first one, and the one after the last.
            is_known: (h - 19, w - 9) windows to skip, by their first cell; None for none.
            stride: cells between windows; from 2 on, the neighbours of promising windows are evaluated, too.
            promising: number of passed trees of a promising window.
        """
        _, high, wide = sums.shape
        first, end = max(rows[0], 0), min(rows[1], high - ROWS)
        if end <= first or wide - 1 < COLUMNS:
            return Hits(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))
        offset, weight = self.patches.corners(self.feature[:_EARLY].ravel(), high, wide)
        # Vectors may extend beyond the last window, but not beyond the sums.
        flat, last = sums.ravel(), (high - ROWS) * wide - COLUMNS - LANES
        if last < 0:
            flat, last = np.append(flat, np.zeros(LANES, np.int32)), 0
        shape = (end - first, wide - COLUMNS)
        at, score = _scan(
            flat, high, wide, first, np.uint64(last), self._packed._replace(offset=offset, weight=weight),
            self._packed, self.least, stride, min(promising, len(self.least)),
            np.zeros(shape, np.bool_) if is_known is None else is_known[first:end],
        )  # fmt: skip
        order = np.argsort(at)
        row, column = np.divmod(at[order].astype(np.int64), wide)
        return Hits(row, column, score[order].astype(np.float64))

    def calibrated(self, gain: float, offset: float) -> "Cascade":
        """Return the same trees with scores multiplied by a gain plus an offset."""
        leaf = self.leaf * np.float32(gain)
        leaf[0] += np.float32(offset)
        least = self.least * np.float32(gain) + np.float32(offset)
        return Cascade(self.patches, self.feature, self.threshold, leaf, least)

    def running(self, sums: Sums) -> NDArray[np.float32]:
        """Return the scores (N, T) after each tree of windows with sums in their columns (9 * 21 * 11, N)."""
        scores = np.zeros((sums.shape[1], len(self.feature)), np.float32)
        offset, weight = self.patches.corners(self.feature.ravel(), ROWS + 1, COLUMNS + 1)
        for number, window in enumerate(np.ascontiguousarray(sums.T)):
            _run(window, offset, weight, self.threshold.ravel(), self.leaf, scores[number])
        return scores


@njit(inline="always")
def find_leaf(
    sums: Sums, at: np.uint32, offset: NDArray[np.uint32], weight: Cells, threshold: Cells, nodes: np.uint32
) -> np.uint32:  # pragma: no cover
    """Return the leaf (0 to 7) of a window at a position, in the tree whose nodes start at an index."""
    node = np.uint32(0)
    for _ in range(DEPTH):
        seen = patch(sums, at, offset[nodes + node], weight[nodes + node])
        is_right = seen > threshold[nodes + node]
        node = np.uint32(2) * node + np.uint32(1) + np.uint32(is_right)
    return node - np.uint32(NODES)


@njit(cache=True, nogil=True)
def _scan(
    sums: Sums,
    high: int,
    wide: int,
    first: int,
    last: np.uint64,
    early_trees: Trees,
    trees: Trees,
    least: Cells,
    stride: int,
    promising: int,
    is_passed: NDArray[np.bool_],
) -> tuple[NDArray[np.uint64], Cells]:  # pragma: no cover
    """Evaluate a grid of windows, then the neighbours of promising ones; return the rest and their scores.

    While many windows are rejected, rows are processed separately, so that their data stay in the cache.
    """
    rows, columns = is_passed.shape
    early = min(_EARLY, promising)
    at, score = np.empty(rows * columns, np.uint64), np.zeros(rows * columns + LANES, np.float32)
    is_wanted = np.zeros((rows, columns), np.bool_)
    none: int = np.int64(0)  # type: ignore[assignment]  # a literal would compile the kernels a second time
    left = none
    for i in range(0, rows, stride):
        count = none
        for j in range(0, columns, stride):
            at[left + count] = (i + first) * wide + j
            count += not is_passed[i, j]
        left += _walk_neighbours(sums, last, at[left:], score[left:], count, early_trees, least[:early])
    left = _walk(sums, high, wide, at, score, left, trees, least[:promising], early)
    for k in range(left):
        row, column = np.int64(at[k]) // wide - first, np.int64(at[k]) % wide
        top, begin = max(row - stride + 1, 0), max(column - stride + 1, 0)
        is_wanted[top : min(row + stride, rows), begin : min(column + stride, columns)] = True
    left = _walk(sums, high, wide, at, score, left, trees, least, promising)
    count = none
    for i in range(rows):
        for j in range(columns):
            if is_wanted[i, j] and not is_passed[i, j] and (i % stride != 0 or j % stride != 0):
                at[left + count], score[left + count] = (i + first) * wide + j, 0.0
                count += 1
    left += _walk(sums, high, wide, at[left:], score[left:], count, trees, least, none)
    return at[:left], score[:left]


@njit(cache=True, nogil=True)
def _compare(
    row: NDArray[np.int64], column: NDArray[np.int64], score: NDArray[np.float64], is_kept: NDArray[np.bool_]
) -> None:  # pragma: no cover
    """Return which windows are not much worse than a neighbour."""
    rows, columns = _BESIDE
    for k in range(len(row)):
        is_kept[k] = True
        for j in range(len(row)):
            is_near = abs(row[j] - row[k]) <= rows and abs(column[j] - column[k]) <= columns
            if is_near and score[k] < score[j] - _WORSE:
                is_kept[k] = False


@njit(cache=True, nogil=True)
def _walk_neighbours(
    sums: Sums,
    last: np.uint64,
    at: NDArray[np.uint64],
    score: Cells,
    count: int,
    trees: Trees,
    least: Cells,
) -> int:  # pragma: no cover
    """Evaluate windows at ascending positions in sums, and move the remaining ones to the front.

    Each vector has eight neighbouring windows, from at most the position `last` on, of which some are wanted.
    """
    first, wanted = np.empty(count, np.uint64), np.zeros(count, np.uint8)
    scores = np.zeros((count, LANES), np.float32)
    vectors, k = 0, 0
    while k < count:
        first[vectors] = min(at[k], last)
        while k < count and at[k] < first[vectors] + np.uint64(LANES):
            wanted[vectors] |= np.uint64(1) << (at[k] - first[vectors])
            k += 1
        vectors += 1
    for tree in range(len(least)):
        kept = 0
        for k in range(vectors):
            rest = wanted[k] & add_tree(sums, first[k], trees, np.uint64(tree), least[tree], scores[k])
            first[kept], wanted[kept] = first[k], rest
            for lane in range(LANES):
                scores[kept, lane] = scores[k, lane]
            kept += rest != 0
        vectors = kept
    count = 0
    for k in range(vectors):
        for lane in range(LANES):
            if wanted[k] >> lane & 1:
                at[count], score[count] = first[k] + np.uint64(lane), scores[k, lane]
                count += 1
    return count


@njit(cache=True, nogil=True)
def _walk(
    sums: Sums,
    high: int,
    wide: int,
    at: NDArray[np.uint64],
    score: Cells,
    count: int,
    trees: Trees,
    least: Cells,
    begin: int,
) -> int:  # pragma: no cover
    """Evaluate windows at positions in sums from one tree on, and move the remaining ones to the front."""
    packed = np.empty(PACKED, np.int32)
    for first in range(begin, len(least), _REPACKED):
        kept = 0
        for k in range(0, count, LANES):
            some = min(count - k, LANES)
            pack(sums, high, wide, at[k : k + some], packed)
            rest = (1 << some) - 1
            for tree in range(first, min(first + _REPACKED, len(least))):
                rest &= add_tree(packed, np.uint64(0), trees, np.uint64(tree), least[tree], score[k:])
                if rest == 0:
                    break
            for lane in range(some):
                at[kept], score[kept] = at[k + lane], score[k + lane]
                kept += rest >> lane & 1
        count = kept
    return count


@njit(cache=True, nogil=True)
def _run(
    window: Sums,
    offset: NDArray[np.uint32],
    weight: Cells,
    threshold: Cells,
    leaf: Cells,
    scores: Cells,
) -> None:  # pragma: no cover
    score = np.float32(0.0)
    for tree in range(len(leaf)):
        nodes = np.uint32(tree * NODES)
        score += leaf[tree, find_leaf(window, np.uint32(0), offset, weight, threshold, nodes)]
        scores[tree] = score
