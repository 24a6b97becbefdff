"""Box regression: boosted trees that predict where in a window the person is."""

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.sensors.thermal.detector.channels import Cells
from peopleboy.tracker.sensors.thermal.detector.patches import Patches, Sums
from peopleboy.tracker.sensors.thermal.detector.vector_trees import (
    LANES,
    LEAVES,
    PACKED,
    Trees,
    add_tree,
    pack,
)
from peopleboy.tracker.sensors.thermal.detector.window import Floats

OFFSETS: Final = 4
"""Numbers that encode a person's box relative to its window: see `encode_boxes`."""


@dataclass(frozen=True, eq=False)
class BoxRegression:
    """Trees for each of the offsets.

    Attributes:
        patches: all patches that the nodes use.
        feature: (4, T, 7) int32, as in a `Cascade`.
        threshold: (4, T, 7) float32.
        leaf: (4, T, 8) float32; the sum over all trees is the offset.
    """

    patches: Patches
    feature: NDArray[np.int32]
    threshold: NDArray[np.float32]
    leaf: NDArray[np.float32]

    @cached_property
    def _packed(self) -> Trees:
        """The trees for packed windows."""
        return Trees.packed(self.patches, self.feature, self.threshold, self.leaf)

    def boxes(self, sums: Sums, row: NDArray[np.int64], column: NDArray[np.int64], window: Floats) -> Floats:
        """Return the boxes (N, 4) of the people in windows that begin in some cells and have boxes (N, 4)."""
        _, high, wide = sums.shape
        offsets = np.empty((len(row), OFFSETS), np.float32)
        _place(sums.ravel(), high, wide, (row * wide + column).astype(np.uint64), self._packed, offsets)
        return decode_boxes(window, offsets.astype(np.float64))


def encode_boxes(window: Floats, box: Floats) -> Floats:
    """Encode boxes (N, 4) relative to those of their windows (N, 4).

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


def decode_boxes(window: Floats, offsets: Floats) -> Floats:
    """Return the boxes (N, 4) with these offsets (N, 4) from windows (N, 4)."""
    height = window[:, 3]
    width = offsets[:, 3] * height
    middle = window[:, 0] + window[:, 2] / 2.0 + offsets[:, 0] * height
    return np.stack(
        [middle - width / 2.0, window[:, 1] + offsets[:, 1] * height, width, height * np.exp(offsets[:, 2])],
        axis=1,
    )


@njit(cache=True, nogil=True)
def _place(
    sums: Sums, high: int, wide: int, at: NDArray[np.uint64], trees: Trees, result: Cells
) -> None:  # pragma: no cover
    """Add up the trees of each offset, for windows at positions in sums of `high` by `wide`."""
    packed, total = np.empty(PACKED, np.int32), np.empty(LANES, np.float32)
    each = len(trees.leaf) // (LEAVES * OFFSETS)
    for first in range(0, len(at), LANES):
        eight = at[first : first + LANES]
        pack(sums, high, wide, eight, packed)
        for offset in range(OFFSETS):
            total[:] = 0.0
            for tree in range(offset * each, offset * each + each):
                add_tree(packed, np.uint64(0), trees, np.uint64(tree), np.float32(0.0), total)
            for lane in range(len(eight)):
                result[first + lane, offset] = total[lane]
