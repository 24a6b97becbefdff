"""The learned detector at keyframes, and rescoring or templates in between."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from peopleboy.tracker.frame import THERMAL, Floats, Frame
from peopleboy.tracker.sensors.box_detector import DetectedBoxes
from peopleboy.tracker.sensors.thermal.detection_schedule import DetectionSchedule, Schedule, ThermalMemory
from peopleboy.tracker.sensors.thermal.people_finder import Finder, PeopleFinder
from peopleboy.tracker.sensors.thermal.template import Template
from peopleboy.tracker.tracking.config import PeopleTrackerConfig
from peopleboy.tracker.tracking.sensor import Predictions, SensorDetections
from peopleboy.tracker.tracking.viewpoint import Viewpoint


class ScheduledDetector:
    """Searches whole images at intervals; in between, it rescores predicted boxes or follows templates.

    Args:
        config: of the tracker.
        find: detects people in an image; None for the learned detector.
    """

    def __init__(self, config: PeopleTrackerConfig | None = None, find: Finder | None = None) -> None:
        self._config = PeopleTrackerConfig() if config is None else config
        self._find = PeopleFinder(self._config) if find is None else find
        self._schedule = DetectionSchedule()
        self._memory: dict[int, ThermalMemory] = {}
        self._last: tuple[Frame, Schedule, Floats] | None = None

    def detect(
        self, frame: Frame, view: Viewpoint, predicted: Predictions, expected: Floats
    ) -> DetectedBoxes | None:
        """Detect people in the next frame, as far as they are due; see `BoxDetector`."""
        self._memory = {key: self._known(key) for key in predicted.keys}
        known = list(self._memory.values())
        schedule = self._config.schedule if view.floor_m is not None else self._config.schedule_uncalibrated
        aim = self._schedule.schedule_next(
            frame.grey(THERMAL), predicted, known, expected, frame.time_s, view.breadth, schedule
        )
        found = self._find(frame, aim.proposed(known), everywhere=aim.everywhere)
        followed = aim.located(known)
        self._last = frame, aim, np.concatenate([found.trees, followed.trees])
        return DetectedBoxes(found, followed, tuple(aim.followed), aim.everywhere)

    def remember(self, detections: SensorDetections, found: Mapping[int, int], keys: Sequence[int]) -> None:
        """Cut templates of the tracks that the detector found."""
        assert self._last is not None
        frame, aim, every_trees = self._last
        for row, column in found.items():
            trees, known = float(every_trees[column]), self._memory.get(keys[row])
            if known is None:
                self._memory[keys[row]] = ThermalMemory(frame.time_s, trees)
                continue
            known.seen_s, known.trees = frame.time_s, trees
            if row in detections.assigned:
                continue
            known.rescored_s, known.score = frame.time_s, float(detections.scores[column])
            known.template = Template.of(frame.grey(THERMAL), detections.boxes[column])
            if aim.everywhere and row not in aim.expected:
                known.searched_s = frame.time_s

    def _known(self, key: int) -> ThermalMemory:
        return self._memory.get(key) or ThermalMemory(-math.inf, 0.0)
