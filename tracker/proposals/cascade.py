"""Boosted trees, one after another, until a window is no person any more.

A soft cascade (Bourdev and Brandt, CVPR 2005): after each tree, whoever has less than nearly all people have
by then is let go.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.proposals.channels import CHANNELS, Cells
from peopleboy.tracker.proposals.window import COLUMNS, ROWS

DEPTH: Final = 3
NODES: Final = 2**DEPTH - 1
LEAVES: Final = 2**DEPTH
FEATURES: Final = CHANNELS * ROWS * COLUMNS
"""Of a window, by channel, row and column."""

STRIDE: Final = 2  # [cells] between windows of the first look
_LOOKED: Final = 64
"""Trees that a window must come through for those beside it to be looked at, too."""


class Hits(NamedTuple):
    """Windows that came through.

    Attributes:
        row: (N,) of the first cell, among those with the border.
        column: (N,) likewise.
        score: (N,) sum of all trees.
    """

    row: NDArray[np.int64]
    column: NDArray[np.int64]
    score: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Cascade:
    """Trees of depth 3, of which each node sends a window to the right if its feature is above a threshold.

    Attributes:
        feature: (T, 7) int32 by node, those of one depth after another: 2 k + 1 and 2 k + 2 follow k.
        threshold: (T, 7) float32.
        leaf: (T, 8) float32, what each leaf adds to the score.
        least: (T,) float32 score below which a window is let go after that tree.
    """

    feature: NDArray[np.int32]
    threshold: NDArray[np.float32]
    leaf: NDArray[np.float32]
    least: NDArray[np.float32]

    def scan(self, cells: Cells, rows: tuple[int, int], *, stride: int = STRIDE) -> Hits:
        """Look through all windows of a level, with their first cell in some rows, borders included.

        Args:
            cells: (9, h, w) channels.
            rows: the first one, and the one after the last.
            stride: cells between windows; with 2 and more, those beside a promising one are looked at, too.
        """
        _, high, wide = cells.shape
        first, end = max(rows[0], 0), min(rows[1], high - ROWS + 1)
        if end <= first or wide < COLUMNS:
            return Hits(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))
        offset = np.empty(self.feature.size, np.uint32)
        _place(self.feature.ravel(), high, wide, offset)
        found = np.full((end - first, wide - COLUMNS + 1), -np.inf, np.float32)
        _scan(
            cells.ravel(), wide, first, offset, self.threshold.ravel(), self.leaf.ravel(), self.least,
            stride, found,
        )  # fmt: skip
        at_row, at_column = np.nonzero(found > -np.inf)
        return Hits(at_row + first, at_column, found[at_row, at_column].astype(np.float64))

    def calibrated(self, gain: float, offset: float) -> Cascade:
        """Give the same trees with scores times a gain plus an offset."""
        leaf = self.leaf * np.float32(gain)
        leaf[0] += np.float32(offset)
        least = self.least * np.float32(gain) + np.float32(offset)
        return Cascade(self.feature, self.threshold, leaf, least)

    def running(self, features: NDArray[np.float32]) -> NDArray[np.float32]:
        """Give the scores (N, T) after each tree of windows (N, 1800)."""
        scores = np.empty((len(features), len(self.feature)), np.float32)
        _run(features, self.feature, self.threshold, self.leaf, scores)
        return scores


@njit(cache=True, nogil=True)
def _place(
    feature: NDArray[np.int32], high: int, wide: int, offset: NDArray[np.uint32]
) -> None:  # pragma: no cover
    """Tell how far behind a window's first cell each feature is, in a level of that size."""
    for k in range(len(feature)):
        channel, within = divmod(feature[k], ROWS * COLUMNS)
        row, column = divmod(within, COLUMNS)
        offset[k] = channel * high * wide + row * wide + column


@njit(cache=True, nogil=True)
def _scan(
    cells: Cells,
    wide: int,
    first: int,
    offset: NDArray[np.uint32],
    threshold: Cells,
    leaf: Cells,
    least: Cells,
    stride: int,
    found: Cells,
) -> None:  # pragma: no cover
    """Look at every so many windows, then at those beside promising ones; leave their scores."""
    rows, columns = found.shape
    score, left = np.empty(columns, np.float32), np.empty(columns, np.uint32)
    is_wanted = np.zeros((rows, columns), np.bool_)
    for i in range(0, rows, stride):
        count = 0
        for j in range(0, columns, stride):
            left[count] = j
            count += 1
        base = (i + first) * wide
        count = _walk(cells, base, left, count, offset, threshold, leaf, least, 0, _LOOKED, score)
        for k in range(count):
            top, bottom = max(i - stride + 1, 0), min(i + stride, rows)
            begin = max(np.int64(left[k]) - stride + 1, 0)
            is_wanted[top:bottom, begin : min(np.int64(left[k]) + stride, columns)] = True
        count = _walk(cells, base, left, count, offset, threshold, leaf, least, _LOOKED, len(least), score)
        for k in range(count):
            found[i, left[k]] = score[left[k]]
    for i in range(rows):
        count = 0
        for j in range(columns):
            if is_wanted[i, j] and (i % stride != 0 or j % stride != 0):
                left[count] = j
                count += 1
        base = (i + first) * wide
        count = _walk(cells, base, left, count, offset, threshold, leaf, least, 0, len(least), score)
        for k in range(count):
            found[i, left[k]] = score[left[k]]


@njit(cache=True, nogil=True)
def _walk(
    cells: Cells,
    base: int,
    left: NDArray[np.uint32],
    count: int,
    offset: NDArray[np.uint32],
    threshold: Cells,
    leaf: Cells,
    least: Cells,
    start: int,
    end: int,
    score: Cells,
) -> int:  # pragma: no cover
    """Take windows of a row through some trees, and keep those that are left; give how many.

    All windows go through a tree before the next one: none waits for what another one reads.
    """
    if start == 0:
        score[:] = 0.0
    for tree in range(start, min(end, len(least))):
        kept = 0
        nodes, leaves, limit = np.uint32(tree * NODES), np.uint32(tree * LEAVES), least[tree]
        for k in range(count):
            window = left[k]
            at = np.uint32(base) + window
            node = np.uint32(0)
            for _ in range(DEPTH):
                is_right = cells[at + offset[nodes + node]] > threshold[nodes + node]
                node = np.uint32(2) * node + np.uint32(1) + np.uint32(is_right)
            total = score[window] + leaf[leaves + node - np.uint32(NODES)]
            score[window] = total
            left[kept] = window
            kept += total >= limit
        count = kept
        if count == 0:
            break
    return count


@njit(cache=True, nogil=True)
def _run(
    features: Cells, feature: NDArray[np.int32], threshold: Cells, leaf: Cells, scores: Cells
) -> None:  # pragma: no cover
    for i in range(len(features)):
        score = np.float32(0.0)
        for tree in range(len(feature)):
            node = 0
            for _ in range(DEPTH):
                node = 2 * node + 1 + (features[i, feature[tree, node]] > threshold[tree, node])
            score += leaf[tree, node - NODES]
            scores[i, tree] = score
