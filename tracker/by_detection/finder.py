"""Who finds people in single frames."""

from __future__ import annotations

from typing import Protocol

from peopleboy.tracker.frame import THERMAL, Floats, Frame
from peopleboy.tracker.proposals.detector import PeopleDetector
from peopleboy.tracker.thermal.mount import mount_of


class Finder(Protocol):
    """Whatever proposes people, frame by frame."""

    def __call__(self, frame: Frame) -> tuple[Floats, Floats]:
        """Give boxes (M, 4) [px] in the thermal image, as wide as the torso, and log odds (M,)."""
        ...


class ThermalFinder:
    """The learned detector on the thermal image, where people may stand if the camera is known."""

    def __init__(self, weakest: float) -> None:
        """Make one that keeps proposals from some log odds on."""
        self._detector = PeopleDetector(least_score=weakest)

    def __call__(self, frame: Frame) -> tuple[Floats, Floats]:
        """Look for people in the next frame."""
        grey, calibration = frame.grey(THERMAL), frame.calibrations.get(THERMAL)
        mount = None if calibration is None else mount_of(calibration, grey.shape[0])
        found = self._detector.update(grey, frame.time_s, frame.odometry, mount)
        return found.box, found.score
