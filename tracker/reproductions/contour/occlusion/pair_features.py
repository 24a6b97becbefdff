"""Six features that indicate which of two people is in front."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.reproductions.contour.appearance.appearance_model import ColourModel, squared_distances
from peopleboy.tracker.reproductions.contour.appearance.regions import PARTS, part_rectangles
from peopleboy.tracker.reproductions.contour.particle_filter import FrameView
from peopleboy.tracker.reproductions.contour.particles import CROWN, FOOT, Floats, H, W, X, Y

FEATURES = ("strength", "top", "bottom", "colour", "colour_o", "colour_no")
"""Names of table 7.3: of the filter, the contour, and the colours of the whole, shared and other area."""

THERMAL, COLOUR = FEATURES[:3], FEATURES[3:]

_SLIVER = 0.1  # share of a part below which an area of it is ignored

Pairs = NDArray[np.int64]
Features = NDArray[np.float64]


def pair_features(
    state: NDArray[np.floating],
    models: Sequence[ColourModel | None],
    pairs: Pairs,
    view: FrameView,
    feet: Sequence[float] | None = None,
) -> Features:
    """Return the features of pairs of people: the first's minus the second's.

    Top and bottom are rows in image heights, positive downwards; similarities of colours are minus the
    distance from the person's model. A colour that cannot be compared for one of the two gives a difference
    of 0.

    Args:
        state: (M, 9) contours.
        models: (M,) appearance models of these people; None if unknown.
        pairs: (P, 2) first and second person, rows of `state`.
        view: the images.
        feet: (M,) rows of the feet [px] when last fully visible; None for the contour's own. While a person
            is partly occluded, the contour's end is arbitrary, and feet on a level floor indicate the
            distance.

    Returns:
        (P, 6) in the order of FEATURES; the mirrored pair has the same values with the sign turned.

    Source: thesis, section 7.1 and figure 7.1.
    """
    people: Floats = np.asarray(state, dtype=np.float32).reshape(-1, 9)
    top, bottom = _ends(people, view)
    if feet is not None:
        bottom = np.array(feet, dtype=np.float64) / view.image.shape[0]
    alone = np.stack([_strength(people, view), top, bottom], axis=1)
    result = np.zeros((len(pairs), len(FEATURES)))
    result[:, :3] = alone[pairs[:, 0]] - alone[pairs[:, 1]]
    if len(pairs) > 0 and (view.appearance is not None or view.colour is not None):
        both_ways = np.concatenate([pairs, pairs[:, ::-1]])
        one, other = np.split(_similarities(people, models, both_ways, view), 2)
        result[:, 3:] = np.nan_to_num(one - other)
    return result


def _strength(people: Floats, view: FrameView) -> Features:
    """Return the mean gradient (M,) along the contours, f of equation 4.3."""
    differences = view.model.differences(view.image, people)
    return np.asarray(np.add.reduce(differences * view.model.weights, axis=1), np.float64)


def _ends(people: Floats, view: FrameView) -> tuple[Features, Features]:
    """Return the rows (M,) of heads and feet in image heights."""
    y, h = people[:, Y].astype(np.float64), people[:, H]
    rows = view.image.shape[0]
    return (y - CROWN * h) / rows, (y + FOOT * h) / rows


def _similarities(
    people: Floats, models: Sequence[ColourModel | None], pairs: Pairs, view: FrameView
) -> Features:
    """Compare the first of each pair with its model (P, 3): the whole, the overlapped part, the rest."""
    one, other = people[pairs[:, 0]], people[pairs[:, 1]]
    parts, height = part_rectangles(one), one[:, H]
    shared = cut(parts, boxes(other)[:, None])
    area, covered = _area(parts), _area(shared)
    described = [
        _described(view, parts, height),
        _without(_described(view, shared, height), covered < _SLIVER * area),
        _without(_described(view, parts, height, shared), area - covered < _SLIVER * area),
    ]
    result = np.full((len(pairs), 3), np.nan)
    for row, index in enumerate(pairs[:, 0]):
        model = models[index]
        if model is not None:
            features = np.stack([each[row] for each in described])
            result[row] = -np.sqrt(squared_distances(features, model))
    return result


def _described(view: FrameView, areas: Floats, height: Floats, holes: Floats | None = None) -> Floats:
    """Describe areas (P, 3, 4) of people, (P, F), as the tracker describes whole people."""
    if view.appearance is None:
        assert view.colour is not None
        return view.colour.describe_rectangles(areas, height, holes)
    each = np.full((len(areas), PARTS, 4), np.nan, dtype=np.float32)
    if view.appearance.colour is not None:
        colours = view.appearance.colour.describe_rectangles(areas, height, holes)
        each[..., :3] = colours.reshape(len(areas), PARTS, 3, -1)[..., 0]
    each[..., 3] = view.appearance.thermal.describe_rectangles(areas, height, holes)
    return (each * view.appearance.scale).reshape(len(areas), -1)


def boxes(people: Floats) -> Floats:
    """Return the boxes (M, 4) of people: left, top, right, bottom [px]; head to feet, as wide as the body."""
    x, y, w, h = (people[:, k] for k in (X, Y, W, H))
    return np.stack([x - w, y - np.float32(CROWN) * h, x + w, y + np.float32(FOOT) * h], axis=1)


def cut(rectangles: Floats, by: Floats) -> Floats:
    """Intersect rectangles (..., 4) with others; empty ones have zero width or height."""
    start = np.maximum(rectangles[..., :2], by[..., :2])
    end = np.maximum(np.minimum(rectangles[..., 2:], by[..., 2:]), start)
    return np.concatenate([start, end], axis=-1)


def overlapping_pairs(state: NDArray[np.floating]) -> Pairs:
    """List the pairs (P, 2) of people (M, 9) whose boxes overlap, each pair once and the lower row first."""
    box = boxes(np.asarray(state, dtype=np.float32).reshape(-1, 9))
    shared = _area(cut(box[:, None], box[None]))
    return np.argwhere(np.triu(shared > 0, k=1))


def _area(rectangles: Floats) -> Floats:
    area: Floats = np.prod(rectangles[..., 2:] - rectangles[..., :2], axis=-1)
    return area


def _without(described: Floats, is_void: NDArray[np.bool_]) -> Floats:
    """Set to NaN the features (P, F) of parts (P, 3) whose area is too small."""
    features = described.reshape(len(described), PARTS, -1)
    return np.where(is_void[..., None], np.float32(np.nan), features).reshape(described.shape)
