"""The thermal sensor: boxes of people in the thermal image, with their appearance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.tracker.frame import COLOUR, THERMAL, Floats, Frame
from peopleboy.tracker.sensors.box_detector import BoxDetector, DetectedBoxes
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.scheduled_detector import ScheduledDetector
from peopleboy.tracker.tracking.appearance import describe_colours, describe_patterns
from peopleboy.tracker.tracking.config import PeopleTrackerConfig
from peopleboy.tracker.tracking.measurement import BoxMeasurement
from peopleboy.tracker.tracking.motion_filter import predicted_boxes
from peopleboy.tracker.tracking.sensor import (
    Predictions,
    ProjectedBoxes,
    SensorDetections,
    Settings,
    Visibility,
    no_appearance,
    project_boxes,
)
from peopleboy.tracker.tracking.viewpoint import Viewpoint


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DetectionExplanation:
    """The detections of the last frame.

    Attributes:
        boxes: (M, 4) [px] in the thermal image.
        scores: (M,) log-odds that they are people.
        edges: (M, 2) of whole people, as in `Detections`.
    """

    boxes: Floats
    scores: Floats
    edges: Floats


class ThermalSensor:
    """Detects people in the thermal image, and describes them by their heat and by the colour image.

    Args:
        config: of the tracker.
        detector: of people; None for the learned detector.
    """

    def __init__(
        self, config: PeopleTrackerConfig | None = None, detector: BoxDetector | None = None
    ) -> None:
        self._config = PeopleTrackerConfig() if config is None else config
        self._detector = ScheduledDetector(self._config) if detector is None else detector
        self._view: tuple[Calibration | None, tuple[int, int], Viewpoint] | None = None
        self._explanation = DetectionExplanation(
            boxes=np.empty((0, 4)), scores=np.empty(0), edges=np.empty((0, 2))
        )

    @property
    def cameras(self) -> tuple[str, ...]:
        """The thermal camera, and the colour camera, used for detection and re-identification."""
        return (THERMAL, COLOUR)

    @property
    def explanation(self) -> DetectionExplanation:
        """The detections of the last image."""
        return self._explanation

    def check_cameras(self, calibrations: Mapping[str, Calibration]) -> None:
        """Accept any camera, calibrated or not."""

    def detect(self, frame: Frame, predicted: Predictions) -> SensorDetections | None:
        """Detect people in the next image; None without one.

        Raises:
            BadInput: the image is invalid.
        """
        if THERMAL not in frame.images:
            return None
        view = self._viewpoint(frame, predicted)
        expected = predicted_boxes(predicted.states, view, predicted.ratio)
        boxes = self._detector.detect(frame, view, predicted, expected)
        if boxes is None:
            return None
        existence, found = self._settings(view).existence, boxes.found
        found = found._replace(score=existence.trust * found.score + existence.lasting)
        described = self._described(frame, boxes._replace(found=found), expected, view)
        edges = found.joined(boxes.followed).edges
        self._explanation = DetectionExplanation(boxes=described.boxes, scores=described.scores, edges=edges)
        return replace(described, edges=edges)

    def detect_in(self, frame: Frame, box: Floats, predicted: Predictions) -> SensorDetections | None:
        """Describe a box (4,) in which a person is known to be."""
        if THERMAL not in frame.images:
            return None
        view = self._viewpoint(frame, predicted)
        boxes = DetectedBoxes(Detections.from_trees(box[None], np.zeros(1)))
        expected = predicted_boxes(predicted.states, view, predicted.ratio)
        return self._described(frame, boxes, expected, view)

    def visibility(self, frame: Frame, predicted: Predictions) -> Visibility | None:
        """Return None: the thermal image does not show what is nearer."""

    def project(self, frame: Frame, predicted: Predictions) -> ProjectedBoxes | None:
        """Return the tracks in the thermal image; None before the first one."""
        if THERMAL in frame.images:
            self._viewpoint(frame, predicted)
        if self._view is None:
            return None
        _, shape, view = self._view
        return project_boxes(predicted, view, shape)

    def remember(self, detections: SensorDetections, found: Mapping[int, int], keys: Sequence[int]) -> None:
        """Let the detector remember the tracks of its detections."""
        self._detector.remember(detections, found, keys)

    def _described(
        self, frame: Frame, boxes: DetectedBoxes, expected: Floats, view: Viewpoint
    ) -> SensorDetections:
        """Add the appearance of all detections but those that were located without the detector."""
        new, every = boxes.found.box, boxes.found.joined(boxes.followed)
        pattern, colours = no_appearance(len(every.box))
        if len(new):
            pattern[: len(new)] = describe_patterns(frame.grey(THERMAL).astype(np.float32), new)
            colours[: len(new)] = describe_colours(frame, new, view)
        return SensorDetections(
            camera=THERMAL,
            boxes=every.box,
            scores=every.score,
            measurement=BoxMeasurement(every.box, view, self._config.motion),
            expected=expected,
            pattern=pattern,
            colours=colours,
            assigned={row: column for column, row in enumerate(boxes.rows, start=len(new))},
            is_search=boxes.is_search,
            posture=boxes.posture,
            settings=self._settings(view),
        )

    def _viewpoint(self, frame: Frame, predicted: Predictions) -> Viewpoint:
        calibration, (rows, columns) = frame.calibrations.get(THERMAL), frame.grey(THERMAL).shape
        if self._view is None or self._view[0] is not calibration or self._view[1] != (rows, columns):
            view = Viewpoint.of(calibration, (rows, columns), predicted.origin_m, self._config.motion.toe_m)
            self._view = calibration, (rows, columns), view
        return self._view[2]

    def _settings(self, view: Viewpoint) -> Settings:
        config = self._config
        if view.floor_m is None:
            return Settings(
                config.existence_uncalibrated,
                config.association_uncalibrated,
                config.reidentification_uncalibrated,
            )
        return Settings(config.existence, config.association, config.reidentification)
