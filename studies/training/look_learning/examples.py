"""What networks that look at crops learn from."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.proposals.looks.crops import NUMBERS, PLANES, Crops, CropSize, Planes
from peopleboy.tracker.proposals.placing import OFFSETS


class LookExamples(NamedTuple):
    """What is learned from.

    Attributes:
        crops: (N, rows, columns, 3) uint8.
        numbers: (N, 9), see `crops.numbers_of`.
        overlap: (N,) IoU with somebody who is seen, at most.
        offsets: (N, 4) of them, see `placing.offsets`; 0 if there is nobody.
    """

    crops: Crops
    numbers: Planes
    overlap: NDArray[np.float32]
    offsets: Planes

    @classmethod
    def joined(cls, parts: Iterable[LookExamples], size: CropSize) -> LookExamples:
        """Take examples together, of which crops are of a size."""
        none = cls(
            np.empty((0, size.rows, size.columns, PLANES), np.uint8),
            np.empty((0, NUMBERS), np.float32),
            np.empty(0, np.float32),
            np.empty((0, OFFSETS), np.float32),
        )
        return cls(*(np.concatenate(column) for column in zip(none, *parts, strict=True)))

    def take(self, rows: NDArray[np.intp]) -> LookExamples:
        """Give some of them."""
        return LookExamples(self.crops[rows], self.numbers[rows], self.overlap[rows], self.offsets[rows])

    def mirrored(self) -> LookExamples:
        """Swap left and right."""
        numbers, offset = self.numbers.copy(), self.offsets.copy()
        numbers[:, 4:6] = self.numbers[:, [5, 4]]
        offset[:, 0] *= -1.0
        return LookExamples(self.crops[:, :, ::-1], numbers, self.overlap, offset)
