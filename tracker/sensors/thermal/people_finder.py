"""The learned detector on the thermal image and, at intervals, on the colour image."""

import math
from typing import Protocol

import cv2
import numpy as np

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.boxes import area, iou, shared_of_smaller
from peopleboy.tracker.camera_mount import mount_of
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame, FreshImages, Odometry, joined
from peopleboy.tracker.sensors.detections import NO_DETECTIONS, Detections
from peopleboy.tracker.sensors.thermal.detector.detector import PeopleDetector
from peopleboy.tracker.tracking.appearance import transfer_boxes
from peopleboy.tracker.tracking.config import ColourDetectionConfig, PeopleTrackerConfig
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
        seen = Detections(boxes, self._config.believed * found.score, found.trees, found.edges)
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
        np.concatenate([thermal.edges, colour.edges[is_alone]]),
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
