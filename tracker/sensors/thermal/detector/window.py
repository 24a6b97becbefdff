"""Geometry of the detector's window: its cells, and the person inside it."""

from enum import StrEnum
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Top = TypeVar("Top", float, Floats)

CELL_PX: Final = 2  # side of a cell of a level of the pyramid
ROWS: Final = 20
COLUMNS: Final = 10
PERSON_PX: Final = 32.0  # height of the person in a window of 40 pixels, in pixels of its level
WIDTH_PER_HEIGHT: Final = 0.41  # of a person's box
ABOVE_PX: Final = (ROWS * CELL_PX - PERSON_PX) / 2.0
"""Margin of a window above the head and below the feet, in pixels of its level."""


class WindowKind(StrEnum):
    """Kinds of windows: people who are mostly in the image, or whose head or feet are outside."""

    WHOLE = "whole"
    CUT = "cut"


def row_of(top: Top, down: float) -> Top:
    """Return the row of the windows of people whose heads are at one or more rows of the image."""
    return ((top + 0.5) * down - ABOVE_PX) / CELL_PX


def boxes_of(row: Floats, column: Floats, scale: tuple[float, float]) -> Floats:
    """Return the boxes (N, 4) [px] of the people in windows.

    Args:
        row: (N,) of a window's first cell.
        column: (N,) column of the first cell.
        scale: pixels of the level per pixel of the image, down and right.
    """
    down, right = scale
    height = np.full(len(row), PERSON_PX / down)
    width = WIDTH_PER_HEIGHT * height
    middle = (column + COLUMNS / 2.0) * CELL_PX / right - 0.5
    top = (row * CELL_PX + ABOVE_PX) / down - 0.5
    return np.stack([middle - width / 2.0, top, width, height], axis=1)


def cells_of(box: Floats, scale: tuple[float, float]) -> Floats:
    """Return row and column (N, 2) of the windows that people with boxes (N, 4) fill, as fractions."""
    down, right = scale
    row = row_of(box[:, 1], down)
    column = (box[:, 0] + box[:, 2] / 2.0 + 0.5) * right / CELL_PX - COLUMNS / 2.0
    return np.stack([row, column], axis=1)
