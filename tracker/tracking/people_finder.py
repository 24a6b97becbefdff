"""Who finds people in single frames."""

from __future__ import annotations

import math
from typing import Protocol

import cv2
import numpy as np

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.boxes import area, iou, shared_of_smaller
from peopleboy.tracker.camera_mount import mount_of
from peopleboy.tracker.detector.detections import NO_DETECTIONS, Detections
from peopleboy.tracker.detector.detector import PeopleDetector
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame, FreshImages, Odometry, joined
from peopleboy.tracker.tracking.appearance import transfer_boxes
from peopleboy.tracker.tracking.config import ColourDetectionConfig, DetectionTrackerConfig
from peopleboy.tracker.tracking.viewpoint import Viewpoint

# Who is seen in the colour image, as in a room as warm as people, where the thermal one shows nobody.


class ColourFinder:
    """The learned detector on the brightness of the colour image, now and then.

    What it knows is relative: neither what a grey means nor whether people are brighter than what is behind
    them. So it knows people by daylight, though fewer of them. It looks more often while it shows people
    that the thermal image does not.
    """

    def __init__(self, config: ColourDetectionConfig, weakest: float) -> None:
        """Make one that keeps detections from some log odds on."""
        self._config = config
        self._detector = PeopleDetector(least_score=weakest)
        self._images = FreshImages(COLOUR)
        self._last_s = -math.inf
        self._pause_s = config.every_s
        self._way: Odometry | None = Odometry()

    def __call__(self, frame: Frame, thermal: Detections) -> Detections:
        """Return who is seen in a frame, by heat or in colours, with boxes (M, 4) [px] in the thermal image.

        By heat alone, if it is too soon, there is no new image, or not both cameras are calibrated.
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
        """Look for people in the colour image, and carry them over to the thermal one."""
        grey = np.asarray(cv2.cvtColor(frame.rgb(COLOUR), cv2.COLOR_RGB2GRAY), np.uint8)
        found = self._detector.update(grey, frame.time_s, self._way, mount_of(here, grey.shape[0]))
        self._last_s, self._way = frame.time_s, Odometry()
        boxes = transfer_boxes(found.box, Viewpoint.of(here, (grey.shape[0], grey.shape[1])), here, there)
        seen = Detections(boxes, self._config.believed * found.score, found.trees)
        return seen.take(area(boxes) > 0.0)

    def accumulate_motion(self, frame: Frame) -> bool:
        """Take in how the robot moved until the next new image, and tell whether a frame has that."""
        fresh = self._images.of(frame)
        if fresh is None:
            return False
        self._way = joined(self._way, fresh.odometry)
        return True


def merge_cameras(thermal: Detections, colour: Detections, config: ColourDetectionConfig) -> Detections:
    """Take together what both cameras show, all in the thermal image, the surest first.

    Of a person in both, the box is the thermal one's, which is the more exact, and the score that of the
    surer one. Colours alone show others only where the thermal image has nothing to say.
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
    # By heat trees found nobody there: at most they leave it open.
    both = Detections(
        np.concatenate([thermal.box, colour.box[is_alone]]),
        np.concatenate([score, colour.score[is_alone]]),
        np.concatenate([thermal.trees, np.minimum(colour.score[is_alone], 0.0)]),
    )
    return both.take(np.argsort(-both.score, kind="stable"))


class Finder(Protocol):
    """Whatever proposes people, frame by frame."""

    def __call__(self, frame: Frame, expected: Detections, *, everywhere: bool) -> Detections:
        """Return boxes [px] in the thermal image, as wide as the torso, and log odds.

        Args:
            frame: the next one.
            expected: who is known.
            everywhere: whether others are looked for, too.
        """
        ...


class PeopleFinder:
    """The learned detector on the thermal image, and now and then on the colour image."""

    def __init__(self, config: DetectionTrackerConfig) -> None:
        """Make one for a tracker with such settings."""
        weakest = config.existence.weakest
        self._thermal = ThermalFinder(PeopleDetector(least_score=weakest))
        self._colour = ColourFinder(config.colour, weakest)

    def __call__(
        self, frame: Frame, expected: Detections = NO_DETECTIONS, *, everywhere: bool = True
    ) -> Detections:
        """Look for people in the next frame; for those who are known in the thermal image alone."""
        seen = self._thermal(frame, expected, everywhere=everywhere)
        if not everywhere:
            self._colour.accumulate_motion(frame)
            return seen
        return self._colour(frame, seen)


class ThermalFinder:
    """A detector on the thermal image, where people may stand if the camera is known."""

    def __init__(self, detector: PeopleDetector) -> None:
        """Make one of a detector."""
        self._detector = detector

    def __call__(
        self, frame: Frame, expected: Detections = NO_DETECTIONS, *, everywhere: bool = True
    ) -> Detections:
        """Look for people in the next frame, or for those who are known."""
        grey, calibration = frame.grey(THERMAL), frame.calibrations.get(THERMAL)
        mount = None if calibration is None else mount_of(calibration, grey.shape[0])
        return self._detector.update(
            grey, frame.time_s, frame.odometry, mount, expected, everywhere=everywhere
        )
