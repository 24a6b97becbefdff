"""Box regression: boosted trees that predict where in a window the person is."""

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.sensors.thermal.detector.cascade import NODES, find_leaf
from peopleboy.tracker.sensors.thermal.detector.channels import Cells
from peopleboy.tracker.sensors.thermal.detector.patches import Layouts, Patches, Sums
from peopleboy.tracker.sensors.thermal.detector.window import Floats

OFFSETS: Final = 4
"""Numbers that encode a person's box relative to its window: see `encode_boxes`."""


@dataclass(frozen=True, slots=True, eq=False)
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
    _layouts: Layouts = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Keep where patches lie."""
        object.__setattr__(self, "_layouts", Layouts(self.patches, self.feature))

    def boxes(self, sums: Sums, row: NDArray[np.int64], column: NDArray[np.int64], window: Floats) -> Floats:
        """Return the boxes (N, 4) of the people in windows that begin in some cells and have boxes (N, 4)."""
        offsets = np.empty((len(row), OFFSETS), np.float32)
        at = row * sums.shape[2] + column
        _place(sums.ravel(), at, *self._layouts.of(sums), self.threshold.ravel(), self.leaf, offsets)
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
    sums: Sums,
    begin: NDArray[np.int64],
    offset: NDArray[np.uint32],
    weight: Cells,
    threshold: Cells,
    leaf: Cells,
    result: Cells,
) -> None:  # pragma: no cover
    """Add up all trees, one after the other for all windows: trees take more memory than windows."""
    trees = leaf.shape[1]
    result[:] = 0.0
    for offset_of in range(leaf.shape[0]):
        for tree in range(trees):
            nodes = np.uint32((offset_of * trees + tree) * NODES)
            for number in range(len(begin)):
                at = np.uint32(begin[number])
                end = find_leaf(sums, at, offset, weight, threshold, nodes)
                result[number, offset_of] += leaf[offset_of, tree, end]
