"""The patches that trees may choose from: every cell of a window, and many rectangles and pairs of them."""

from __future__ import annotations

from typing import Final

import numpy as np

from peopleboy.tracker.proposals.channels import CHANNELS
from peopleboy.tracker.proposals.patches import Patches
from peopleboy.tracker.proposals.window import COLUMNS, ROWS

Box = tuple[int, int, int, int]

DRAWN: Final = 6000
_GROWS: Final = (0.25, 0.35)  # chance that a rectangle has no more rows, columns
_MOST_ROWS: Final = 16
_ALONE: Final = 0.25  # of what is drawn
_BESIDE: Final = 0.35  # likewise, of equal size beside, above or below each other
_MIRRORED: Final = 0.2  # likewise; the rest lie anywhere
_NOTHING: Final = (0, 0, 0, 0)
_SEED: Final = 5


def patch_pool(drawn: int = DRAWN) -> Patches:
    """Give every cell of every channel, and so many rectangles and pairs drawn at random; always the same."""
    rng = np.random.default_rng(_SEED)
    cells = [(row, column, row + 1, column + 1) for row in range(ROWS) for column in range(COLUMNS)]
    first, second = cells * CHANNELS, [_NOTHING] * (len(cells) * CHANNELS)
    channel = [number for number in range(CHANNELS) for _ in cells]
    for _ in range(drawn):
        box = _rectangle(rng)
        channel.append(int(rng.integers(CHANNELS)))
        first.append(box)
        second.append(_partner(box, rng))
    return Patches(*(np.array(column, np.uint8) for column in (channel, first, second)))


def _rectangle(rng: np.random.Generator) -> Box:
    rows, columns = (1 + int(rng.geometric(chance)) for chance in _GROWS)
    rows, columns = min(rows, _MOST_ROWS), min(columns, COLUMNS)
    row, column = int(rng.integers(ROWS - rows + 1)), int(rng.integers(COLUMNS - columns + 1))
    return row, column, row + rows, column + columns


def _partner(box: Box, rng: np.random.Generator) -> Box:
    """Draw what is taken off a rectangle."""
    top, left, bottom, right = box
    kind = rng.random()
    if kind < _ALONE:
        return _NOTHING
    if kind < _ALONE + _BESIDE:
        rows, columns = bottom - top, right - left
        moves = [(rows, 0), (-rows, 0), (0, columns), (0, -columns)]
        beside = [(top + down, left + on, bottom + down, right + on) for down, on in moves]
        inside = [one for one in beside if min(one) >= 0 and one[2] <= ROWS and one[3] <= COLUMNS]
        return inside[int(rng.integers(len(inside)))] if inside else _NOTHING
    if kind < _ALONE + _BESIDE + _MIRRORED:
        mirrored = (top, COLUMNS - right, bottom, COLUMNS - left)
        return _NOTHING if mirrored == box else mirrored
    return _rectangle(rng)
