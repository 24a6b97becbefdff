"""The default tracker, the contour tracker and a step of its filter beside OpenCV's HOG detector, by turns.

A machine that does other work is now quick and now slow: what takes turns within a second meets the same.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from statistics import mean, median
from typing import Final

import cv2

from benchmarks.peers.detectors import Hog
from benchmarks.speed.contour_tracker import MOST, people_in
from benchmarks.speed.filter_step import FilterStep
from peopleboy.sim.random_streams import stream
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.trackers import CONTOUR_TRACKER, DEFAULT_TRACKER, make_tracker

COUNT: Final = 1000
_FRAMES: Final = 10  # of a turn: one after the other, as in a run
_STEPS: Final = 100  # likewise of the filter; then comes HOG, once


@dataclass(frozen=True, slots=True, kw_only=True)
class Turn:
    """CPU times [ms] within a second or less; those of contours and filter are medians.

    Attributes:
        contour_ms: of the contour tracker, of those frames in which each person has a filter.
        step_ms: of a filter with 1000 samples.
        default_ms: of the default tracker, mean of the same frames, as some take longer than others.
        hog_ms: of HOG, once.
    """

    contour_ms: float
    step_ms: float
    default_ms: float
    hog_ms: float


@dataclass(frozen=True, slots=True)
class BesideHog:
    """All turns of a film."""

    turns: tuple[Turn, ...]

    @property
    def hog_ms(self) -> float:
        """What HOG takes [ms], median."""
        return median(turn.hog_ms for turn in self.turns)

    @property
    def contour_ratio(self) -> float:
        """How many times longer HOG takes than the contour tracker, median over the turns."""
        return median(turn.hog_ms / turn.contour_ms for turn in self.turns)

    @property
    def step_ratio(self) -> float:
        """How many times longer HOG takes than a step of a filter, likewise."""
        return median(turn.hog_ms / turn.step_ms for turn in self.turns)

    @property
    def default_ms(self) -> float:
        """What the default tracker takes [ms], median over the turns."""
        return median(turn.default_ms for turn in self.turns)

    @property
    def default_ratio(self) -> float:
        """How many times longer HOG takes than the default tracker, likewise."""
        return median(turn.hog_ms / turn.default_ms for turn in self.turns)


def beside_hog(film: Sequence[Frame]) -> BesideHog:
    """Track four people, and let a filter and HOG, which has one thread, take turns with that."""
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        return BesideHog(tuple(_turns(film)))
    finally:
        cv2.setNumThreads(threads)


def _turns(film: Sequence[Frame]) -> list[Turn]:
    trackers = [make_tracker(name, stream(0, "tracker")) for name in (CONTOUR_TRACKER, DEFAULT_TRACKER)]
    hog, step = Hog(uses_colour=True), FilterStep(COUNT)
    hog.detect(film[0])
    turns = []
    for first in range(0, len(film), _FRAMES):
        contours_ms, defaults_ms = [], []
        for frame in film[first : first + _FRAMES]:
            contour_ms, default_ms = (_spent_ms(partial(one.update, frame)) for one in trackers)
            if len(people_in(trackers[0])) == MOST:
                contours_ms.append(contour_ms)
                defaults_ms.append(default_ms)
        steps_ms = [_spent_ms(step) for _ in range(_STEPS)]
        hog_ms = _spent_ms(partial(hog.detect, film[first]))
        if contours_ms:
            turns.append(
                Turn(
                    contour_ms=median(contours_ms),
                    step_ms=median(steps_ms),
                    default_ms=mean(defaults_ms),
                    hog_ms=hog_ms,
                )
            )
    return turns


def _spent_ms(work: Callable[[], object]) -> float:
    start = time.process_time()
    work()
    return 1000.0 * (time.process_time() - start)
