"""The two boxes that a person is known by: the head, and the torso at a fixed place below it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.tracker.attention.feature_maps import CELL_PX
from peopleboy.tracker.track import Box

LEAST_CELLS: Final = 2
"""Side of a part below which nothing can be learned of it."""


@dataclass(frozen=True, slots=True)
class Part:
    """Where a part is in a box from head to feet; all in the box's heights, from the middle of its top.

    Attributes:
        top: its upper border.
        width, height: its size.
    """

    top: float
    width: float
    height: float


HEAD: Final = Part(top=0.0, width=0.125, height=0.125)
TORSO: Final = Part(top=0.18, width=0.185, height=0.30)


@dataclass(frozen=True, slots=True)
class Cells:
    """A rectangle of cells, `row` and `column` being those of its upper left one."""

    row: int
    column: int
    height: int
    width: int

    def is_inside(self, rows: int, columns: int) -> bool:
        """Tell whether all of it is inside an image of so many cells."""
        return (
            min(self.row, self.column) >= 0
            and self.row + self.height <= rows
            and self.column + self.width <= columns
        )


def cells_of(part: Part, box: Box, scale: float = 1.0) -> Cells:
    """Give the cells of a part of a person with this box [px] from head to feet.

    Args:
        part: which one.
        box: left, top, width, height; its width does not count.
        scale: by how much the person is larger, about the middle of the upper border.
    """
    left, top, width, height = box
    tall = height * scale
    middle = left + width / 2.0
    return Cells(
        row=round((top + part.top * tall) / CELL_PX),
        column=round((middle - part.width * tall / 2.0) / CELL_PX),
        height=max(LEAST_CELLS, round(part.height * tall / CELL_PX)),
        width=max(LEAST_CELLS, round(part.width * tall / CELL_PX)),
    )


def check_box(box: Box, shape: tuple[int, ...]) -> None:
    """Refuse a box of whom head or torso are not in an image of this shape.

    Raises:
        BadInput: they are not, or the box is none.
    """
    rows, columns = shape[0] // CELL_PX, shape[1] // CELL_PX
    is_box = len(box) == 4 and all(abs(number) < 1e6 for number in box) and box[2] > 0 and box[3] > 0
    if not is_box or not all(cells_of(part, box).is_inside(rows, columns) for part in (HEAD, TORSO)):
        numbers = ", ".join(f"{number:g}" for number in box)
        raise BadInput(
            f"attention: head and torso of box ({numbers}) must be inside the image, {shape[1]} x {shape[0]}"
        )
