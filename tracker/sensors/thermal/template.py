"""Template of a person in one image, by which the following images locate the person.

A cheap step between two runs of the networks: normalised cross-correlation of a small picture (Lewis, Fast
Normalized Cross-Correlation, 1995), at the predicted size.
"""

from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.frame import Floats

Grey = NDArray[np.uint8]

_HEIGHT: Final = 40  # cells from head to feet
_ABOVE: Final = 2  # cells above the head
_ROWS: Final = 34  # down to the knees: legs change from image to image
_WIDER: Final = 1.35  # than the box, which is as wide as the torso: the outline has the most contrast
_FEWEST: Final = 6  # columns
_MARGIN: Final = 5  # cells by which a person may be off the prediction
_FLAT: Final = 1.0  # greys; less contrast cannot be located


@dataclass(frozen=True, slots=True, eq=False)
class Template:
    """A small image of one person.

    Attributes:
        cells: (34, C) greys, 40 cells a height, down to the knees.
        ratio: width of the box over its height.
        is_flat: whether it has too little contrast to be located again.
    """

    cells: Grey
    ratio: float
    is_flat: bool

    @classmethod
    def of(cls, grey: Grey, box: Floats) -> "Template":
        """Cut the template from a box (4,) of an image (H, W)."""
        ratio = float(box[2] / box[3])
        cells = _cells(grey, box, _columns(ratio), 0)
        return cls(cells, ratio, float(cv2.meanStdDev(cells)[1][0, 0]) < _FLAT)

    def found(self, grey: Grey, expected: Floats, least: float) -> Floats | None:
        """Locate the template in an image (H, W).

        Args:
            grey: the image.
            expected: (4,) the predicted box [px].
            least: least correlation, up to 1, of a match.

        Returns:
            (4,) a box of the predicted height; None without a match nearby.
        """
        if self.is_flat:
            return None
        around = _cells(grey, expected, self.cells.shape[1], _MARGIN)
        match = cv2.matchTemplate(around, self.cells, cv2.TM_CCOEFF_NORMED)
        row, column = (int(place) for place in np.unravel_index(match.argmax(), match.shape))
        is_inside = 0 < row < 2 * _MARGIN and 0 < column < 2 * _MARGIN
        if not is_inside or match[row, column] < least:
            return None
        right = column - _MARGIN + _peak(*match[row, column - 1 : column + 2].tolist())
        down = row - _MARGIN + _peak(*match[row - 1 : row + 2, column].tolist())
        left, top, width, height = expected.tolist()
        cell_px, wide_px = height / _HEIGHT, self.ratio * height
        middle = left + width / 2.0 + right * cell_px
        return np.array([middle - wide_px / 2.0, top + down * cell_px, wide_px, height])


def _columns(ratio: float) -> int:
    return max(_FEWEST, round(_WIDER * ratio * _HEIGHT))


def _cells(grey: Grey, box: Floats, columns: int, margin: int) -> Grey:
    """Sample the greys in a box, with a margin of some cells."""
    left, top, width, height = box.tolist()
    cell_px = height / _HEIGHT
    first_x = left + width / 2.0 + (0.5 - columns / 2.0 - margin) * cell_px
    first_y = top + (0.5 - _ABOVE - margin) * cell_px
    to_image = np.array([[cell_px, 0.0, first_x], [0.0, cell_px, first_y]])
    size = (columns + 2 * margin, _ROWS + 2 * margin)
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    return np.asarray(
        cv2.warpAffine(grey, to_image, size, flags=flags, borderMode=cv2.BORDER_REPLICATE), np.uint8
    )


def _peak(before: float, here: float, after: float) -> float:
    """Return the vertex, from -0.5 to 0.5, of the parabola through three neighbours, the middle one at 0."""
    bend = before - 2.0 * here + after
    return 0.0 if bend >= 0.0 else min(max(0.5 * (before - after) / bend, -0.5), 0.5)
