"""Hard-negative mining: windows with people, windows without people, and false positives of the cascade."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.detector.augmentation import augment_for, has_people
from peopleboy.studies.training.detector.boosting import in_threads
from peopleboy.studies.training.detector.world_sequences import ThermalImage
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.sensors.thermal.detector.box_regression import encode_boxes
from peopleboy.tracker.sensors.thermal.detector.cascade import Cascade
from peopleboy.tracker.sensors.thermal.detector.channels import CHANNELS, Cells
from peopleboy.tracker.sensors.thermal.detector.detector import SMALLEST_PX
from peopleboy.tracker.sensors.thermal.detector.patches import Patches, integrate
from peopleboy.tracker.sensors.thermal.detector.pyramid import STEP, pyramid_levels
from peopleboy.tracker.sensors.thermal.detector.window import CELL_PX, COLUMNS, PERSON_PX, ROWS, WindowKind

Floats = NDArray[np.float64]
Windows = NDArray[np.float16]
Drawn = tuple[ThermalImage, np.random.Generator]
"""An augmented image with its own random generator."""
Found = TypeVar("Found")

CELLS: Final = CHANNELS * ROWS * COLUMNS
"""Cells of a window, indexed by channel, row and column."""

_AUGMENTED: Final = 2  # augmented versions of each image
_FITS: Final = 1.1 * math.log2(STEP) / 2.0  # a person fits one or two levels of the pyramid
_BESIDE: Final = 0.3  # IoU with a person, from which on a window is not a negative
_ALIKE: Final = 0.6  # IoU from which on two windows are duplicates
_LEAST_SCORE: Final = -1.0  # least score of a hard negative
_A_PERSON: Final = 6  # detected windows per person
_SURENESS: Final = 0.5  # final boxes are means weighted by exp(score); lower values diversify samples
_HARDLY: Final = 1e-4  # share of such weights that is neglected
_ASIDE: Final = 1.5 * CELL_PX / PERSON_PX  # heights; a box displaced by more belongs to another person
_A_LEVEL: Final = 6  # random windows per level
_AN_IMAGE: Final = 12  # negatives per image


class _Hits(NamedTuple):
    """Windows in which the cascade detects people: boxes (N, 4), scores (N,), and start cells."""

    box: Floats
    score: Floats
    place: list[tuple[Cells, int, int]]


def windows_with_people(
    images: Sequence[ThermalImage], rng: np.random.Generator, kind: WindowKind
) -> Windows:
    """Collect windows (N, 1800) that fit people in augmented images, and copies displaced by a cell."""
    return _stacked(_collect(_filled, _with_people(images, rng, kind)))


def detected_windows(
    images: Sequence[ThermalImage], cascade: Cascade, rng: np.random.Generator, kind: WindowKind
) -> tuple[Windows, Floats]:
    """Collect windows (N, 1800) in which the cascade detects people, however badly they fit.

    Returns:
        The windows, and the offsets (N, 4) of the people, see `encode_boxes`.
    """
    found = _collect(lambda drawn: _let_through(*drawn, cascade, kind), _with_people(images, rng, kind))
    return _stacked([window for window, _ in found]), np.array([each for _, each in found]).reshape(-1, 4)


def _collect(
    work: Callable[[Drawn], list[Found]], images: Iterable[Drawn], most: float = math.inf
) -> list[Found]:
    """Collect windows from images on all cores, until there are enough."""
    found: list[Found] = []
    for here in in_threads(work, images):
        found += here
        if len(found) >= most:
            break
    return found


def _stacked(windows: Sequence[Windows]) -> Windows:
    return np.array(windows, np.float16).reshape(-1, CELLS)


def _with_people(
    images: Sequence[ThermalImage], rng: np.random.Generator, kind: WindowKind
) -> Iterator[Drawn]:
    """Yield augmented images with people to train on, each with its own random generator."""
    return _augment(
        (image for image in images if has_people(image, kind) for _ in range(_AUGMENTED)), rng, kind
    )


def _augment(images: Iterable[ThermalImage], rng: np.random.Generator, kind: WindowKind) -> Iterator[Drawn]:
    """Yield augmented images, each with its own random generator."""
    for image in images:
        own = np.random.default_rng(rng.integers(2**63))
        yield augment_for(image, own, kind), own


def _filled(drawn: Drawn) -> list[Windows]:
    image, rng = drawn
    box, found = image.box[image.is_good], []
    for level in pyramid_levels(image.grey, image.change, None, SMALLEST_PX):
        off = np.abs(np.log2(box[:, 3] * level.scale[0] / PERSON_PX))
        for own in box[off < _FITS]:
            row, column = level.windows(own[None])[0].round().astype(int).tolist()
            aside = rng.integers(-1, 2, 2).tolist()
            places = sorted({(row, column), (row + aside[0], column + aside[1])})
            found += [_cut(level.cells, *place) for place in places]
    return found


def _let_through(
    image: ThermalImage, rng: np.random.Generator, cascade: Cascade, kind: WindowKind
) -> list[tuple[Windows, Floats]]:
    hits, found = _hits(image, cascade, kind), []
    overlap = iou(hits.box[:, None], image.box[None])
    for person in np.flatnonzero(image.is_good).tolist():
        offset = encode_boxes(hits.box, image.box[person][None])
        is_own = (overlap[:, person] >= overlap.max(axis=1)) & (overlap[:, person] > _BESIDE)
        own = np.flatnonzero(is_own & (np.abs(offset[:, 0]) <= _ASIDE))
        if len(own):
            weight = np.exp(_SURENESS * (hits.score[own] - hits.score[own].max()))
            most = min(_A_PERSON, int((weight > _HARDLY * weight.sum()).sum()))
            chosen = rng.choice(own, most, replace=False, p=weight / weight.sum()).tolist()
            found += [(_cut(*hits.place[k]), offset[k]) for k in chosen]
    return found


def windows_anywhere(
    images: Sequence[ThermalImage], rng: np.random.Generator, most: int, kind: WindowKind
) -> Windows:
    """Collect windows (N, 1800) without people.

    Args:
        images: images to augment.
        rng: draws images and positions.
        most: largest number of windows.
        kind: kind of windows.
    """
    found: list[Windows] = []
    for k in rng.permutation(len(images)).tolist():
        image, here = augment_for(images[k], rng, kind), []
        for level in pyramid_levels(image.grey, image.change, None, SMALLEST_PX):
            for first, end in level.rows[kind]:
                rows = rng.integers(first, end, _A_LEVEL)
                columns = rng.integers(0, level.cells.shape[2] - COLUMNS + 1, _A_LEVEL)
                is_clear = _is_clear(level.boxes(rows, columns), image)
                places = zip(rows[is_clear].tolist(), columns[is_clear].tolist(), strict=True)
                here += [_cut(level.cells, *place) for place in places]
        found += [here[k] for k in rng.permutation(len(here))[:_AN_IMAGE]]
        if len(found) >= most:
            break
    return _stacked(found)


def false_positives(
    images: Sequence[ThermalImage], cascade: Cascade, rng: np.random.Generator, most: int, kind: WindowKind
) -> Windows:
    """Collect windows (N, 1800) of false positives of the cascade, those with the highest scores per image.

    Args:
        images: images to augment.
        cascade: cascade whose false positives are collected.
        rng: draws images.
        most: largest number of windows.
        kind: kind of windows.
    """
    order = _augment((images[k] for k in rng.permutation(len(images)).tolist()), rng, kind)
    return _stacked(_collect(lambda drawn: _false_positives(drawn[0], cascade, kind), order, most))


def _false_positives(image: ThermalImage, cascade: Cascade, kind: WindowKind) -> list[Windows]:
    hits = _hits(image, cascade, kind)
    is_left = _is_clear(hits.box, image)
    chosen: list[int] = []
    for k in np.argsort(-hits.score, kind="stable").tolist():
        if is_left[k] and len(chosen) < _AN_IMAGE:
            chosen.append(k)
            is_left &= iou(hits.box[k], hits.box) < _ALIKE
    return [_cut(*hits.place[k]) for k in chosen]


def _hits(image: ThermalImage, cascade: Cascade, kind: WindowKind) -> _Hits:
    boxes, scores, places = [np.empty((0, 4))], [np.empty(0)], []
    for level in pyramid_levels(image.grey, image.change, None, SMALLEST_PX):
        sums = integrate(level.cells)
        for rows in level.rows[kind]:
            hits = cascade.scan(sums, rows)
            is_some = hits.score >= _LEAST_SCORE
            row, column = hits.row[is_some], hits.column[is_some]
            boxes.append(level.boxes(row, column))
            scores.append(hits.score[is_some])
            places += [(level.cells, *place) for place in zip(row.tolist(), column.tolist(), strict=True)]
    return _Hits(np.concatenate(boxes), np.concatenate(scores), places)


def _is_clear(box: Floats, image: ThermalImage) -> NDArray[np.bool_]:
    """Return which boxes (N, 4) have little overlap with people; a part of a person is a negative, too."""
    return np.asarray((iou(box[:, None], image.box[None]) < _BESIDE).all(axis=1), np.bool_)


def _cut(cells: Cells, row: int, column: int) -> Windows:
    """Return the cells (1800,) of a window, padded by repeating the cells at the border."""
    _, high, wide = cells.shape
    rows = np.clip(np.arange(row, row + ROWS), 0, high - 1)
    columns = np.clip(np.arange(column, column + COLUMNS), 0, wide - 1)
    return cells[:, rows[:, None], columns].astype(np.float16).ravel()


# The pool of features for the trees.

Box = tuple[int, int, int, int]

DRAWN: Final = 6000
_GROWS: Final = (0.25, 0.35)  # probability that a rectangle stops growing, by rows and by columns
_MOST_ROWS: Final = 16
# Shares of the drawn features; the remaining ones are pairs at random positions.
_ALONE: Final = 0.25  # single rectangles
_ADJACENT: Final = 0.35  # pairs of equal size beside, above or below each other
_MIRRORED: Final = 0.2  # pairs mirrored left to right
_NOTHING: Final = (0, 0, 0, 0)
_SEED: Final = 5


def patch_pool(drawn: int = DRAWN) -> Patches:
    """Return every cell of every channel, and random rectangles and pairs; the result is always the same."""
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
    """Draw the rectangle that is subtracted from another one."""
    top, left, bottom, right = box
    kind = rng.random()
    if kind < _ALONE:
        return _NOTHING
    if kind < _ALONE + _ADJACENT:
        rows, columns = bottom - top, right - left
        moves = [(rows, 0), (-rows, 0), (0, columns), (0, -columns)]
        beside = [(top + down, left + on, bottom + down, right + on) for down, on in moves]
        inside = [one for one in beside if min(one) >= 0 and one[2] <= ROWS and one[3] <= COLUMNS]
        return inside[int(rng.integers(len(inside)))] if inside else _NOTHING
    if kind < _ALONE + _ADJACENT + _MIRRORED:
        mirrored = (top, COLUMNS - right, bottom, COLUMNS - left)
        return _NOTHING if mirrored == box else mirrored
    return _rectangle(rng)
