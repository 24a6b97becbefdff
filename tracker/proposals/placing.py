"""Where exactly in a window somebody is: boosted trees that move and size its box."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.proposals.cascade import DEPTH, NODES
from peopleboy.tracker.proposals.channels import Cells
from peopleboy.tracker.proposals.patches import Layouts, Patches, Sums, patch
from peopleboy.tracker.proposals.window import Floats

OFFSETS: Final = 4
"""Numbers that tell a person's box from its window: see `offsets`."""


@dataclass(frozen=True, slots=True, eq=False)
class Placing:
    """Trees for each of the numbers.

    Attributes:
        patches: all that nodes ask for.
        feature: (4, T, 7) int32, as in a `Cascade`.
        threshold: (4, T, 7) float32.
        leaf: (4, T, 8) float32; the sum of what all trees say is the number.
    """

    patches: Patches
    feature: NDArray[np.int32]
    threshold: NDArray[np.float32]
    leaf: NDArray[np.float32]
    _layouts: Layouts = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Keep where patches lie."""
        object.__setattr__(self, "_layouts", Layouts(self.patches, self.feature))

    def boxes(self, sums: Sums, row: NDArray[np.int64], column: NDArray[np.int64], window: Floats) -> Floats:
        """Give the boxes (N, 4) of those who fill windows that begin in some cells, with boxes (N, 4)."""
        told = np.empty((len(row), OFFSETS), np.float32)
        at = row * sums.shape[2] + column
        _place(sums.ravel(), at, *self._layouts.of(sums), self.threshold.ravel(), self.leaf, told)
        return moved(window, told.astype(np.float64))


def offsets(window: Floats, box: Floats) -> Floats:
    """Tell boxes (N, 4) from those of their windows (N, 4).

    Returns:
        (N, 4) of the middle to the right and the top down, in heights of the window, the logarithm of the
        height over the window's, and the width in heights of the window.
    """
    height = window[:, 3]
    aside = box[:, 0] + box[:, 2] / 2.0 - window[:, 0] - window[:, 2] / 2.0
    return np.stack(
        [aside / height, (box[:, 1] - window[:, 1]) / height, np.log(box[:, 3] / height), box[:, 2] / height],
        axis=1,
    )


def moved(window: Floats, told: Floats) -> Floats:
    """Give the boxes (N, 4) that are told from those of windows (N, 4) by `offsets` (N, 4)."""
    height = window[:, 3]
    width = told[:, 3] * height
    middle = window[:, 0] + window[:, 2] / 2.0 + told[:, 0] * height
    return np.stack(
        [middle - width / 2.0, window[:, 1] + told[:, 1] * height, width, height * np.exp(told[:, 2])], axis=1
    )


@njit(cache=True, nogil=True)
def _place(
    sums: Sums,
    begin: NDArray[np.int64],
    offset: NDArray[np.uint32],
    weight: Cells,
    threshold: Cells,
    leaf: Cells,
    told: Cells,
) -> None:  # pragma: no cover
    """Add up what trees say, one after the other, of all windows: trees take more room than windows."""
    trees = leaf.shape[1]
    told[:] = 0.0
    for offset_of in range(leaf.shape[0]):
        for tree in range(trees):
            nodes = (offset_of * trees + tree) * NODES
            for number in range(len(begin)):
                at = np.uint32(begin[number])
                node = 0
                for _ in range(DEPTH):
                    corner, by = offset[nodes + node], weight[nodes + node]
                    seen = patch(sums, at, corner, by)
                    node = 2 * node + 1 + (seen > threshold[nodes + node])
                told[number, offset_of] += leaf[offset_of, tree, node - NODES]
