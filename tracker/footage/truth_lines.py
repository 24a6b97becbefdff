"""Which format lines of truth are of: MOTChallenge's, or one box or polygon a picture."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.mot_files import WIDTHS

_AS_POLYGON: Final = (8, 10)  # how many numbers can be either format's


def cells_of(line: str) -> list[str]:
    """Split a line at commas, semicolons and white space."""
    return [cell for cell in re.split(r"[,;\s]+", line.strip()) if cell]


def is_motchallenge(lines: Sequence[str], path: Path) -> bool:
    """Tell whether a file, by its lines, is MOTChallenge's; one without any is.

    Lines of 6, 7 and 9 numbers can be nothing else. Those of 8 and 10 can be corners of a polygon; they are
    MOTChallenge's if all begin with two whole numbers, frame and id, and have 0, 1 or a share as the seventh,
    and are no upright rectangles.

    Raises:
        BadInput: they may well be either: frames rise from 0 or 1 on for each id, with another seventh.
    """
    count = len(cells_of(lines[0])) if lines else WIDTHS[0]
    if count not in _AS_POLYGON:
        return count in WIDTHS
    table = _numbers(lines, count)
    if table is None or not _are_keys(table[:, :2]) or _are_upright(table):
        return False
    if (np.abs(table[:, 6]) <= 1.0).all():
        return True
    if _rise(table[:, :2]):
        raise BadInput(
            f"{path}: lines of {count} numbers that begin with whole ones may be MOTChallenge's or polygons; "
            "give the former's first six (frame, id, left, top, width, height), or x,y,w,h of one person"
        )
    return False


def _numbers(lines: Sequence[str], count: int) -> Floats | None:
    """Read all lines (N, count); None if one has another count, or is none of numbers."""
    rows = [cells_of(line) for line in lines]
    if any(len(row) != count for row in rows):
        return None
    try:
        return np.array(rows, dtype=np.float64)
    except ValueError:
        return None


def _are_keys(keys: Floats) -> bool:
    """Tell whether rows (N, 2) can be frame and id; those of detections are -1."""
    return bool((keys == np.floor(keys)).all() and (keys >= (0.0, -1.0)).all())


def _are_upright(table: Floats) -> bool:
    """Tell whether rows (N, count) are four corners of upright rectangles, from whichever on."""
    if table.shape[1] != 8:
        return False
    # How far it is to the next corner: one of both is 0 along an edge, the other one along the next edge.
    corners = table.reshape(-1, 4, 2)
    still = np.roll(corners, -1, axis=1) == corners  # (N, 4, 2)
    first_across = still[:, ::2, 1].all(axis=1) & still[:, 1::2, 0].all(axis=1)
    first_down = still[:, ::2, 0].all(axis=1) & still[:, 1::2, 1].all(axis=1)
    return bool((first_across | first_down).all())


def _rise(keys: Floats) -> bool:
    """Tell whether the frames of each id rise, from 0 or 1 on in all."""
    frame, identity = keys[np.argsort(keys[:, 1], kind="stable")].T
    is_same = np.diff(identity) == 0.0
    return bool(frame.min() <= 1.0 and (np.diff(frame)[is_same] > 0.0).all())
