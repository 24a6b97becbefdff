"""Image pyramid: the sizes at which people of each size fill a window."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.networks.convolution import Buffer
from peopleboy.tracker.sensors.thermal.detector.channels import BESIDE, OVER, Cells, Image, channels, noise_of
from peopleboy.tracker.sensors.thermal.detector.window import (
    CELL_PX,
    COLUMNS,
    PERSON_PX,
    ROWS,
    Floats,
    WindowKind,
    boxes_of,
    cells_of,
    row_of,
)

STEP: Final = 2.0 ** (1.0 / 3.0)
"""Ratio of the sizes of people of consecutive levels."""

_STATURES_M: Final = (1.4, 2.0)  # of detected people
_SLACK: Final = 0.15  # tolerance in a person's heights, for pitch, gait and the size of cells
_WHOLE_OVER: Final = 8
"""Rows of cells by which a window of a mostly visible person may extend beyond the image."""
_CUT_OVER: Final = (6, 9)
"""Rows above and below the image from which a window shows a truncated person."""
_CUT_PX: Final = 48.0  # height of the smallest truncated people that are detected
_LEAST_ROWS: Final = 7  # of cells in an image: a third of a window
_LEAST_WHOLE_ROWS: Final = 12  # the same for the larger part of a truncated person
_CONTEXT: Final = 12
"""Cells above and below a window that influence its channels."""


Rows = tuple[int, int]
"""The first row of a level's cells, and the one after the last."""


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """One size of the image.

    Attributes:
        cells: (9, h, w) channels of the searched rows and their surroundings, with a border.
        first: row of the first cell in the whole level, without the border.
        rows: ranges of rows of `cells` in which windows of a kind may start.
        scale: pixels of the level per pixel of the image, down and right.
    """

    cells: Cells
    first: int
    rows: Mapping[WindowKind, tuple[Rows, ...]]
    scale: tuple[float, float]

    def boxes(self, row: NDArray[np.int64], column: NDArray[np.int64]) -> Floats:
        """Return the boxes (N, 4) [px] of the people who fill windows, by their first cell in `cells`."""
        corner = np.stack([row + self.first - OVER, column - BESIDE]).astype(np.float64)
        return boxes_of(corner[0], corner[1], self.scale)

    def covered(self, box: Floats, share: float) -> NDArray[np.bool_]:
        """Return which windows (h - 19, w - 9) overlap one of boxes (K, 4) strongly.

        Windows are wider than people; their people are assumed to be as wide, in heights, as the compared
        box.

        Args:
            box: of people [px].
            share: least overlap in shares of the smaller box.
        """
        _, high, wide = self.cells.shape
        is_covered = np.zeros((max(high - ROWS + 1, 0), max(wide - COLUMNS + 1, 0)), np.bool_)
        first, second = self.boxes(np.arange(2), np.arange(2))
        _cover(box, first, second[:2] - first[:2], share, is_covered)
        return is_covered

    def windows(self, box: Floats) -> Floats:
        """Return row and column (N, 2) in `cells` of the windows that people with boxes (N, 4) fill."""
        return np.asarray(cells_of(box, self.scale) + np.array([OVER - self.first, BESIDE]), np.float64)


def pyramid_levels(
    grey: NDArray[np.uint8],
    change: NDArray[np.uint8],
    mount: Mount | None,
    smallest_px: float,
    buffer: Buffer | None = None,
) -> Iterator[Level]:
    """Yield the levels of an image's pyramid, the one for the smallest people first.

    Args:
        grey: (H, W) image.
        change: (H, W) change of the greys.
        mount: of the camera; if known, only rows in which people can stand are searched.
        smallest_px: height of the smallest people.
        buffer: memory of the channels; a level is valid until the next one is computed.
    """
    original = grey.astype(np.float32)
    image, changes = _Halves(original), _Halves(change.astype(np.float32))
    noise, person_px = noise_of(original), smallest_px
    rows, columns = grey.shape
    while True:
        scale = PERSON_PX / person_px
        high, wide = round(rows * scale / CELL_PX), round(columns * scale / CELL_PX)
        if high < _LEAST_ROWS or wide < COLUMNS:
            return
        down, right = CELL_PX * high / rows, CELL_PX * wide / columns
        start, end = _beginnings(mount, high, down)
        ranges = _ranges(start, end, high, person_px)
        if any(ranges.values()):
            start, end = _around(ranges)
            first, last = max(start - _CONTEXT, 0), min(end + ROWS + _CONTEXT, high)
            scaled = image.sized((CELL_PX * wide, CELL_PX * high), scale)
            changed = changes.sized((wide, high), scale / CELL_PX)
            cells = channels(
                scaled[CELL_PX * first : CELL_PX * last],
                changed[first:last],
                noise * min(1.0, scale),
                buffer,
            )
            yield Level(cells, first, _moved(ranges, OVER - first), (down, right))
        person_px *= STEP


def _ranges(start: int, end: int, high: int, person_px: float) -> dict[WindowKind, tuple[Rows, ...]]:
    """Return the rows in which windows of each kind start, within a range."""
    whole = [(-_WHOLE_OVER, high + _WHOLE_OVER - ROWS + 1)] if high >= _LEAST_WHOLE_ROWS else []
    cut = [(start, 1 - _CUT_OVER[0]), (high + _CUT_OVER[1] - ROWS, end)] if whole else [(start, end)]
    if person_px < _CUT_PX:
        cut = []
    return {WindowKind.WHOLE: _within(whole, start, end), WindowKind.CUT: _within(cut, start, end)}


def _within(ranges: list[Rows], start: int, end: int) -> tuple[Rows, ...]:
    parts = [(max(first, start), min(last, end)) for first, last in ranges]
    return tuple((first, last) for first, last in parts if first < last)


def _around(ranges: Mapping[WindowKind, tuple[Rows, ...]]) -> Rows:
    rows = [one for several in ranges.values() for one in several]
    return min(first for first, _ in rows), max(last for _, last in rows)


def _moved(ranges: Mapping[WindowKind, tuple[Rows, ...]], by: int) -> dict[WindowKind, tuple[Rows, ...]]:
    return {kind: tuple((a + by, b + by) for a, b in several) for kind, several in ranges.items()}


class _Halves:
    """An image at powers of one half, from which other sizes are computed without aliasing."""

    def __init__(self, image: Image) -> None:
        self._images = [image]

    def sized(self, size: tuple[int, int], scale: float) -> Image:
        """Return the image in another size (columns, rows), given its approximate scale."""
        return np.asarray(cv2.resize(self._at(scale), size), np.float32)

    def _at(self, scale: float) -> Image:
        """Return the smallest image that is large enough for a scale."""
        halvings = max(math.floor(-math.log2(scale) + 1e-9), 0)
        while len(self._images) <= halvings:
            rows, columns = self._images[-1].shape
            half = ((columns + 1) // 2, (rows + 1) // 2)
            smaller = cv2.resize(self._images[-1], half, interpolation=cv2.INTER_AREA)
            self._images.append(np.asarray(smaller, np.float32))
        return self._images[halvings]


def _beginnings(mount: Mount | None, high: int, down: float) -> tuple[int, int]:
    """Return the rows of cells in which windows may start, including those in the border."""
    everywhere = (-OVER, high + OVER - ROWS + 1)
    if mount is None:
        return everywhere
    # The feet of a standing person are as far below the horizon as the camera is high.
    height = PERSON_PX / down
    feet = [mount.horizon_px + height * mount.height_m / stature for stature in _STATURES_M]
    slack = _SLACK * PERSON_PX / CELL_PX
    upper, lower = row_of(min(feet) - height, down), row_of(max(feet) - height, down)
    start, end = math.floor(upper - slack), math.ceil(lower + slack) + 1
    return max(start, everywhere[0]), min(end, everywhere[1])


@njit(cache=True, nogil=True)
def _cover(
    boxes: Floats, first: Floats, step: Floats, share: float, is_covered: NDArray[np.bool_]
) -> None:  # pragma: no cover
    """Return which windows, given the first box (4,) and steps (2,) [px], overlap one of the boxes."""
    rows, columns = is_covered.shape
    wide, high = first[2], first[3]
    for left, top, width, height in boxes:
        narrow = width / height * high
        least = share * min(width * height, narrow * high)
        for i in range(rows):
            y = first[1] + i * step[1]
            down = min(y + high, top + height) - max(y, top)
            if down <= 0.0:
                continue
            for j in range(columns):
                x = first[0] + j * step[0] + (wide - narrow) / 2.0
                across = min(x + narrow, left + width) - max(x, left)
                is_covered[i, j] |= across * down > least
