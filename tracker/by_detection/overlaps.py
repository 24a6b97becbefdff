"""Who overlaps whom in the image, and who is in front."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.boxes import area, cover, intersection, iou, shared_of_smaller

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

_COVERED: Final = 0.35  # share of a box that is hidden by who stands in front
_LOWER: Final = 0.03  # who stands so much lower in the image, in heights, is in front
CLEAR: Final = 0.2
"""Overlap up to which somebody is seen apart from another one."""


def beside(expected: Floats, is_told: Flags) -> Flags:
    """Tell of K people with boxes (K, 4) who is not seen apart from somebody else who is told."""
    mutual = iou(expected[:, None], expected[None]) * ~np.eye(len(expected), dtype=bool)
    return np.asarray((is_told[None] & (mutual > CLEAR)).any(axis=1))


def hidden_by(expected: Floats, is_told: Flags, found: Iterable[int]) -> list[int | None]:
    """Tell for each of K people with boxes (K, 4) who of those who were found may hide it."""
    covered = cover(intersection(expected[:, None], expected[None]), area(expected)[:, None])
    foot = expected[:, 1] + expected[:, 3]
    hides = (covered > _COVERED) & (foot[None] > (foot - _LOWER * expected[:, 3])[:, None]) & is_told[None]
    is_found = np.zeros(len(expected), np.bool_)
    is_found[list(found)] = True
    hides &= is_found[None] & ~np.eye(len(expected), dtype=bool)
    return [
        int(np.argmax(covered[row] * hides[row])) if hides[row].any() else None for row in range(len(hides))
    ]


def shared(boxes: Floats, theirs: Sequence[int]) -> Floats:
    """Tell what share of the smaller box each of (M, 4) has in common with one of some others, at most."""
    share = shared_of_smaller(boxes[:, None], boxes[None, theirs])
    share[theirs, np.arange(len(theirs))] = 0.0
    return np.asarray(share.max(axis=1, initial=0.0))
