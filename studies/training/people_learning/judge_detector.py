"""How well the detector finds people in worlds that it never saw."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.people_learning.cut_off import sides
from peopleboy.studies.training.people_learning.shots import PeopleShot
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.proposals.detector import SMALLEST_PX, look
from peopleboy.tracker.proposals.model import PeopleModel, PeopleTrees
from peopleboy.tracker.proposals.suppression import Proposals
from peopleboy.tracker.proposals.window import Kind

Floats = NDArray[np.float64]

_HIT: Final = 0.5  # IoU
_THERE: Final = 0.4  # IoU with somebody who is there
_LEAST_SCORE: Final = -2.0
FALSE_AN_IMAGE: Final = 0.1
"""Mistakes per image at which it is told how many people are found."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What was found in some images, against the truth.

    Attributes:
        score: (N,) of what was found, or what nobody need find left out.
        is_person: (N,) whether it is somebody.
        overlap: (N,) IoU with them.
        people: how many there are to be found.
        images: how many were looked at.
    """

    score: Floats
    is_person: NDArray[np.bool_]
    overlap: Floats
    people: int
    images: int

    def recall(self, false_an_image: float) -> float:
        """Give the share of people who are found with so many mistakes per image."""
        if not self.people:
            return float("nan")
        order = np.argsort(-self.score, kind="stable")
        right = self.is_person[order]
        is_so_far = np.cumsum(~right) <= false_an_image * self.images
        return int((right & is_so_far).sum()) / self.people

    def precision(self) -> float:
        """Give the mean precision over recall: the area under the envelope of their curve (VOC 2010)."""
        if not self.people:
            return float("nan")
        right = self.is_person[np.argsort(-self.score, kind="stable")]
        precision = np.cumsum(right) / np.arange(1, len(right) + 1)
        envelope = np.maximum.accumulate(precision[::-1])[::-1]
        return float(envelope[right].sum()) / self.people

    def in_words(self) -> str:
        """Say how well it went."""
        overlap = self.overlap[self.is_person]
        return (
            f"{self.people} people in {self.images} images: average precision {self.precision():.3f}, recall "
            f"{self.recall(FALSE_AN_IMAGE):.3f} at {FALSE_AN_IMAGE} mistakes an image, mean overlap "
            f"{overlap.mean() if len(overlap) else 0.0:.3f}"
        )


def judge_detector(model: PeopleModel, shots: Iterable[PeopleShot], *, knows_mount: bool) -> Found:
    """Look for people in images; those who are small, hidden or not upright are neither right nor wrong."""
    parts: list[tuple[Floats, NDArray[np.bool_], Floats]] = []
    people = images = 0
    for shot in shots:
        mount = shot.mount if knows_mount else None
        found = look(model, shot.grey, shot.change, mount, SMALLEST_PX, _LEAST_SCORE)
        is_counted = shot.is_good & (shot.box[:, 3] >= SMALLEST_PX) & (shot.box[:, 3] <= _tallest(shot))
        people, images = people + int(is_counted.sum()), images + 1
        parts.append(_matched(found, shot.box, is_counted))
    scores, hits, overlaps = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Found(scores, hits, overlaps, people, images)


def log_odds_line(kind: Kind, trees: PeopleTrees, shots: Sequence[PeopleShot]) -> tuple[float, float]:
    """Tell gain and offset that make scores of windows of a kind the log odds that they show somebody.

    It is a logistic regression (Platt 1999) over what is proposed in images; who is there counts, however
    hidden.

    Raises:
        BadInput: scikit-learn is missing, only people or none are proposed, or people score no more than
            what is none.
    """
    try:
        from sklearn.linear_model import LogisticRegression  # here, as it comes with the extra `train`
    except ImportError as error:
        raise BadInput("train-detector needs scikit-learn: pip install scikit-learn") from error
    model = PeopleModel({kind: trees})
    scores: list[float] = []
    is_somebody: list[bool] = []
    for shot in shots:
        for side in sides(shot, np.random.default_rng(int(shot.grey.sum(dtype=np.int64))), kind):
            found = look(model, side.grey, side.change, None, SMALLEST_PX, _LEAST_SCORE)
            overlap = iou(found.box[:, None], side.box[None])
            scores += found.score.tolist()
            is_somebody += np.any(overlap >= _THERE, axis=1).tolist()
    if all(is_somebody) or not any(is_somebody):
        raise BadInput(f"{sum(is_somebody)} of {len(is_somebody)} proposals are people; take more worlds")
    line = LogisticRegression(C=1e6).fit(np.array(scores)[:, None], is_somebody)
    gain, offset = float(line.coef_[0, 0]), float(line.intercept_[0])
    if gain <= 0.0:
        raise BadInput(f"people score no more than what is none, gain {gain:.3f}; take more worlds")
    return gain, offset


def _tallest(shot: PeopleShot) -> float:
    """Tell how tall [px] a person can be whose window fits into the image."""
    return 0.75 * len(shot.grey)


def _matched(
    found: Proposals, box: Floats, is_counted: NDArray[np.bool_]
) -> tuple[Floats, NDArray[np.bool_], Floats]:
    """Give score, whether it is somebody, and overlap with them of what was found, the surest first."""
    is_free = np.ones(len(box), np.bool_)
    rows: list[tuple[float, bool, float]] = []
    for score, overlap in zip(found.score.tolist(), iou(found.box[:, None], box[None]), strict=True):
        mine = np.where(is_free & is_counted & (overlap >= _HIT), overlap, 0.0)
        if mine.any():
            is_free[int(mine.argmax())] = False
            rows.append((score, True, float(mine.max())))
        elif not (overlap[~is_counted] >= _HIT).any():
            rows.append((score, False, 0.0))
    table = np.array(rows).reshape(-1, 3)
    return table[:, 0], table[:, 1] > 0.5, table[:, 2]
