"""Evaluation of the cascade on validation worlds, and the calibration of its scores."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.detector.augmentation import calibration_pair
from peopleboy.studies.training.detector.world_sequences import ThermalImage
from peopleboy.studies.training.specification import missing_package
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.detector import SMALLEST_PX, detect_with_trees
from peopleboy.tracker.sensors.thermal.detector.people_trees import PeopleModel, PeopleTrees
from peopleboy.tracker.sensors.thermal.detector.window import WindowKind

Floats = NDArray[np.float64]

_HIT: Final = 0.5  # IoU
_THERE: Final = 0.4  # IoU with a person, from which on a detection is a positive for calibration
_LEAST_SCORE: Final = -2.0
_TALLEST: Final = 0.75  # of the image height; the window of a taller person does not fit into the image
FALSE_PER_IMAGE: Final = 0.1
"""False positives per image at which recall is reported."""


@dataclass(frozen=True, slots=True, eq=False)
class DetectionScores:
    """Detections in some images, matched with the truth.

    Attributes:
        score: (N,) scores of the detections, without matches of ignored people.
        is_person: (N,) whether the detection matches a person.
        overlap: (N,) IoU with that person.
        people: number of people that count.
        images: number of images.
    """

    score: Floats
    is_person: NDArray[np.bool_]
    overlap: Floats
    people: int
    images: int

    def recall(self, false_per_image: float) -> float:
        """Return the recall at a number of false positives per image."""
        if not self.people:
            return float("nan")
        order = np.argsort(-self.score, kind="stable")
        right = self.is_person[order]
        is_so_far = np.cumsum(~right) <= false_per_image * self.images
        return int((right & is_so_far).sum()) / self.people

    def precision(self) -> float:
        """Return the average precision: the area under the envelope of precision over recall (VOC 2010)."""
        if not self.people:
            return float("nan")
        right = self.is_person[np.argsort(-self.score, kind="stable")]
        precision = np.cumsum(right) / np.arange(1, len(right) + 1)
        envelope = np.maximum.accumulate(precision[::-1])[::-1]
        return float(envelope[right].sum()) / self.people

    def __str__(self) -> str:
        overlap = self.overlap[self.is_person]
        return (
            f"{self.people} people in {self.images} images: average precision {self.precision():.3f}, "
            f"recall {self.recall(FALSE_PER_IMAGE):.3f} at {FALSE_PER_IMAGE} false positives per image, "
            f"mean IoU {overlap.mean() if len(overlap) else 0.0:.3f}"
        )


def evaluate_trees(
    model: PeopleModel, samples: Iterable[ThermalImage], *, knows_mount: bool
) -> DetectionScores:
    """Detect people in images and match them; small, occluded and non-upright people are ignored."""
    parts: list[tuple[Floats, NDArray[np.bool_], Floats]] = []
    people = images = 0
    for image in samples:
        mount = image.mount if knows_mount else None
        found = detect_with_trees(model, image.grey, image.change, mount, SMALLEST_PX, _LEAST_SCORE)
        height, tallest = image.box[:, 3], _TALLEST * len(image.grey)
        is_counted = image.is_good & (height >= SMALLEST_PX) & (height <= tallest)
        people, images = people + int(is_counted.sum()), images + 1
        parts.append(_match(found, image.box, is_counted))
    scores, hits, overlaps = (np.concatenate(column) for column in zip(*parts, strict=True))
    return DetectionScores(scores, hits, overlaps, people, images)


def calibrate(kind: WindowKind, trees: PeopleTrees, samples: Sequence[ThermalImage]) -> tuple[float, float]:
    """Return the gain and offset that map scores of windows of a kind to log odds of a person.

    They are fitted by logistic regression (Platt 1999) on detections in images; occluded people count, too.

    Raises:
        BadInput: scikit-learn is missing, all detections are positive or all negative, or people do not score
            higher than negatives.
    """
    model = PeopleModel({kind: trees})
    scores: list[float] = []
    is_person: list[bool] = []
    for image in samples:
        rng = np.random.default_rng(int(image.grey.sum(dtype=np.int64)))
        for version in calibration_pair(image, rng, kind):
            found = detect_with_trees(model, version.grey, version.change, None, SMALLEST_PX, _LEAST_SCORE)
            overlap = iou(found.box[:, None], version.box[None])
            scores += found.score.tolist()
            is_person += np.any(overlap >= _THERE, axis=1).tolist()
    gain, offset = log_odds_line(np.array(scores), np.array(is_person, np.bool_))
    if gain <= 0.0:
        raise BadInput(f"people do not score higher than negatives, gain {gain:.3f}; use more sequences")
    return gain, offset


def log_odds_line(score: Floats, is_person: NDArray[np.bool_]) -> tuple[float, float]:
    """Fit the gain and offset that map scores (N,) to log odds, by logistic regression (Platt 1999).

    Raises:
        BadInput: scikit-learn is missing, or all samples have the same label.
    """
    try:
        from sklearn.linear_model import LogisticRegression  # imported late: evaluation does not need it
    except ImportError:
        raise missing_package("the detector", "scikit-learn") from None
    check_labels(is_person)
    line = LogisticRegression(C=1e6).fit(score[:, None], is_person)
    return float(line.coef_[0, 0]), float(line.intercept_[0])


def check_labels(is_person: NDArray[np.bool_]) -> None:
    """Check that detections include positives and negatives.

    Raises:
        BadInput: all are positive, or all are negative.
    """
    if is_person.all() or not is_person.any():
        raise BadInput(
            f"{is_person.sum()} of {len(is_person)} validation detections are people; use more sequences"
        )


def _match(
    found: Detections, box: Floats, is_counted: NDArray[np.bool_]
) -> tuple[Floats, NDArray[np.bool_], Floats]:
    """Return score, whether it matches a person, and IoU of each detection, by descending score."""
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
