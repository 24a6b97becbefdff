"""Windows with people, and such without as are taken for people."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.studies.people_learning.cut_off import has_people, varied
from peopleboy.scenarios.studies.people_learning.many_threads import in_threads
from peopleboy.scenarios.studies.people_learning.shots import PeopleShot
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.proposals.cascade import Cascade
from peopleboy.tracker.proposals.channels import CHANNELS, Cells
from peopleboy.tracker.proposals.detector import SMALLEST_PX
from peopleboy.tracker.proposals.patches import summed
from peopleboy.tracker.proposals.placing import offsets
from peopleboy.tracker.proposals.pyramid import STEP, Level, levels
from peopleboy.tracker.proposals.window import COLUMNS, PERSON_PX, ROWS, Kind

Floats = NDArray[np.float64]
Windows = NDArray[np.float16]

CELLS: Final = CHANNELS * ROWS * COLUMNS
"""Of a window, by channel, row and column."""

_VARIETIES: Final = 2  # of each image
_FITS: Final = 1.1 * math.log2(STEP) / 2.0  # a person is looked for in the level, or two, of about their size
_BESIDE: Final = 0.3  # IoU with a person from which on a window is no example of what is none
_ALIKE: Final = 0.6  # IoU of windows of which one is enough
_LEAST_SCORE: Final = -1.0  # of a mistake that there is something to learn from
_A_LEVEL: Final = 6  # windows that are placed anywhere
_AN_IMAGE: Final = 12  # of what is none


def windows_with_people(
    shots: Sequence[PeopleShot], rng: np.random.Generator, kind: Kind
) -> tuple[Windows, Floats]:
    """Collect windows (N, 1800) that people fill, in images that are varied, each also a cell off.

    Returns:
        The windows, and what is to be known of each (N, 4): see `placing.offsets`.
    """
    good = [shot for shot in shots if has_people(shot, kind) for _ in range(_VARIETIES)]
    found = [example for examples in in_threads(_filled, _varied(good, rng, kind)) for example in examples]
    windows = np.array([window for window, _ in found], np.float16).reshape(-1, CELLS)
    return windows, np.array([offset for _, offset in found]).reshape(-1, 4)


def _varied(
    shots: Iterable[PeopleShot], rng: np.random.Generator, kind: Kind
) -> Iterator[tuple[PeopleShot, np.random.Generator]]:
    """Give images varied, each with random numbers of its own."""
    for shot in shots:
        own = np.random.default_rng(rng.integers(2**63))
        yield varied(shot, own, kind), own


def _filled(drawn: tuple[PeopleShot, np.random.Generator]) -> list[tuple[Windows, Floats]]:
    shot, rng = drawn
    box, found = shot.box[shot.is_good], []
    for level in levels(shot.grey, shot.change, None, SMALLEST_PX):
        off = np.abs(np.log2(box[:, 3] * level.scale[0] / PERSON_PX))
        for own in box[off < _FITS]:
            row, column = level.windows(own[None])[0].round().astype(int).tolist()
            aside = rng.integers(-1, 2, 2).tolist()
            for place in sorted({(row, column), (row + aside[0], column + aside[1])}):
                window = level.boxes(*(np.array([index]) for index in place))
                found.append((_cut(level.cells, *place), offsets(window, own[None])[0]))
    return found


def windows_anywhere(shots: Sequence[PeopleShot], rng: np.random.Generator, most: int, kind: Kind) -> Windows:
    """Collect windows (N, 1800) without people.

    Args:
        shots: images, of which each is looked at varied.
        rng: draws which images, and where.
        most: how many are enough.
        kind: of windows.
    """
    found: list[Windows] = []
    for k in rng.permutation(len(shots)).tolist():
        shot, here = varied(shots[k], rng, kind), []
        for level in levels(shot.grey, shot.change, None, SMALLEST_PX):
            for first, end in level.rows[kind]:
                rows = rng.integers(first, end, _A_LEVEL)
                columns = rng.integers(0, level.cells.shape[2] - COLUMNS + 1, _A_LEVEL)
                here += _without(shot, level, rows, columns)
        found += [here[k] for k in rng.permutation(len(here))[:_AN_IMAGE]]
        if len(found) >= most:
            break
    return np.array(found, np.float16).reshape(-1, CELLS)


def mistakes(
    shots: Sequence[PeopleShot], cascade: Cascade, rng: np.random.Generator, most: int, kind: Kind
) -> Windows:
    """Collect windows (N, 1800) without people that are taken for some, the worst of each image.

    Args:
        shots: images, of which each is looked at varied.
        cascade: what errs.
        rng: draws which images.
        most: how many are enough.
        kind: of windows.
    """
    found: list[Windows] = []
    order = _varied((shots[k] for k in rng.permutation(len(shots)).tolist()), rng, kind)
    for here in in_threads(lambda drawn: _mistakes(drawn[0], cascade, kind), order):
        found += here
        if len(found) >= most:
            break
    return np.array(found, np.float16).reshape(-1, CELLS)


def _mistakes(shot: PeopleShot, cascade: Cascade, kind: Kind) -> list[Windows]:
    boxes, scores, cuts = [np.empty((0, 4))], [np.empty(0)], []
    for level in levels(shot.grey, shot.change, None, SMALLEST_PX):
        sums = summed(level.cells)
        for rows in level.rows[kind]:
            hits = cascade.scan(sums, rows)
            is_bad = hits.score >= _LEAST_SCORE
            boxes.append(level.boxes(hits.row[is_bad], hits.column[is_bad]))
            scores.append(hits.score[is_bad])
            places = zip(hits.row[is_bad].tolist(), hits.column[is_bad].tolist(), strict=True)
            cuts += [(level.cells, row, column) for row, column in places]
    box, score = np.concatenate(boxes), np.concatenate(scores)
    is_left = _is_clear(box, shot)
    chosen: list[int] = []
    for k in np.argsort(-score, kind="stable").tolist():
        if is_left[k] and len(chosen) < _AN_IMAGE:
            chosen.append(k)
            is_left &= iou(box[k], box) < _ALIKE
    return [_cut(*cuts[k]) for k in chosen]


def _without(
    shot: PeopleShot, level: Level, rows: NDArray[np.int64], columns: NDArray[np.int64]
) -> list[Windows]:
    is_clear = _is_clear(level.boxes(rows, columns), shot)
    return [
        _cut(level.cells, row, column)
        for row, column in zip(rows[is_clear].tolist(), columns[is_clear].tolist(), strict=True)
    ]


def _is_clear(box: Floats, shot: PeopleShot) -> NDArray[np.bool_]:
    """Tell which boxes (N, 4) are of nobody; a part of a person is nobody."""
    return np.asarray((iou(box[:, None], shot.box[None]) < _BESIDE).all(axis=1), np.bool_)


def _cut(cells: Cells, row: int, column: int) -> Windows:
    """Give the cells (1800,) of a window; beyond what there is, it goes on as it ends."""
    _, high, wide = cells.shape
    rows = np.clip(np.arange(row, row + ROWS), 0, high - 1)
    columns = np.clip(np.arange(column, column + COLUMNS), 0, wide - 1)
    return cells[:, rows[:, None], columns].astype(np.float16).ravel()
