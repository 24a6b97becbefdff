"""How well people are told from background: pixels, and what a tracker takes from them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.foreground_learning.masked_film import MaskedFilm

Floats = NDArray[np.float64]

NEAREST_M: Final = 1.2
FARTHEST_M: Final = 6.0
"""Between which distances people are judged one by one."""
_LEAST_PX: Final = 12  # of a person, to be judged one by one
_REACH_PX: Final = 6  # how far round a person what is told counts as that one's


@dataclass(slots=True, kw_only=True)
class Judgement:
    """Sums over images, and errors of single people.

    Attributes:
        both, either: pixels that are people in truth and as told, and those that are one of both.
        false_px, images: pixels told to be people far from any, and images.
        foot_px: by how many rows the lowest one is off, positive when it is told too low.
        column_px: by how many columns the mean one is off.
        found: for each person that one could judge, whether half of it was told.
    """

    both: int = 0
    either: int = 0
    false_px: int = 0
    images: int = 0
    foot_px: list[float] = field(default_factory=list)
    column_px: list[float] = field(default_factory=list)
    found: list[bool] = field(default_factory=list)

    def in_words(self) -> str:
        """Say how well it went."""
        foot, column = _mean_size(self.foot_px), _mean_size(self.column_px)
        return (
            f"overlap {self.both / max(self.either, 1):.3f}, {_mean_size(self.found):.1%} of people found, "
            f"lowest foot off by {foot:.2f} rows, middle by {column:.2f} columns, "
            f"{self.false_px / max(self.images, 1):.1f} false pixels an image"
        )


def judge(film: MaskedFilm, told: Iterable[NDArray[np.float32]], sums: Judgement) -> None:
    """Judge probabilities for each image of a film, and add to the sums."""
    for k, probability in enumerate(told):
        _judge_image(sums, film.who[k], probability > 0.5, np.hypot(*film.place_m[k].T))


def _judge_image(sums: Judgement, who: NDArray[np.uint8], told: NDArray[np.bool_], away_m: Floats) -> None:
    is_person = who > 0
    sums.images += 1
    sums.both += int((told & is_person).sum())
    sums.either += int((told | is_person).sum())
    sums.false_px += int((told & ~_round_about(is_person)).sum())
    for k in np.flatnonzero((away_m >= NEAREST_M) & (away_m <= FARTHEST_M)).tolist():
        own = who == k + 1
        if own.sum() >= _LEAST_PX:
            _judge_person(sums, own, told & _round_about(own) & (own | ~is_person))


def _judge_person(sums: Judgement, own: NDArray[np.bool_], told: NDArray[np.bool_]) -> None:
    sums.found.append(bool((told & own).sum() >= 0.5 * own.sum()))
    if told.any():
        sums.foot_px.append(float(_lowest(told) - _lowest(own)))
        turn = np.angle(_mean_direction(told) / _mean_direction(own))
        sums.column_px.append(float(turn / (2.0 * np.pi) * own.shape[1]))


def _mean_size(values: Sequence[float]) -> float:
    return float(np.abs(np.asarray(values, np.float64)).mean()) if values else math.nan


def _lowest(mask: NDArray[np.bool_]) -> int:
    """The lowest row with two pixels, or with one if no row has more."""
    counts = mask.sum(axis=1)
    return int(np.flatnonzero(counts >= min(2, counts.max()))[-1])


def _mean_direction(mask: NDArray[np.bool_]) -> complex:
    turns = np.arange(mask.shape[1]) / mask.shape[1]
    return complex(mask.sum(axis=0) @ np.exp(2j * np.pi * turns))


def _round_about(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Grow a mask on all sides, over the seam."""
    ring = np.pad(mask.astype(np.uint8), ((0, 0), (_REACH_PX, _REACH_PX)), mode="wrap")
    size = 2 * _REACH_PX + 1
    return np.asarray(cv2.dilate(ring, np.ones((size, size), np.uint8))[:, _REACH_PX:-_REACH_PX], np.bool_)
