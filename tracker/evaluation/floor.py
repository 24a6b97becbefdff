"""Metrics of positions on the floor: errors in metres, and consistency of the covariances."""

import math
from dataclasses import dataclass
from typing import Final, Self

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
