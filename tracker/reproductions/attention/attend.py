"""Focus of attention: learn a person from a box, and locate the person in an image."""

import math
from dataclasses import dataclass, replace
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.attention.attention_config import AttentionConfig
from peopleboy.tracker.reproductions.attention.box_scores import likenesses, mean_scores, pattern_scores
from peopleboy.tracker.reproductions.attention.feature_maps import CELL_PX, in_use
from peopleboy.tracker.reproductions.attention.image_sums import ImageSums
from peopleboy.tracker.reproductions.attention.part_model import (
    HEAD,
    TORSO,
    Mask,
    ModelPart,
    PartModel,
    cells_of,
    check_box,
)
from peopleboy.tracker.track import Box

Doubles = NDArray[np.float64]

STEP_CELLS: Final = 2
"""Step between tested positions, in cells."""

_COLOUR_BIAS: Final = 1.0
"""Scale of the logarithmic colour ratio: one half at its negative; chosen on seeds 100 to 102."""

_WIDTH: Final = 0.3  # of a given box, in its heights
_BESIDE: Final = 0.25  # heights within which two heads count as one


@dataclass(frozen=True, slots=True, eq=False)
class PersonModel:
    """Appearance model of a person: the parts, and the apparent height.

    Attributes:
        height: [px] from head to feet.
        parts: models of the parts.
    """

    height: float
    parts: tuple[tuple[ModelPart, PartModel], ...]


@dataclass(frozen=True, slots=True, eq=False)
class PartScores:
    """Similarity of each position to one part; all (rows, columns), at the scale of the focus.

    Attributes:
        features: R, the similarity of the maps.
        patterns: LA; None if patterns are not used.
        colour: mean logarithm of the colour ratio; None if colours are not used.
    """

    features: Doubles | None
    patterns: Doubles | None
    colour: Doubles | None


@dataclass(frozen=True, slots=True, eq=False)
class Focus:
    """The most likely position of a person.

    Attributes:
        box: left, top, width, height [px] from head to feet.
        score: 0..1, of the best position.
        second: score of the best position not next to it.
        second_box: box at that position.
        scores: (rows, columns) at every position of the head's middle, `STEP_CELLS` apart.
        parts: contributions to the scores.
    """

    box: Box
    score: float
    second: float
    second_box: Box
    scores: Doubles
    parts: tuple[PartScores, ...]

    @property
    def place(self) -> tuple[float, float]:
        """u, v [px] of the middle of the torso."""
        return middle_of(self.box)


def middle_of(box: Box) -> tuple[float, float]:
    """Return u, v [px] of the middle of the torso of a person with a box."""
    left, top, width, height = box
    return left + width / 2.0, top + (TORSO.top + TORSO.height / 2.0) * height


def learn(sight: ImageSums, box: Box, config: AttentionConfig, near: Mask | None = None) -> PersonModel:
    """Learn a person from a box.

    Args:
        sight: the image.
        box: left, top, width, height [px] from head to feet.
        config: features to use.
        near: (H, W) pixels not behind the person; None if unknown.

    Raises:
        BadInput: head or torso are not inside the image.

    Source: situation-awareness thesis, section 5.3, where the box is drawn by hand.
    """
    check_box(box, sight.image.shape)
    parts = (HEAD, TORSO) if config.head else (TORSO,)
    models = ((part, PartModel.learned(sight, cells_of(part, box), config, near)) for part in parts)
    return PersonModel(height=box[3], parts=tuple(models))


def search(sight: ImageSums, model: PersonModel, config: AttentionConfig) -> Focus:
    """Return the most likely position of a person.

    The source multiplies the torso's score at the head's position by the head's score at the torso's position
    (equation 5.17); here each score is taken at its own position.

    Source: situation-awareness thesis, sections 5.4 and 5.5.
    """
    found = [_searched(sight, model, scale, config) for scale in config.scales]
    best = max(range(len(found)), key=lambda k: float(found[k][0].max()))
    scores, parts = found[best]
    box, place = _box_at(scores, model.height * config.scales[best])
    every = np.max([one for one, _ in found], axis=0)
    score = float(scores[place])
    _blank(every, place, box)
    second_box, second_place = _box_at(every, box[3])
    return Focus(box, score, float(every[second_place]), second_box, scores, parts)


def relearn(model: PersonModel, sight: ImageSums, focus: Focus, config: AttentionConfig) -> PersonModel:
    """Update the model slightly with the current appearance, if the person is likely to be the right one.

    Source: situation-awareness thesis, section 5.4.
    """
    if focus.score < config.least or focus.score - focus.second < config.ahead:
        return model
    new = learn(sight, focus.box, config)
    pairs = zip(model.parts, new.parts, strict=True)
    return replace(
        model, parts=tuple((part, old.updated(fresh, config.rate)) for (part, old), (_, fresh) in pairs)
    )


def _searched(
    sight: ImageSums, model: PersonModel, scale: float, config: AttentionConfig
) -> tuple[Doubles, tuple[PartScores, ...]]:
    rows = np.arange(0, sight.rows, STEP_CELLS)
    columns = np.arange(0, sight.columns, STEP_CELLS)
    parts = []
    for part, known in model.parts:
        cells = cells_of(part, (0.0, 0.0, 0.0, model.height), scale)
        at = rows + cells.row, columns + cells.column
        parts.append(_part_scores(sight, known, at, (cells.height, cells.width), config))
    return _together(parts, model), tuple(parts)


def _part_scores(
    sight: ImageSums,
    known: PartModel,
    at: tuple[NDArray[np.int64], NDArray[np.int64]],
    size: tuple[int, int],
    config: AttentionConfig,
) -> PartScores:
    features = found = colour = None
    if sight.map_sums is not None and sight.maps is not None:
        if config.reward == "same":
            features = likenesses(sight.map_sums, *at, size, known.mean, known.spread, in_use(config))
        else:
            features = mean_scores(_attention(sight, known, config), *at, size)
            if not config.is_absolute:
                features = features / max(float(features.max()), 1e-12)
    if sight.pattern_sums is not None:
        found = pattern_scores(sight.pattern_sums, *at, size, known.patterns, known.pattern_weight)
    if config.colour:
        ratio = known.colour_ratio[sight.colours].astype(np.float32)
        height, width = CELL_PX * sight.rows, CELL_PX * sight.columns
        cells = cv2.resize(ratio[:height, :width], (sight.columns, sight.rows), interpolation=cv2.INTER_AREA)
        colour = mean_scores(np.asarray(cv2.integral(cells, sdepth=cv2.CV_64F), np.float64), *at, size)
    return PartScores(features, found, colour)


def attention_map(sight: ImageSums, known: PartModel, config: AttentionConfig) -> Doubles:
    """Return A (rows, columns): excitation minus inhibition, at least 0 (equations 5.9 to 5.11)."""
    assert sight.maps is not None
    weight = known.excites - known.inhibits
    if not config.keeps_negative:
        weight = np.maximum(weight, 0.0)
    weight = np.where(in_use(config), weight, 0.0).astype(np.float32)
    return np.maximum(sight.maps @ weight, 0.0)


def _attention(sight: ImageSums, known: PartModel, config: AttentionConfig) -> Doubles:
    return np.asarray(cv2.integral(attention_map(sight, known, config), sdepth=cv2.CV_64F), np.float64)


def _together(parts: list[PartScores], model: PersonModel) -> Doubles:
    """Multiply the scores of all parts, weighted by their colours."""
    kinds = [[kind for kind in (one.features, one.patterns) if kind is not None] for one in parts]
    total = np.prod([np.mean(kind, axis=0) for kind in kinds if kind], axis=0)
    colours = [one.colour for one in parts if one.colour is not None]
    if colours:
        areas = [part.width * part.height for part, _ in model.parts]
        ratio = np.average(colours, axis=0, weights=areas)
        total = total / (1.0 + np.exp(-ratio - _COLOUR_BIAS))
    return np.asarray(total, np.float64)


def _box_at(scores: Doubles, height: float) -> tuple[Box, tuple[int, int]]:
    row, column = np.unravel_index(int(scores.argmax()), scores.shape)
    step = STEP_CELLS * CELL_PX
    width = _WIDTH * height
    return (float(column * step) - width / 2.0, float(row * step), width, height), (int(row), int(column))


def _blank(scores: Doubles, place: tuple[int, int], box: Box) -> None:
    """Mask out the positions of a head that belong to the person at a position."""
    reach = math.ceil(_BESIDE * box[3] / (STEP_CELLS * CELL_PX))
    row, column = place
    scores[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1] = 0.0
