"""What the people tracker asks of a sensor: detections of people, and what it would see of a track."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.boxes import intersection
from peopleboy.tracker.frame import Floats, Frame
from peopleboy.tracker.tracking.appearance import FEATURES, SAMPLES, Colours, Pattern
from peopleboy.tracker.tracking.config import AssociationConfig, ExistenceConfig, ReidentificationConfig
from peopleboy.tracker.tracking.measurement import Measurement
from peopleboy.tracker.tracking.motion_filter import StateEstimates, predicted_boxes
from peopleboy.tracker.tracking.viewpoint import Position, Viewpoint


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Predictions:
    """The K tracks, predicted for the time of a frame.

    Attributes:
        keys: of the tracks, by which a sensor may remember something about them.
        states: in the level frame.
        ratio: (K,) widths of boxes divided by their heights.
        log_odds: (K,) evidence that each is a person.
        is_confirmed: (K,) whether each is confirmed.
        origin_m: origin of the level frame in the robot frame; None without a calibrated camera.
    """

    keys: tuple[int, ...]
    states: StateEstimates
    ratio: Floats
    log_odds: Floats
    is_confirmed: NDArray[np.bool_]
    origin_m: Position | None

    def __len__(self) -> int:
        return len(self.keys)

    @property
    def places_m(self) -> Floats:
        """Positions (K, 2) forward and left in the robot frame; needs the origin."""
        assert self.origin_m is not None
        mean = self.states.mean
        return np.column_stack([self.origin_m[0] + mean[:, 2], self.origin_m[1] - mean[:, 0]])

    def take(self, rows: Sequence[int], states: StateEstimates | None = None) -> "Predictions":
        """Return some of the tracks, in their states or in those of other states (K)."""
        chosen = np.array(rows, np.intp)
        return Predictions(
            keys=tuple(self.keys[row] for row in rows),
            states=(self.states if states is None else states).take(chosen),
            ratio=self.ratio[chosen],
            log_odds=self.log_odds[chosen],
            is_confirmed=self.is_confirmed[chosen],
            origin_m=self.origin_m,
        )


class Settings(NamedTuple):
    """Settings that depend on the sensor, and on whether it is calibrated."""

    existence: ExistenceConfig
    association: AssociationConfig
    reidentification: ReidentificationConfig


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SensorDetections:
    """M detections of people in one image, with their appearance.

    Attributes:
        camera: whose image it is.
        boxes: (M, 4) [px].
        scores: (M,) log-odds.
        measurement: of the state of a track.
        expected: (K, 4) boxes of the predicted tracks in the same image [px].
        pattern: (M, 72) thermal pattern; 0 where unknown.
        colours: (M, 512) of clothes; 0 where unknown.
        assigned: index of a detection by the row of its track, for detections that were searched for there.
        is_search: whether the whole image was searched, so that a detection without a track is a new person.
        has_width: (M,) whether the width of each box is measured, rather than assumed; None if all are.
        common_m: (M, 2) standard deviations of positions across and along the line of sight that further
            images of a person do not reduce, as they come from gait and build; None if there are none.
        is_masked: whether colours are of a person's own pixels, so that they do not mix where people overlap.
        posture: (M, 5) log-odds of the postures, up to a constant; None if they are not recognised.
        edges: (M, 2) left and right edge of the whole person, from the middle of the box, in its heights; NaN
            where unknown; None if they are not measured.
        settings: of this sensor.
    """

    camera: str
    boxes: Floats
    scores: Floats
    measurement: Measurement
    expected: Floats
    pattern: Pattern
    colours: Colours
    assigned: Mapping[int, int] = field(default_factory=dict)
    is_search: bool = True
    has_width: NDArray[np.bool_] | None = None
    is_masked: bool = False
    common_m: Floats | None = None
    posture: Floats | None = None
    edges: Floats | None = None
    settings: Settings

    def __len__(self) -> int:
        return len(self.boxes)

    def without_colours(self, rows: NDArray[np.bool_]) -> "SensorDetections":
        """Return them without the colours of some (M,), which may be another person's."""
        return replace(self, colours=np.where(rows[:, None], np.float32(0.0), self.colours))

    def ratio(self, row: int) -> float:
        """Return the width of a box divided by its height."""
        return float(self.boxes[row, 2] / self.boxes[row, 3])


class Visibility(NamedTuple):
    """What an image shows where K tracks are predicted.

    Attributes:
        hidden: (K,) share of each that something nearer hides; NaN where unknown.
        is_present: (K,) whether some of it is visible, so that the person is there.
        is_absent: (K,) whether the background is visible instead.
    """

    hidden: Floats
    is_present: NDArray[np.bool_]
    is_absent: NDArray[np.bool_]


class ProjectedBoxes(NamedTuple):
    """The tracks in the image of a camera.

    Attributes:
        boxes: (K, 4) [px].
        is_inside: (K,) whether each is in front of the camera, with some of the box inside the image.
        is_scan: whether it is the scan of a range finder, of which tracks have no boxes.
    """

    boxes: Floats
    is_inside: NDArray[np.bool_]
    is_scan: bool = False


def project_boxes(predicted: Predictions, view: Viewpoint, shape: tuple[int, int]) -> ProjectedBoxes:
    """Return the tracks in the image of a planar camera with these rows and columns [px]."""
    boxes = predicted_boxes(predicted.states, view, predicted.ratio)
    is_ahead = predicted.states.mean[:, 2] > view.at_m[2]
    rows, columns = shape
    is_inside = intersection(boxes, np.array([-0.5, -0.5, columns, rows])) > 0.0
    return ProjectedBoxes(boxes, is_inside & is_ahead)


@dataclass(frozen=True, slots=True, eq=False)
class SensorExplanations:
    """The explanations of several sensors.

    Attributes:
        parts: one for each sensor.
    """

    parts: tuple[object, ...]


def level_places(places_m: Floats, origin_m: Position) -> Floats:
    """Return positions (M, 2) to the right and ahead in the level frame, from the robot frame."""
    return np.column_stack([origin_m[1] - places_m[:, 1], places_m[:, 0] - origin_m[0]])


def parts_of(explanation: object) -> tuple[object, ...]:
    """Return the explanations in the `parts` of a joined one; none for a single explanation."""
    return getattr(explanation, "parts", ())


def no_appearance(count: int) -> tuple[Pattern, Colours]:
    """Return the appearance of detections of which nothing is known."""
    return np.zeros((count, SAMPLES), np.float32), np.zeros((count, FEATURES), np.float32)


class Sensor(Protocol):
    """Detects people in the images of one or several cameras. It knows nothing of tracks but predictions."""

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras; the first gives boxes."""
        ...

    @property
    def explanation(self) -> object:
        """What it detected last, for recordings."""
        ...

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Refuse unsuitable cameras, by name, before the first frame.

        Raises:
            BadInput: a camera is unsuitable.
        """
        ...

    def detect(self, frame: Frame, predicted: Predictions) -> SensorDetections | None:
        """Detect people in the next frame; None if it has no new image.

        Raises:
            BadInput: an image is invalid.
        """
        ...

    def detect_in(self, frame: Frame, box: Floats, predicted: Predictions) -> SensorDetections | None:
        """Describe a box (4,) in which a person is known to be; None if it has no image with boxes."""
        ...

    def visibility(self, frame: Frame, predicted: Predictions) -> Visibility | None:
        """Return what the image shows where tracks are predicted; None if it does not show what is nearer."""
        ...

    def project(self, frame: Frame, predicted: Predictions) -> ProjectedBoxes | None:
        """Return the tracks in the image of the first camera; None if it has none."""
        ...

    def remember(self, detections: SensorDetections, found: Mapping[int, int], keys: tuple[int, ...]) -> None:
        """Note which detection, by the row of the track, was found to be of which track."""
        ...
