"""Patches of 32 x 32 pixels at equal scale: anywhere, of background, and of people."""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.sim_to_real.clips import ROWS, ClipFrame, Grey

SIDE: Final = 32
"""Rows and columns of a patch."""

_ROOM: Final = 1.25  # sides of the square round a person, in heights of the person
_TRIES: Final = 12


def shrunk(grey: Grey) -> Grey:
    """Shrink a picture (H, W) to `ROWS` rows; every pixel becomes the mean of those that it covers."""
    factor = ROWS / grey.shape[0]
    width = round(grey.shape[1] * factor)
    return np.asarray(cv2.resize(grey, (width, ROWS), interpolation=cv2.INTER_AREA), np.uint8)


def covered(shape: tuple[int, ...], boxes: NDArray[np.float64], grown: float = 0.15) -> NDArray[np.bool_]:
    """Mark the pixels (H, W) in boxes (N, 4), each grown by a share of its size on every side."""
    mask = np.zeros(shape[:2], bool)
    for left, top, width, height in boxes:
        x0, y0 = left - grown * width, top - grown * height
        x1, y1 = left + (1.0 + grown) * width, top + (1.0 + grown) * height
        mask[max(int(y0), 0) : max(int(np.ceil(y1)), 0), max(int(x0), 0) : max(int(np.ceil(x1)), 0)] = True
    return mask


def anywhere(moment: ClipFrame, count: int, rng: np.random.Generator) -> list[Grey]:
    """Cut patches at random places of the shrunken picture, whatever they show."""
    picture = shrunk(moment.grey)
    return [_cut(picture, *_corner(picture, rng)) for _ in range(count)]


def of_background(moment: ClipFrame, count: int, rng: np.random.Generator, side: int = SIDE) -> list[Grey]:
    """Cut patches of the shrunken picture that reach into nobody's box; fewer where there is no room."""
    picture = shrunk(moment.grey)
    return [_cut(picture, *corner, side) for corner in background_corners(moment, count, rng, side)]


def background_corners(
    moment: ClipFrame, count: int, rng: np.random.Generator, side: int
) -> list[tuple[int, int]]:
    """Choose rows and columns of such patches."""
    factor = ROWS / moment.grey.shape[0]
    picture = shrunk(moment.grey)
    taken = covered(picture.shape, moment.boxes * factor)
    found: list[tuple[int, int]] = []
    for _ in range(_TRIES * count):
        row, column = _corner(picture, rng, side)
        if len(found) < count and not taken[row : row + side, column : column + side].any():
            found.append((row, column))
    return found


def of_people(moment: ClipFrame) -> list[Grey]:
    """Cut a square round everybody who is clear, shrunk so that each is as high; nobody is enlarged."""
    return [
        _square(moment.grey, box)
        for box in moment.boxes[moment.clear]
        if _ROOM * box[3] >= SIDE and box[2] <= _ROOM * box[3]
    ]


def _square(grey: Grey, box: NDArray[np.float64]) -> Grey:
    left, top, width, height = box
    side = round(_ROOM * height)
    row, column = round(top + height / 2.0 - side / 2.0), round(left + width / 2.0 - side / 2.0)
    wide = cv2.copyMakeBorder(grey, side, side, side, side, cv2.BORDER_REFLECT_101)
    part = wide[row + side : row + 2 * side, column + side : column + 2 * side]
    return np.asarray(cv2.resize(part, (SIDE, SIDE), interpolation=cv2.INTER_AREA), np.uint8)


def _corner(picture: Grey, rng: np.random.Generator, side: int = SIDE) -> tuple[int, int]:
    return int(rng.integers(picture.shape[0] - side + 1)), int(rng.integers(picture.shape[1] - side + 1))


def _cut(picture: Grey, row: int, column: int, side: int = SIDE) -> Grey:
    return picture[row : row + side, column : column + side].copy()
