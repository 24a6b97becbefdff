"""What is proposed in one image, and how it looks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.by_detection.colours import FEATURES, Colours, coefficients, colours_of
from peopleboy.tracker.by_detection.looks import SAMPLES, Pattern, patterns
from peopleboy.tracker.by_detection.target import Target
from peopleboy.tracker.by_detection.viewpoint import Viewpoint
from peopleboy.tracker.frame import THERMAL, Floats, Frame
from peopleboy.tracker.proposals.suppression import Proposals


@dataclass(frozen=True, slots=True, eq=False)
class Proposed:
    """M proposals.

    Attributes:
        boxes: (M, 4) [px].
        scores: (M,) log odds.
        trees: (M,) likewise, as the detector's trees see it alone.
        looks: (M, 72) in the thermal image; 0 of those who are followed.
        colours: (M, 512) of clothes; 0 of those, too, and where nobody knows.
    """

    boxes: Floats
    scores: Floats
    trees: Floats
    looks: Pattern
    colours: Colours

    @classmethod
    def of(cls, frame: Frame, found: Proposals, view: Viewpoint, followed: int = 0) -> Proposed:
        """Look at what is proposed in a frame, but for the last few, who are followed."""
        count = len(found.box)
        looks, colours = np.zeros((count, SAMPLES), np.float32), np.zeros((count, FEATURES), np.float32)
        new = slice(count - followed)
        if followed < count:
            looks[new] = patterns(frame.grey(THERMAL).astype(np.float32), found.box[new])
            colours[new] = colours_of(frame, found.box[new], view)
        return cls(*found, looks, colours)

    def __len__(self) -> int:
        return len(self.boxes)

    def without_colours(self, rows: NDArray[np.bool_]) -> Proposed:
        """Give these, nothing told of the colours of some (M,), which may be another one's."""
        return replace(self, colours=np.where(rows[:, None], np.float32(0.0), self.colours))

    def likeness(self, targets: list[Target]) -> tuple[Floats, NDArray[np.bool_]]:
        """Tell how alike K targets and these are.

        Returns:
            (K, M) -1 to 1, by colours where they are known, else by warmth, and whether they are (K, M).
            Colours of the same clothes are mostly above 0.6, and of others below -0.2; warmth tells little.
        """
        warm = np.stack([target.looks for target in targets]) @ self.looks.T
        worn = np.stack([target.colours for target in targets])
        same, is_known = coefficients(worn, self.colours)
        return np.where(is_known, 2.0 * same - 1.0, warm).astype(np.float64), is_known

    def ratio(self, row: int) -> float:
        """Give the width of a box over its height."""
        return float(self.boxes[row, 2] / self.boxes[row, 3])
