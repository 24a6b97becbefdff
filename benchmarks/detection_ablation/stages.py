"""The detector up to one of its stages, or an absolute threshold in its place."""

from __future__ import annotations

from enum import Enum, auto
from typing import Final

import numpy as np

from benchmarks.peers.detectors import Blobs
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.proposals.detector import SMALLEST_PX, Grey, PeopleDetector, look
from peopleboy.tracker.proposals.looks.second_look import look_again, shipped_network
from peopleboy.tracker.proposals.model import shipped_model
from peopleboy.tracker.proposals.suppression import Proposals
from peopleboy.tracker.tracking.config import DetectionTrackerConfig
from peopleboy.tracker.tracking.people_finder import Finder, ThermalFinder

LEAST: Final = DetectionTrackerConfig().existence.weakest
_SURE: Final = 3.0  # log odds of a warm blob


class Stage(Enum):
    """By what people are found: a threshold, or the detector as far as it looks."""

    THRESHOLD = auto()
    TREES = auto()
    SECOND_LOOK = auto()
    CLOSER_LOOK = auto()


class DetectorOfStage(PeopleDetector):
    """A detector that looks no further than to a stage."""

    def __init__(self, stage: Stage) -> None:
        """Take the shipped trees and networks."""
        super().__init__(least_score=LEAST)
        self._stage = stage

    def found(
        self, grey: Grey, change: Grey, mount: Mount | None, expected: Proposals, *, everywhere: bool
    ) -> Proposals:
        """Look for people in an image of which it is known by how much (H, W) greys changed.

        Trees by themselves look everywhere, whoever is expected.
        """
        if self._stage is Stage.CLOSER_LOOK:
            return super().found(grey, change, mount, expected, everywhere=everywhere)
        if self._stage is Stage.TREES:
            return look(shipped_model(), grey, change, mount, SMALLEST_PX, LEAST)
        first = self.proposed(grey, change, mount, expected) if everywhere else expected
        return look_again(shipped_network(), grey, change, first, mount, LEAST)


class WarmFinder:
    """Takes whatever is upright and warmer than a grey for somebody: evidence that is not relative."""

    def __call__(self, frame: Frame, expected: Proposals, *, everywhere: bool) -> Proposals:  # noqa: ARG002
        """Find people in a frame, whoever is expected."""
        boxes = Blobs().detect(frame).box
        return Proposals.of_trees(boxes, np.full(len(boxes), _SURE))


def thermal_finder(stage: Stage) -> Finder:
    """Make one that looks no further than to a stage."""
    return WarmFinder() if stage is Stage.THRESHOLD else ThermalFinder(DetectorOfStage(stage))
