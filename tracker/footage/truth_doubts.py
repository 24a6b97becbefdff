"""What looks wrong about truth, and how its frames go with the pictures' names."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.sequence import TrueBoxes

_MOST_OUTSIDE: Final = 0.1  # share of boxes that are wholly beyond the pictures' right or lower edge
_LEAST_SPREAD: Final = 0.25  # of the width: boxes that spread less may well be in one corner


def frames_before(frame: Floats, numbers: range | None, path: Path, notes: list[str]) -> int:
    """Tell how much less the frames of the truth must be, so that 1 is the first picture.

    Args:
        frame: (N,) frames of the truth.
        numbers: those in the pictures' names, in a row; None if they tell none.
        path: of the truth.
        notes: gets a line if the numbers do not begin with 1.
    """
    if numbers is None or numbers[0] == 1 or not len(frame):
        return 0
    first, last = numbers[0], numbers[-1]
    is_among = np.isin(frame, np.asarray(numbers)).all() and (first > 1 or frame.min() == first)
    if not is_among:
        notes.append(f"{path}: frame 1 is taken for the first picture, which has number {first}")
        return 0
    notes.append(
        f"{path}: frames are taken for the pictures' numbers, {first} to {last}; ours are counted from 1"
    )
    return first - 1


def doubts(truth: TrueBoxes, width: int, height: int) -> list[str]:
    """Say if boxes look like those of pictures of another size.

    People partly outside do not count, be most of them outside as of those near the camera; and nor do boxes
    that are all in a small part of the upper left.
    """
    if not len(truth):
        return []
    left, top, wide, high = truth.box.T
    right, bottom = float((left + wide).max()), float((top + high).max())
    is_outside = (left > width) | (top > height)
    spread = right - float(left.min())
    if is_outside.mean() > _MOST_OUTSIDE:
        what = f"{is_outside.mean():.0%} of the boxes are outside"
    elif right <= width / 2.0 and bottom <= height / 2.0 and spread >= _LEAST_SPREAD * width:
        what = "all boxes are in the upper left quarter"
    else:
        return []
    return [
        f"truth: {what} of the pictures, which are {width}x{height}: they reach to "
        f"{right:.0f}, {bottom:.0f}; are they of pictures of another size?"
    ]
