"""Where on the floor people are said to be: errors in metres, and how honest the covariances are."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Self

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.tracker.boxes import Floats
from peopleboy.tracker.evaluation.sequence import Bools, Ints, TrackBoxes, TrueBoxes

CHI2_95: Final = 5.991  # quantile of chi squared with two degrees of freedom
SIDE_M: Final = 1.5
"""Side of the square that stands for a person on the floor: its IoU is above one half up to 0.5 m off."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Places:
    """Where people stand, in the robot's frame: one row per frame and person or track.

    Attributes:
        frame: (N,) from 1.
        id: (N,) unique within a frame.
        position_m: (N, 2) [m] forward, left.
        covariance_m2: (N, 3) xx, xy, yy [m2] of the error; None for the truth.

    Raises:
        BadInput: columns of other shapes.
    """

    frame: Ints
    id: Ints
    position_m: Floats
    covariance_m2: Floats | None = None

    def __post_init__(self) -> None:
        """Refuse columns that do not belong together."""
        rows = len(self.frame)
        shapes = [self.id.shape, self.position_m.shape]
        if self.covariance_m2 is not None:
            shapes.append(self.covariance_m2.shape)
        if shapes != [(rows,), (rows, 2), (rows, 3)][: len(shapes)]:
            raise BadInput(f"places: shapes must be ({rows},), ({rows}, 2), ({rows}, 3), got {shapes}")

    def find(self, frame: Ints, number: Ints) -> Ints:
        """Return for each pair of frame (M,) and id (M,) the index of the place, -1 where there is none."""
        index = {key: k for k, key in enumerate(zip(self.frame.tolist(), self.id.tolist(), strict=True))}
        wanted = zip(frame.tolist(), number.tolist(), strict=True)
        return np.array([index.get(key, -1) for key in wanted], dtype=np.int64)

    def as_targets(self, counted: Bools, visible: Floats) -> TrueBoxes:
        """Return squares on the floor [m] that stand for people, who count and are visible as given (N,)."""
        box = floor_squares(self.position_m)
        return TrueBoxes(frame=self.frame, id=self.id, box=box, counted=counted, visible=visible)

    def as_candidates(self, confidence: Floats) -> TrackBoxes:
        """Return squares on the floor [m] that stand for tracks, each with a confidence (N,)."""
        box = floor_squares(self.position_m)
        return TrackBoxes(frame=self.frame, id=self.id, box=box, confidence=confidence)


@dataclass(frozen=True, slots=True, eq=False)
class FloorErrors:
    """Errors of tracks on the floor against the people that they are matched with.

    Attributes:
        offset_m: (N, 2) [m] where the track says minus where the person is, in the robot's frame.
        covariance_m2: (N, 3) xx, xy, yy [m2] that the tracker claims for it.
    """

    offset_m: Floats
    covariance_m2: Floats

    def __add__(self, other: Self) -> Self:
        """Take the errors of two sequences together."""
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
        """Distance [m] that 95 % do not exceed; NaN without any."""
        return float(np.percentile(self._distance_m, 95.0)) if len(self) else math.nan

    @property
    def nees(self) -> float:
        """Mean of the normalised error squared, 2 for honest covariances; NaN where none is claimed.

        Source: Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation, 5.4.
        """
        squared = self._squared
        return float(np.mean(squared)) if len(squared) else math.nan

    @property
    def inside(self) -> float:
        """Share of errors within the 95 % ellipse [%]; NaN where no covariance is claimed."""
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
"""Of tracks that say of nobody where it stands."""


def measure_floor(
    frame: Ints, person: Ints, track: Ints, standing: Places | None, believed: Places | None
) -> FloorErrors:
    """Measure the errors on the floor of people and tracks that are matched.

    Args:
        frame: (M,) of each match.
        person: (M,) its id.
        track: (M,) the id of the track.
        standing: where people stand; None if nobody knows.
        believed: where the tracker says that they stand; None if it does not.
    """
    if standing is None or believed is None or believed.covariance_m2 is None:
        return NOWHERE
    there, said = standing.find(frame, person), believed.find(frame, track)
    is_known = (there >= 0) & (said >= 0)
    there, said = there[is_known], said[is_known]
    offset = believed.position_m[said] - standing.position_m[there]
    return FloorErrors(offset, believed.covariance_m2[said])


def floor_squares(position_m: Floats) -> Floats:
    """Return squares (..., 4) on the floor, left, top, width, height [m], that stand for people (..., 2).

    Trackers that give no boxes are scored by them, as others are by boxes in an image.
    """
    side = np.full(position_m.shape, SIDE_M)
    return np.concatenate([position_m - SIDE_M / 2.0, side], axis=-1)
