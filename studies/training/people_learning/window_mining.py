"""Windows with people, such as trees take for people, and such without that they take for some."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.people_learning.cut_off import has_people, varied
from peopleboy.studies.training.people_learning.many_threads import in_threads
from peopleboy.studies.training.people_learning.shots import PeopleShot
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.proposals.cascade import Cascade
from peopleboy.tracker.proposals.channels import CHANNELS, Cells
from peopleboy.tracker.proposals.detector import SMALLEST_PX
from peopleboy.tracker.proposals.patches import summed
from peopleboy.tracker.proposals.placing import offsets
from peopleboy.tracker.proposals.pyramid import STEP, Level, levels
from peopleboy.tracker.proposals.window import CELL_PX, COLUMNS, PERSON_PX, ROWS, Kind

Floats = NDArray[np.float64]
Windows = NDArray[np.float16]

CELLS: Final = CHANNELS * ROWS * COLUMNS
"""Of a window, by channel, row and column."""

_VARIETIES: Final = 2  # of each image
_FITS: Final = 1.1 * math.log2(STEP) / 2.0  # a person is looked for in the level, or two, of about their size
_BESIDE: Final = 0.3  # IoU with a person from which on a window is no example of what is none
_ALIKE: Final = 0.6  # IoU of windows of which one is enough
_LEAST_SCORE: Final = -1.0  # of a window that there is something to learn from
_A_PERSON: Final = 6  # windows that are let through
_SURENESS: Final = 0.5  # boxes are means that weigh exp(score); with less, there is more to learn from
_HARDLY: Final = 1e-4  # share of such weights that is nothing
_ASIDE: Final = 1.5 * CELL_PX / PERSON_PX  # heights; boxes that are moved by more end up on somebody else
_A_LEVEL: Final = 6  # windows that are placed anywhere
_AN_IMAGE: Final = 12  # of what is none


class _Hits(NamedTuple):
    """Windows that trees take for people: boxes (N, 4), scores (N,), and where in which cells each begins."""

    box: Floats
    score: Floats
    place: list[tuple[Cells, int, int]]


def windows_with_people(shots: Sequence[PeopleShot], rng: np.random.Generator, kind: Kind) -> Windows:
    """Collect windows (N, 1800) that people fill, in images that are varied, each also a cell off."""
    found = [each for windows in in_threads(_filled, _with_people(shots, rng, kind)) for each in windows]
    return np.array(found, np.float16).reshape(-1, CELLS)


def windows_let_through(
    shots: Sequence[PeopleShot], cascade: Cascade, rng: np.random.Generator, kind: Kind
) -> tuple[Windows, Floats]:
    """Collect windows (N, 1800) that trees take for people who are there, however badly those fill them.

    Returns:
        The windows, and what is to be known of each (N, 4): see `placing.offsets`.
    """
    drawn = _with_people(shots, rng, kind)
    found = [
        each for some in in_threads(lambda one: _let_through(*one, cascade, kind), drawn) for each in some
    ]
    windows = np.array([window for window, _ in found], np.float16).reshape(-1, CELLS)
    return windows, np.array([offset for _, offset in found]).reshape(-1, 4)


def _with_people(
    shots: Sequence[PeopleShot], rng: np.random.Generator, kind: Kind
) -> Iterator[tuple[PeopleShot, np.random.Generator]]:
    """Give images with somebody to learn from, varied, with random numbers of their own."""
    return _varied((shot for shot in shots if has_people(shot, kind) for _ in range(_VARIETIES)), rng, kind)


def _varied(
    shots: Iterable[PeopleShot], rng: np.random.Generator, kind: Kind
) -> Iterator[tuple[PeopleShot, np.random.Generator]]:
    """Give images varied, each with random numbers of its own."""
    for shot in shots:
        own = np.random.default_rng(rng.integers(2**63))
        yield varied(shot, own, kind), own


def _filled(drawn: tuple[PeopleShot, np.random.Generator]) -> list[Windows]:
    shot, rng = drawn
    box, found = shot.box[shot.is_good], []
    for level in levels(shot.grey, shot.change, None, SMALLEST_PX):
        off = np.abs(np.log2(box[:, 3] * level.scale[0] / PERSON_PX))
        for own in box[off < _FITS]:
            row, column = level.windows(own[None])[0].round().astype(int).tolist()
            aside = rng.integers(-1, 2, 2).tolist()
            places = sorted({(row, column), (row + aside[0], column + aside[1])})
            found += [_cut(level.cells, *place) for place in places]
    return found


def _let_through(
    shot: PeopleShot, rng: np.random.Generator, cascade: Cascade, kind: Kind
) -> list[tuple[Windows, Floats]]:
    hits, found = _hits(shot, cascade, kind), []
    overlap = iou(hits.box[:, None], shot.box[None])
    for person in np.flatnonzero(shot.is_good).tolist():
        told = offsets(hits.box, shot.box[person][None])
        is_own = (overlap[:, person] >= overlap.max(axis=1)) & (overlap[:, person] > _BESIDE)
        own = np.flatnonzero(is_own & (np.abs(told[:, 0]) <= _ASIDE))
        if len(own):
            weight = np.exp(_SURENESS * (hits.score[own] - hits.score[own].max()))
            most = min(_A_PERSON, int((weight > _HARDLY * weight.sum()).sum()))
            chosen = rng.choice(own, most, replace=False, p=weight / weight.sum()).tolist()
            found += [(_cut(*hits.place[k]), told[k]) for k in chosen]
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
    hits = _hits(shot, cascade, kind)
    is_left = _is_clear(hits.box, shot)
    chosen: list[int] = []
    for k in np.argsort(-hits.score, kind="stable").tolist():
        if is_left[k] and len(chosen) < _AN_IMAGE:
            chosen.append(k)
            is_left &= iou(hits.box[k], hits.box) < _ALIKE
    return [_cut(*hits.place[k]) for k in chosen]


def _hits(shot: PeopleShot, cascade: Cascade, kind: Kind) -> _Hits:
    boxes, scores, places = [np.empty((0, 4))], [np.empty(0)], []
    for level in levels(shot.grey, shot.change, None, SMALLEST_PX):
        sums = summed(level.cells)
        for rows in level.rows[kind]:
            hits = cascade.scan(sums, rows)
            is_some = hits.score >= _LEAST_SCORE
            row, column = hits.row[is_some], hits.column[is_some]
            boxes.append(level.boxes(row, column))
            scores.append(hits.score[is_some])
            places += [(level.cells, *place) for place in zip(row.tolist(), column.tolist(), strict=True)]
    return _Hits(np.concatenate(boxes), np.concatenate(scores), places)


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
