"""One person at a time: a detector filter that finds, and a person filter that keeps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bad_input import BadInput
from tracker.config import TrackerConfig
from tracker.ellipse import box_of
from tracker.filter import Belief, View, begin, step, view_frame
from tracker.frame import Frame
from tracker.life import is_born, is_kept
from tracker.measure import ContourModel
from tracker.particles import Particles, ellipse_of
from tracker.smooth import smoothed
from tracker.track import Status, Track

FIRST_STEP_S = 1 / 15
DETECTOR_KEY = 0


@dataclass(frozen=True, slots=True, eq=False)
class Person:
    """A tracked person between two frames.

    Attributes:
        id: 1 or more.
        born_s: time of the first frame [s].
        belief: its filter.
        missing: frames in a row in which the person was not seen.
        shown: (9,) its estimate, smoothed over time.
    """

    id: int
    born_s: float
    belief: Belief
    missing: int
    shown: NDArray[np.float64]


class SinglePersonTracker:
    """Finds one person, keeps it, and looks for the next one when it is lost.

    Source: thesis, chapter 4, with the division into a detector and a tracking filter of chapter 5.
    """

    def __init__(self, config: TrackerConfig, rng: np.random.Generator) -> None:
        self._config = config
        self._rng = rng
        self._model: ContourModel | None = None
        self._last_s: float | None = None
        self._detector: Belief | None = None
        self._hits = 0
        self._person: Person | None = None
        self._born = 0

    @property
    def particles(self) -> Mapping[int, Particles]:
        """The samples by track id; key 0 is the detector's cloud."""
        if self._person is not None:
            return {self._person.id: self._person.belief.particles}
        return {} if self._detector is None else {DETECTOR_KEY: self._detector.particles}

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is seen.

        Raises:
            BadInput: time that does not go forward.
        """
        view = view_frame(frame, self._time_step(frame.time_s), self._model_for(frame), self._config)
        self._last_s = frame.time_s
        if self._person is None:
            return self._search(view, frame.time_s)
        return self._follow(self._person, view, frame.time_s)

    def _time_step(self, time_s: float) -> float:
        if self._last_s is None:
            return FIRST_STEP_S
        if time_s <= self._last_s:
            raise BadInput(f"time_s must go forward, got {time_s} after {self._last_s}")
        return time_s - self._last_s

    def _model_for(self, frame: Frame) -> ContourModel:
        shape = (frame.height_px, frame.width_px)
        if self._model is None or self._model.shape != shape:
            self._model = ContourModel.build(shape, self._config.contour)
        return self._model

    def _search(self, view: View, time_s: float) -> tuple[Track, ...]:
        """Carry the detector on; a person is born when it has settled on one for long enough."""
        config = self._config
        if self._detector is None:
            belief = begin(view, config.detector, config, self._rng)
        else:
            belief = step(self._detector.particles, view, config.detector, config, self._rng)
        self._hits = self._hits + 1 if is_born(belief, view, config.life) else 0
        self._detector = belief
        if self._hits == 0:
            return ()
        person = Person(self._born + 1, time_s, belief, 0, belief.estimate)
        if self._hits < config.life.birth_frames:
            return (self._track(person, time_s, Status.TENTATIVE),)
        self._born, self._hits, self._person, self._detector = person.id, 0, person, None
        return (self._track(person, time_s, Status.TRACKED),)

    def _follow(self, person: Person, view: View, time_s: float) -> tuple[Track, ...]:
        """Carry the person's filter on; it is given up when it has not fitted the image for too long."""
        config = self._config
        belief = step(person.belief.core, view, config.person, config, self._rng)
        missing = 0 if is_kept(belief, view, config.life) else person.missing + 1
        # Without confidence no sample is within the limits, and the estimate may be no ellipse at all.
        if missing >= config.life.death_frames or belief.confidence == 0:
            self._person = None
            return self._search(view, time_s)
        shown = smoothed(person.shown, belief.estimate, view, config.smoothing)
        self._person = Person(person.id, person.born_s, belief, missing, shown)
        is_seen = missing < config.life.doubt_frames
        return (self._track(self._person, time_s, Status.TRACKED if is_seen else Status.TENTATIVE),)

    def _track(self, person: Person, time_s: float, status: Status) -> Track:
        ellipse = ellipse_of(person.shown)
        return Track(
            id=person.id,
            ellipse=ellipse,
            box=box_of(ellipse, self._config.box, self._config.contour.head_divisor),
            confidence=person.belief.confidence,
            status=status,
            age_s=time_s - person.born_s,
            uncertainty_px2=person.belief.uncertainty_px2,
        )
