"""Metrics of positions on the floor: errors in metres, consistency of covariances, average precision."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple, Self

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.sequence import Bools, Ints, TrackBoxes, TrueBoxes

CHI2_95: Final = 5.991  # quantile of chi squared with two degrees of freedom
SIDE_M: Final = 1.5
"""Side of the square that represents a person on the floor: its IoU is above one half up to 0.5 m off."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Places:
    """Positions on the floor, in the robot frame: one row per frame and person or track.

    Attributes:
        frame: (N,) from 1.
        id: (N,) unique within a frame.
        position_m: (N, 2) [m] forward, left.
        covariance_m2: (N, 3) xx, xy, yy [m2]; None for ground truth.

    Raises:
        BadInput: columns have other shapes.
    """

    frame: Ints
    id: Ints
    position_m: Floats
    covariance_m2: Floats | None = None

    def __post_init__(self) -> None:
        """Refuse columns of inconsistent shapes."""
        rows = len(self.frame)
        shapes = [self.id.shape, self.position_m.shape]
        if self.covariance_m2 is not None:
            shapes.append(self.covariance_m2.shape)
        if shapes != [(rows,), (rows, 2), (rows, 3)][: len(shapes)]:
            raise BadInput(f"places: shapes must be ({rows},), ({rows}, 2), ({rows}, 3), got {shapes}")

    def find(self, frame: Ints, number: Ints) -> Ints:
        """Return the index of the position for each pair of frame (M,) and id (M,), -1 if there is none."""
        index = {key: k for k, key in enumerate(zip(self.frame.tolist(), self.id.tolist(), strict=True))}
        wanted = zip(frame.tolist(), number.tolist(), strict=True)
        return np.array([index.get(key, -1) for key in wanted], dtype=np.int64)

    def as_targets(self, counted: Bools, visible: Floats) -> TrueBoxes:
        """Return squares on the floor [m] for people, counted and visible as given (N,)."""
        box = floor_squares(self.position_m)
        return TrueBoxes(frame=self.frame, id=self.id, box=box, counted=counted, visible=visible)

    def as_candidates(self, confidence: Floats) -> TrackBoxes:
        """Return squares on the floor [m] for tracks, each with a confidence (N,)."""
        box = floor_squares(self.position_m)
        return TrackBoxes(frame=self.frame, id=self.id, box=box, confidence=confidence)


@dataclass(frozen=True, slots=True, eq=False)
class FloorErrors:
    """Errors of matched tracks on the floor.

    Attributes:
        offset_m: (N, 2) [m] estimated minus true position, in the robot frame.
        covariance_m2: (N, 3) xx, xy, yy [m2] of the tracker.
    """

    offset_m: Floats
    covariance_m2: Floats

    def __add__(self, other: Self) -> Self:
        """Return the errors of two sequences combined."""
        return type(self)(
            np.concatenate([self.offset_m, other.offset_m]),
            np.concatenate([self.covariance_m2, other.covariance_m2]),
        )

    def __len__(self) -> int:
        return len(self.offset_m)

    @property
    def mean_m(self) -> float:
        """Mean distance [m]; NaN without any."""
        return float(np.mean(self._distance_m)) if len(self) else math.nan

    @property
    def median_m(self) -> float:
        """Median distance [m]; NaN without any."""
        return float(np.median(self._distance_m)) if len(self) else math.nan

    @property
    def p95_m(self) -> float:
        """95th percentile of the distance [m]; NaN without any."""
        return float(np.percentile(self._distance_m, 95.0)) if len(self) else math.nan

    @property
    def nees(self) -> float:
        """Mean normalised estimation error squared, 2 for consistent covariances; NaN without covariances.

        Source: Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation, 5.4.
        """
        squared = self._squared
        return float(np.mean(squared)) if len(squared) else math.nan

    @property
    def inside(self) -> float:
        """Share of errors within the 95 % ellipse [%]; NaN without covariances."""
        squared = self._squared
        return 100.0 * float(np.mean(squared <= CHI2_95)) if len(squared) else math.nan

    @property
    def _distance_m(self) -> Floats:
        return np.asarray(np.hypot(*self.offset_m.T))

    @property
    def _squared(self) -> Floats:
        """Squared Mahalanobis distances (M,) of the errors whose covariance can be inverted."""
        xx, xy, yy = self.covariance_m2.T
        determinant = xx * yy - xy * xy
        is_sure = determinant > 0.0
        x, y = self.offset_m[is_sure].T
        xx, xy, yy = self.covariance_m2[is_sure].T
        return np.asarray((yy * x * x - 2.0 * xy * x * y + xx * y * y) / determinant[is_sure])


NOWHERE: Final = FloorErrors(np.zeros((0, 2)), np.zeros((0, 3)))
"""Errors of tracks without positions."""


def measure_floor(
    frame: Ints, person: Ints, track: Ints, standing: Places | None, believed: Places | None
) -> FloorErrors:
    """Return the errors on the floor of matched people and tracks.

    Args:
        frame: (M,) of each match.
        person: (M,) id of the person.
        track: (M,) id of the track.
        standing: true positions; None if unknown.
        believed: the tracker's positions; None if it has none.
    """
    if standing is None or believed is None or believed.covariance_m2 is None:
        return NOWHERE
    there, said = standing.find(frame, person), believed.find(frame, track)
    is_known = (there >= 0) & (said >= 0)
    there, said = there[is_known], said[is_known]
    offset = believed.position_m[said] - standing.position_m[there]
    return FloorErrors(offset, believed.covariance_m2[said])


def floor_squares(position_m: Floats) -> Floats:
    """Return squares (..., 4) on the floor, left, top, width, height [m], for people (..., 2).

    They score trackers without boxes, as boxes in an image do for others.
    """
    side = np.full(position_m.shape, SIDE_M)
    return np.concatenate([position_m - SIDE_M / 2.0, side], axis=-1)


# Average precision of detections on the floor.


class FloorFrame(NamedTuple):
    """Detections and true positions of people at one instant, in one frame of reference.

    Attributes:
        places_m: (M, 2) detections.
        scores: (M,) the higher, the more certain.
        people_m: (P, 2) true positions.
        is_counted: (P,) whether a person has to be found; detections of the others are left out.
    """

    places_m: Floats
    scores: Floats
    people_m: Floats
    is_counted: Bools


class FloorPrecision(NamedTuple):
    """Result of `average_precision`.

    Attributes:
        average_precision: area below the curve of precision over recall, 0..1; NaN without people.
        error_m: mean distance of correct detections from the true positions; NaN without any.
        people: number of people to find.
        recall: (K,) by decreasing score.
        precision: (K,) the same.
    """

    average_precision: float
    error_m: float
    people: int
    recall: Floats
    precision: Floats


def average_precision(frames: Sequence[FloorFrame], radius_m: float) -> FloorPrecision:
    """Evaluate detections, each of which is correct if it is within a radius of a person not yet found.

    In each frame, detections are assigned in the order of their scores, each to the nearest person. The
    precision is interpolated: at each recall it is the greatest at this or a higher recall.
    """
    scores, hits, errors, people = [], [], [], 0
    for frame in frames:
        people += int(frame.is_counted.sum())
        for score, person, away_m in _assign(frame, radius_m):
            if person < 0 or frame.is_counted[person]:
                scores.append(score)
                hits.append(person >= 0)
                errors += [away_m] if person >= 0 else []
    order = np.argsort(-np.array(scores), kind="stable")
    right = np.cumsum(np.array(hits, np.float64)[order])
    precision = right / np.arange(1, len(order) + 1)
    best = np.maximum.accumulate(precision[::-1])[::-1]
    recall = right / max(people, 1)
    area = float(np.sum(np.diff(recall, prepend=0.0) * best)) if people else float("nan")
    error_m = float(np.mean(errors)) if errors else float("nan")
    return FloorPrecision(area, error_m, people, recall, precision)


def _assign(frame: FloorFrame, radius_m: float) -> list[tuple[float, int, float]]:
    """Return score, person and distance of each detection; -1 for none."""
    found, is_free = [], np.ones(len(frame.people_m), np.bool_)
    for k in np.argsort(-frame.scores, kind="stable").tolist():
        away = np.where(is_free, np.hypot(*(frame.people_m - frame.places_m[k]).T), np.inf)
        person = int(away.argmin()) if len(away) else -1
        if person >= 0 and away[person] <= radius_m:
            is_free[person] = False
            found.append((float(frame.scores[k]), person, float(away[person])))
        else:
            found.append((float(frame.scores[k]), -1, np.inf))
    return found
