"""Boosted trees, one after another, until a window is no person any more.

A soft cascade (Bourdev and Brandt, CVPR 2005): after each tree, whoever has less than nearly all people have
by then is let go.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.detector.channels import Cells
from peopleboy.tracker.detector.patches import Layouts, Patches, Sums, patch
from peopleboy.tracker.detector.window import COLUMNS, ROWS

DEPTH: Final = 3
NODES: Final = 2**DEPTH - 1
LEAVES: Final = 2**DEPTH
STRIDE: Final = 2  # [cells] between windows of the first look
_EARLY: Final = 32
"""Trees that nearly no window comes through."""
PROMISING: Final = 256
"""Trees: beside windows that come through so many there may be a better one."""

_BESIDE: Final = (5, 2)
"""Rows and columns up to which windows show mostly the same."""
_WORSE: Final = 3.0  # log odds; a twentieth of the weight


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

    def take(self, these: NDArray[np.bool_]) -> Hits:
        """Return some of them."""
        return Hits(self.row[these], self.column[these], self.score[these])

    def best(self) -> Hits:
        """Return those that count: beside one that is much surer others hardly matter."""
        is_kept = np.empty(len(self.score), np.bool_)
        _compare(*self, is_kept)
        return self.take(is_kept)


@dataclass(frozen=True, slots=True, eq=False)
class Cascade:
    """Trees of depth 3, of which each node sends a window to the right if its patch is above a threshold.

    Attributes:
        patches: all that nodes ask for.
        feature: (T, 7) int32 number of a patch by node, those of one depth after another: 2 k + 1 and
            2 k + 2 follow k.
        threshold: (T, 7) float32.
        leaf: (T, 8) float32, what each leaf adds to the score.
        least: (T,) float32 score below which a window is let go after that tree.
    """

    patches: Patches
    feature: NDArray[np.int32]
    threshold: NDArray[np.float32]
    leaf: NDArray[np.float32]
    least: NDArray[np.float32]
    _layouts: Layouts = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Keep where patches lie."""
        object.__setattr__(self, "_layouts", Layouts(self.patches, self.feature))

    def scan(
        self,
        sums: Sums,
        rows: tuple[int, int],
        is_known: NDArray[np.bool_] | None = None,
        *,
        stride: int = STRIDE,
        promising: int = PROMISING,
    ) -> Hits:
        """Look through all windows of a level, with their first cell in some rows, borders included.

        Args:
            sums: (9, h + 1, w + 1) of its channels.
            rows: the first one, and the one after the last.
            is_known: (h - 19, w - 9) of windows by their first cell, at which nobody looks; None for none.
            stride: cells between windows; with 2 and more, those beside a promising one are looked at, too.
            promising: how many trees such a one must come through.
        """
        _, high, wide = sums.shape
        first, end = max(rows[0], 0), min(rows[1], high - ROWS)
        if end <= first or wide - 1 < COLUMNS:
            return Hits(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0))
        offset, weight = self._layouts.of(sums)
        found = np.full((end - first, wide - COLUMNS), -np.inf, np.float32)
        is_passed = np.zeros(found.shape, np.bool_) if is_known is None else is_known[first:end]
        _scan(
            sums.ravel(), wide, first, offset, weight, self.threshold.ravel(), self.leaf.ravel(), self.least,
            stride, min(promising, len(self.least)), is_passed, found,
        )  # fmt: skip
        at_row, at_column = np.nonzero(found > -np.inf)
        return Hits(at_row + first, at_column, found[at_row, at_column].astype(np.float64))

    def calibrated(self, gain: float, offset: float) -> Cascade:
        """Return the same trees with scores times a gain plus an offset."""
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
    """Return the leaf (0 to 7) of a window that begins at a place, in the tree with nodes from one on."""
    node = np.uint32(0)
    for _ in range(DEPTH):
        seen = patch(sums, at, offset[nodes + node], weight[nodes + node])
        is_right = seen > threshold[nodes + node]
        node = np.uint32(2) * node + np.uint32(1) + np.uint32(is_right)
    return node - np.uint32(NODES)


@njit(cache=True, nogil=True)
def _scan(
    sums: Sums,
    wide: int,
    first: int,
    offset: NDArray[np.uint32],
    weight: Cells,
    threshold: Cells,
    leaf: Cells,
    least: Cells,
    stride: int,
    promising: int,
    is_passed: NDArray[np.bool_],
    found: Cells,
) -> None:  # pragma: no cover
    """Look at every so many windows, then at those beside promising ones; leave their scores.

    Rows are kept apart while many are let go, of windows that read what is near; then few are left, and all
    of a level go through a tree at once, as trees take more room than what they read.
    """
    rows, columns = found.shape
    early = min(_EARLY, promising)
    at, score = np.empty(rows * columns, np.uint32), np.empty(rows * columns, np.float32)
    is_wanted = np.zeros((rows, columns), np.bool_)
    none: int = np.int64(0)  # type: ignore[assignment]  # called with a literal, kernels would be compiled for it, too
    left = none
    for i in range(0, rows, stride):
        count = none
        for j in range(0, columns, stride):
            at[left + count], score[left + count] = (i + first) * wide + j, 0.0
            count += not is_passed[i, j]
        some, theirs = at[left : left + count], score[left : left + count]
        left += _walk(sums, some, theirs, count, offset, weight, threshold, leaf, least[:early], none)
    left = _walk(sums, at, score, left, offset, weight, threshold, leaf, least[:promising], early)
    for k in range(left):
        row, column = np.int64(at[k]) // wide - first, np.int64(at[k]) % wide
        top, begin = max(row - stride + 1, 0), max(column - stride + 1, 0)
        is_wanted[top : min(row + stride, rows), begin : min(column + stride, columns)] = True
    left = _walk(sums, at, score, left, offset, weight, threshold, leaf, least, promising)
    for k in range(left):
        found[np.int64(at[k]) // wide - first, np.int64(at[k]) % wide] = score[k]
    left = none
    for i in range(rows):
        for j in range(columns):
            if is_wanted[i, j] and not is_passed[i, j] and (i % stride != 0 or j % stride != 0):
                at[left], score[left] = (i + first) * wide + j, 0.0
                left += 1
    left = _walk(sums, at, score, left, offset, weight, threshold, leaf, least, none)
    for k in range(left):
        found[np.int64(at[k]) // wide - first, np.int64(at[k]) % wide] = score[k]


@njit(cache=True, nogil=True)
def _compare(
    row: NDArray[np.int64], column: NDArray[np.int64], score: NDArray[np.float64], is_kept: NDArray[np.bool_]
) -> None:  # pragma: no cover
    """Return which windows are not much worse than one beside them."""
    rows, columns = _BESIDE
    for k in range(len(row)):
        is_kept[k] = True
        for j in range(len(row)):
            is_near = abs(row[j] - row[k]) <= rows and abs(column[j] - column[k]) <= columns
            if is_near and score[k] < score[j] - _WORSE:
                is_kept[k] = False


@njit(cache=True, nogil=True)
def _walk(
    sums: Sums,
    at: NDArray[np.uint32],
    score: Cells,
    count: int,
    offset: NDArray[np.uint32],
    weight: Cells,
    threshold: Cells,
    leaf: Cells,
    least: Cells,
    begin: int,
) -> int:  # pragma: no cover
    """Take windows that begin at places in sums through trees from one on; move those left to the front.

    All windows go through a tree before the next one: none waits for what another one reads.
    """
    for tree in range(begin, len(least)):
        kept = 0
        nodes, leaves, limit = np.uint32(tree * NODES), np.uint32(tree * LEAVES), least[tree]
        for k in range(count):
            total = score[k] + leaf[leaves + find_leaf(sums, at[k], offset, weight, threshold, nodes)]
            at[kept], score[kept] = at[k], total
            kept += total >= limit
        count = kept
        if count == 0:
            break
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
