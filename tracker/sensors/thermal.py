"""The thermal sensor: the learned detector on the thermal image, and at intervals on the colour image."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np

from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.tracker.boxes import area, intersection, iou, shared_of_smaller
from peopleboy.tracker.camera_mount import mount_of
from peopleboy.tracker.detector.detections import NO_DETECTIONS, Detections
from peopleboy.tracker.detector.detector import PeopleDetector
from peopleboy.tracker.frame import COLOUR, THERMAL, Floats, Frame, FreshImages, Odometry, joined
from peopleboy.tracker.sensors.detection_schedule import DetectionSchedule, Schedule, ThermalMemory
from peopleboy.tracker.sensors.template import Template
from peopleboy.tracker.tracking.appearance import describe_colours, describe_patterns, transfer_boxes
from peopleboy.tracker.tracking.config import ColourDetectionConfig, PeopleTrackerConfig
from peopleboy.tracker.tracking.measurement import BoxMeasurement
from peopleboy.tracker.tracking.motion_filter import predicted_boxes
from peopleboy.tracker.tracking.sensor import (
    Predictions,
    ProjectedBoxes,
    SensorDetections,
    Settings,
    Visibility,
    no_appearance,
)
from peopleboy.tracker.tracking.viewpoint import Viewpoint

# Detection in the colour image, for rooms as warm as people, where the thermal image has no contrast.


class ColourFinder:
    """The learned detector on the brightness of the colour image, at intervals.

    The detector uses relative contrast only: neither the meaning of a grey nor the sign of the contrast
    matters. So it also detects people in daylight, though fewer of them. It runs more often while the colour
    image shows people that the thermal image does not show.
    """

    def __init__(self, config: ColourDetectionConfig, weakest: float) -> None:
        """Make one that keeps detections above a log-odds threshold."""
        self._config = config
        self._detector = PeopleDetector(least_score=weakest)
        self._images = FreshImages(COLOUR)
        self._last_s = -math.inf
        self._pause_s = config.every_s
        self._way: Odometry | None = Odometry()

    def __call__(self, frame: Frame, thermal: Detections) -> Detections:
        """Return the people in a frame, from both cameras, with boxes (M, 4) [px] in the thermal image.

        Only thermal detections if it is too soon, there is no new image, or not both cameras are calibrated.
        """
        here, there = frame.calibrations.get(COLOUR), frame.calibrations.get(THERMAL)
        if not self.accumulate_motion(frame) or frame.time_s - self._last_s < self._pause_s:
            return thermal
        if not (isinstance(here, PinholeCalibration) and isinstance(there, PinholeCalibration)):
            return thermal
        both = merge_cameras(thermal, self._found(frame, here, there), self._config)
        self._pause_s = self._pause_after(thermal, both)
        return both

    def _pause_after(self, thermal: Detections, both: Detections) -> float:
        if len(both.score) > len(thermal.score):
            return self._config.alone_every_s
        return self._config.beside_s if (thermal.score > 0.0).any() else self._config.every_s

    def _found(self, frame: Frame, here: PinholeCalibration, there: PinholeCalibration) -> Detections:
        """Detect people in the colour image, and transfer their boxes to the thermal image."""
        grey = np.asarray(cv2.cvtColor(frame.rgb(COLOUR), cv2.COLOR_RGB2GRAY), np.uint8)
        found = self._detector.update(grey, frame.time_s, self._way, mount_of(here, grey.shape[0]))
        self._last_s, self._way = frame.time_s, Odometry()
        boxes = transfer_boxes(found.box, Viewpoint.of(here, (grey.shape[0], grey.shape[1])), here, there)
        seen = Detections(boxes, self._config.believed * found.score, found.trees)
        return seen.take(area(boxes) > 0.0)

    def accumulate_motion(self, frame: Frame) -> bool:
        """Accumulate the robot's motion until the next new image, and return whether the frame has one."""
        fresh = self._images.of(frame)
        if fresh is None:
            return False
        self._way = joined(self._way, fresh.odometry)
        return True


def merge_cameras(thermal: Detections, colour: Detections, config: ColourDetectionConfig) -> Detections:
    """Merge the detections of both cameras in the thermal image, the highest score first.

    If both cameras detect a person, the thermal box, which is more accurate, and the higher score are kept.
    Colour detections alone add people only where the thermal image has no evidence.
    """
    if len(colour.score) == 0:
        return thermal
    overlap = iou(thermal.box[:, None], colour.box[None])
    is_same = overlap >= config.same
    is_shared = shared_of_smaller(thermal.box[:, None], colour.box[None]) > config.shared
    is_alone = ~(is_same | is_shared).any(axis=0) & (colour.score >= config.alone)
    score = thermal.score.copy()
    for column in np.flatnonzero(is_same.any(axis=0)):
        row = overlap[:, column].argmax()
        score[row] = max(score[row], colour.score[column])
    # The thermal trees found nobody there; their score is at most neutral.
    both = Detections(
        np.concatenate([thermal.box, colour.box[is_alone]]),
        np.concatenate([score, colour.score[is_alone]]),
        np.concatenate([thermal.trees, np.minimum(colour.score[is_alone], 0.0)]),
    )
    return both.take(np.argsort(-both.score, kind="stable"))


class Finder(Protocol):
    """Detects people frame by frame."""

    def __call__(self, frame: Frame, expected: Detections, *, everywhere: bool) -> Detections:
        """Return boxes [px] in the thermal image, as wide as the torso, and log-odds.

        Args:
            frame: the next frame.
            expected: predicted boxes of tracks.
            everywhere: whether the whole image is searched.
        """
        ...


class PeopleFinder:
    """The learned detector on the thermal image, and at intervals on the colour image."""

    def __init__(self, config: PeopleTrackerConfig) -> None:
        """Make one for a tracker with these settings."""
        weakest = config.existence.weakest
        self._thermal = ThermalFinder(PeopleDetector(least_score=weakest))
        self._colour = ColourFinder(config.colour, weakest)

    def __call__(
        self, frame: Frame, expected: Detections = NO_DETECTIONS, *, everywhere: bool = True
    ) -> Detections:
        """Detect people in the next frame; predicted boxes are rescored in the thermal image alone."""
        seen = self._thermal(frame, expected, everywhere=everywhere)
        if not everywhere:
            self._colour.accumulate_motion(frame)
            return seen
        return self._colour(frame, seen)


class ThermalFinder:
    """A detector on the thermal image, restricted to the floor if the camera is calibrated."""

    def __init__(self, detector: PeopleDetector) -> None:
        """Make one from a detector."""
        self._detector = detector

    def __call__(
        self, frame: Frame, expected: Detections = NO_DETECTIONS, *, everywhere: bool = True
    ) -> Detections:
        """Detect people in the next frame, or rescore predicted boxes."""
        grey, calibration = frame.grey(THERMAL), frame.calibrations.get(THERMAL)
        mount = None if calibration is None else mount_of(calibration, grey.shape[0])
        return self._detector.update(
            grey, frame.time_s, frame.odometry, mount, expected, everywhere=everywhere
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DetectionExplanation:
    """The detections of the last frame.

    Attributes:
        boxes: (M, 4) [px] in the thermal image.
        scores: (M,) log-odds that they are people.
    """

    boxes: Floats
    scores: Floats


class ThermalSensor:
    """Detects people in the thermal image by a learned detector, and by templates in between.

    A finder that searches the colour image, too, adds people where the room is as warm as they are.

    Args:
        config: of the tracker.
        find: detects people in an image; None for the learned detector.
    """

    def __init__(self, config: PeopleTrackerConfig | None = None, find: Finder | None = None) -> None:
        self._config = PeopleTrackerConfig() if config is None else config
        self._find = PeopleFinder(self._config) if find is None else find
        self._schedule = DetectionSchedule()
        self._memory: dict[int, ThermalMemory] = {}
        self._view: tuple[Calibration | None, tuple[int, int], Viewpoint] | None = None
        self._explanation = DetectionExplanation(boxes=np.empty((0, 4)), scores=np.empty(0))
        self._last: tuple[Frame, Schedule, Detections] | None = None

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
        grey, view = frame.grey(THERMAL), self._viewpoint(frame, predicted)
        settings = self._settings(view)
        self._memory = {key: self._known(key) for key in predicted.keys}
        known = list(self._memory.values())
        expected = predicted_boxes(predicted.states, view, predicted.ratio)
        schedule = self._config.schedule if view.floor_m is not None else self._config.schedule_uncalibrated
        aim = self._schedule.schedule_next(
            grey, predicted, known, expected, frame.time_s, view.breadth, schedule
        )
        seen = self._find(frame, aim.proposed(known), everywhere=aim.everywhere)
        seen = seen._replace(score=settings.existence.trust * seen.score + settings.existence.lasting)
        found = aim.with_followed(seen, known)
        self._last = frame, aim, found
        self._explanation = DetectionExplanation(boxes=found.box, scores=found.score)
        return self._described(frame, found, expected, view, settings, aim)

    def detect_in(self, frame: Frame, box: Floats, predicted: Predictions) -> SensorDetections | None:
        """Describe a box (4,) in which a person is known to be."""
        if THERMAL not in frame.images:
            return None
        view = self._viewpoint(frame, predicted)
        found = Detections.from_trees(box[None], np.zeros(1))
        expected = predicted_boxes(predicted.states, view, predicted.ratio)
        return self._described(frame, found, expected, view, self._settings(view), None)

    def visibility(self, frame: Frame, predicted: Predictions) -> Visibility | None:
        """Return None: the thermal image does not show what is nearer."""

    def project(self, frame: Frame, predicted: Predictions) -> ProjectedBoxes | None:
        """Return the tracks in the thermal image; None before the first one."""
        if THERMAL in frame.images:
            self._viewpoint(frame, predicted)
        if self._view is None:
            return None
        _, (rows, columns), view = self._view
        boxes = predicted_boxes(predicted.states, view, predicted.ratio)
        is_ahead = predicted.states.mean[:, 2] > view.at_m[2]
        is_inside = intersection(boxes, np.array([-0.5, -0.5, columns, rows])) > 0.0
        return ProjectedBoxes(boxes, is_inside & is_ahead)

    def remember(self, detections: SensorDetections, found: Mapping[int, int], keys: Sequence[int]) -> None:
        """Cut templates of the tracks that the detector found."""
        assert self._last is not None
        frame, aim, boxes = self._last
        for row, column in found.items():
            trees, known = float(boxes.trees[column]), self._memory.get(keys[row])
            if known is None:
                self._memory[keys[row]] = ThermalMemory(frame.time_s, trees)
                continue
            known.seen_s, known.trees = frame.time_s, trees
            if row in detections.assigned:
                continue
            known.rescored_s, known.score = frame.time_s, float(detections.scores[column])
            known.template = Template.of(frame.grey(THERMAL), boxes.box[column])
            if aim.everywhere and row not in aim.expected:
                known.searched_s = frame.time_s

    def _known(self, key: int) -> ThermalMemory:
        return self._memory.get(key) or ThermalMemory(-math.inf, 0.0)

    def _described(
        self,
        frame: Frame,
        found: Detections,
        expected: Floats,
        view: Viewpoint,
        settings: Settings,
        aim: Schedule | None,
    ) -> SensorDetections:
        """Add the appearance of all detections but those located by their templates."""
        followed = [] if aim is None else list(aim.followed)
        count = len(found.box)
        pattern, colours = no_appearance(count)
        new = slice(count - len(followed))
        if len(followed) < count:
            pattern[new] = describe_patterns(frame.grey(THERMAL).astype(np.float32), found.box[new])
            colours[new] = describe_colours(frame, found.box[new], view)
        return SensorDetections(
            camera=THERMAL,
            boxes=found.box,
            scores=found.score,
            measurement=BoxMeasurement(found.box, view, self._config.motion),
            expected=expected,
            pattern=pattern,
            colours=colours,
            assigned={row: count - len(followed) + place for place, row in enumerate(followed)},
            is_search=aim is None or aim.everywhere,
            settings=settings,
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
