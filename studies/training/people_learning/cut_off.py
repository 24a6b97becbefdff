"""Images that cut people off: near ones of whom a camera shows legs, or a face and shoulders."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.people_learning.shots import PeopleShot
from peopleboy.tracker.proposals.window import Kind

_AS_IT_IS: Final = 0.2  # of images
_AT_THE_FEET: Final = 0.4  # of the others; likewise at the head, and the rest at both
_AT_THE_HEAD: Final = 0.4
_TALL_PX: Final = 60.0  # who is cut off
_FEWEST_ROWS: Final = 40
_ABOVE: Final = (0.15, 0.65)  # shares of the height
_BELOW: Final = (0.3, 0.65)
_BOTH: Final = (0.2, 0.4)
_LEAST_ABOVE: Final = 0.2  # of somebody who can be learned from is beyond the image, or
_LEAST_BELOW: Final = 0.35
_MOST: Final = 0.66
_MOST_ASIDE: Final = 0.5  # of the width


def varied(shot: PeopleShot, rng: np.random.Generator, kind: Kind) -> PeopleShot:
    """Give an image as it is or otherwise; who is good in it can be learned from for windows of a kind."""
    if kind is Kind.WHOLE:
        return shot.varied(rng)
    side = shot.mirrored() if rng.random() < 0.5 else shot
    if rng.random() >= _AS_IT_IS:
        side = cut_off(side, rng)
    return replace(side, is_good=who_is_cut(side)).recoloured(rng)


def sides(shot: PeopleShot, rng: np.random.Generator, kind: Kind) -> tuple[PeopleShot, PeopleShot]:
    """Give an image twice, by which scores of windows of a kind are made log odds."""
    if kind is Kind.WHOLE:
        return shot, shot.spanned(rng)
    return varied(shot, rng, kind), varied(shot, rng, kind)


def has_people(shot: PeopleShot, kind: Kind) -> bool:
    """Tell whether there is somebody to learn from, for windows of a kind."""
    return bool((shot.is_good if kind is Kind.WHOLE else _tall(shot)).any())


def who_is_cut(shot: PeopleShot) -> NDArray[np.bool_]:
    """Tell who (P,) of those who are clear is cut off at head or feet, but not all but wholly."""
    rows, columns = shot.grey.shape
    left, top, width, height = shot.box.T
    above = np.maximum(-top, 0.0) / height
    below = np.maximum(top + height - rows, 0.0) / height
    aside = (np.maximum(-left, 0.0) + np.maximum(left + width - columns, 0.0)) / width
    is_cut = (above > _LEAST_ABOVE) | (below > _LEAST_BELOW)
    is_enough = (above + below <= _MOST) & (aside <= _MOST_ASIDE)
    return np.asarray(shot.is_clear & is_cut & is_enough, np.bool_)


def _tall(shot: PeopleShot) -> NDArray[np.bool_]:
    return np.asarray(shot.is_clear & (shot.box[:, 3] > _TALL_PX), np.bool_)


def cut_off(shot: PeopleShot, rng: np.random.Generator) -> PeopleShot:
    """Give a part of it that ends in the middle of somebody."""
    tall = np.flatnonzero(_tall(shot))
    if not len(tall):
        return shot
    _, top, _, height = shot.box[int(rng.choice(tall))].tolist()
    where = rng.random()
    if where < _AT_THE_FEET:
        return shot.part(0, top + (1.0 - rng.uniform(*_BELOW)) * height, _FEWEST_ROWS)
    if where < _AT_THE_FEET + _AT_THE_HEAD:
        return shot.part(top + rng.uniform(*_ABOVE) * height, len(shot.grey), _FEWEST_ROWS)
    first, end = (rng.uniform(*_BOTH) for _ in range(2))
    return shot.part(top + first * height, top + (1.0 - end) * height, _FEWEST_ROWS)
