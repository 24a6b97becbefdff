"""KITTI's labels and results as tables: one line per object, separated by spaces, frames from 0.

Both are: frame, id, type, truncated, occluded, alpha, left, top, right, bottom, and seven values of the
object in space; results may end with a score. Types are words such as Pedestrian. DontCare marks regions
that are not annotated; their id is -1.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.protocols import CROWD, DISTRACTOR, PERSON

_WIDTHS: Final = (17, 18)
_TYPE, _SCORE = 2, 17
_TRUNCATED, _OCCLUDED = 3, 4
_LEFT, _BOTTOM = 6, 10
_MOST_OCCLUDED: Final = 2  # 3 is unknown
_OTHER: Final = 3  # any class of MOTChallenge that is not scored
_PEDESTRIAN, _SITTING, _NOT_ANNOTATED = "pedestrian", "person", "dontcare"
_COLUMNS: Final = "frame id type truncated occluded alpha left top right bottom ..."


def is_kitti(line: str) -> bool:
    """Return whether a line is KITTI's: frame, id and a word where other formats have a number."""
    cells = line.split()
    return len(cells) >= _BOTTOM and cells[_TYPE].isalpha() and all(_is_whole(cell) for cell in cells[:_TYPE])


def _is_whole(cell: str) -> bool:
    return cell.removeprefix("-").isdecimal()


def kitti_truth(path: object, lines: Sequence[str]) -> Floats:
    """Read labels as a table of annotations (N, 9), with MOTChallenge's frames and classes.

    Truncated and heavily occluded people and people who sit are distractors, as in TrackEval.

    Raises:
        BadInput: a line is malformed (the message names it).
    """
    table, types = _read(path, lines)
    is_hidden = (np.trunc(table[:, _TRUNCATED]) > 0.0) | (np.trunc(table[:, _OCCLUDED]) > _MOST_OCCLUDED)
    kind = np.full(len(table), float(_OTHER))
    kind[types == _PEDESTRIAN] = PERSON
    kind[((types == _PEDESTRIAN) & is_hidden) | (types == _SITTING)] = DISTRACTOR
    kind[table[:, 1] < 0.0] = _OTHER
    kind[types == _NOT_ANNOTATED] = CROWD
    rows = np.ones((len(table), 9))
    rows[:, 0], rows[:, 2:6], rows[:, 7] = table[:, 0] + 1.0, _boxes(table), kind
    rows[:, 1] = own_ids(table[:, 1], table[:, 1] < 0.0)
    return rows


def kitti_tracks(path: object, lines: Sequence[str]) -> Floats:
    """Read the pedestrians among results: frame, id, left, top, width, height and confidence (N, 7).

    Raises:
        BadInput: a line is malformed (the message names it).
    """
    table, types = _read(path, lines)
    kept = (types == _PEDESTRIAN) & (table[:, 1] >= 0.0)
    score = table[:, _SCORE] if table.shape[1] > _SCORE else np.ones(len(table))
    rows = np.column_stack([table[:, 0] + 1.0, table[:, 1], _boxes(table), score])
    return np.asarray(rows[kept], dtype=np.float64)


def own_ids(ids: Floats, is_replaced: NDArray[np.bool_]) -> Floats:
    """Return ids (N,) of which some are replaced by ids that no other row has."""
    first = max(float(ids.max(initial=0.0)), 0.0) + 1.0
    return np.where(is_replaced, first + np.arange(len(ids)), ids)


def _boxes(table: Floats) -> Floats:
    corners = table[:, _LEFT:_BOTTOM]
    return np.hstack([corners[:, :2], corners[:, 2:] - corners[:, :2]])


def _read(path: object, lines: Sequence[str]) -> tuple[Floats, NDArray[np.str_]]:
    """Read lines as numbers (N, columns), 0 in place of the type, and the types (N,) in lower case."""
    rows, types, width = [], [], len(lines[0].split())
    for number, line in enumerate(lines, start=1):
        cells = line.split()
        if len(cells) != width or width not in _WIDTHS:
            wanted = width if width in _WIDTHS else "17 or 18"
            raise BadInput(f"{path}:{number}: must have {wanted} values ({_COLUMNS}), got {len(cells)}")
        types.append(cells[_TYPE].lower())
        try:
            rows.append([float(cell) for cell in (*cells[:_TYPE], "0", *cells[_TYPE + 1 :])])
        except ValueError:
            raise BadInput(f"{path}:{number}: must be numbers ({_COLUMNS}), got {line[:60]!r}") from None
    return np.array(rows, dtype=np.float64).reshape(-1, width), np.array(types, dtype=np.str_)
