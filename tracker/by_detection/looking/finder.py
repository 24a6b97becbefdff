"""Who finds people in single frames."""

from __future__ import annotations

from typing import Protocol

from peopleboy.tracker.by_detection.config import ByDetectionConfig
from peopleboy.tracker.by_detection.looking.colour_finder import ColourFinder
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.proposals.detector import PeopleDetector
from peopleboy.tracker.proposals.suppression import NOBODY, Proposals
from peopleboy.tracker.thermal.mount import mount_of


class Finder(Protocol):
    """Whatever proposes people, frame by frame."""

    def __call__(self, frame: Frame, expected: Proposals, *, everywhere: bool) -> Proposals:
        """Give boxes [px] in the thermal image, as wide as the torso, and log odds.

        Args:
            frame: the next one.
            expected: who is known.
            everywhere: whether others are looked for, too.
        """
        ...


class PeopleFinder:
    """The learned detector on the thermal image, and now and then on the colour image."""

    def __init__(self, config: ByDetectionConfig) -> None:
        """Make one for a tracker with such settings."""
        weakest = config.existence.weakest
        self._thermal = ThermalFinder(PeopleDetector(least_score=weakest))
        self._colour = ColourFinder(config.colour, weakest)

    def __call__(self, frame: Frame, expected: Proposals = NOBODY, *, everywhere: bool = True) -> Proposals:
        """Look for people in the next frame; for those who are known in the thermal image alone."""
        seen = self._thermal(frame, expected, everywhere=everywhere)
        if not everywhere:
            self._colour.takes_in(frame)
            return seen
        return self._colour(frame, seen)


class ThermalFinder:
    """A detector on the thermal image, where people may stand if the camera is known."""

    def __init__(self, detector: PeopleDetector) -> None:
        """Make one of a detector."""
        self._detector = detector

    def __call__(self, frame: Frame, expected: Proposals = NOBODY, *, everywhere: bool = True) -> Proposals:
        """Look for people in the next frame, or for those who are known."""
        grey, calibration = frame.grey(THERMAL), frame.calibrations.get(THERMAL)
        mount = None if calibration is None else mount_of(calibration, grey.shape[0])
        return self._detector.update(
            grey, frame.time_s, frame.odometry, mount, expected, everywhere=everywhere
        )
