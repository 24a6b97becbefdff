"""Several people: a sequential detector finds them one by one, and each keeps a filter of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bad_input import BadInput
from tracker.config import FilterConfig, TrackerConfig
from tracker.ellipse import box_of
from tracker.filter import Belief, View, advance, draw_fresh, view_frame, weigh
from tracker.frame import Frame
from tracker.interaction import detector_factor, overlap_shares, person_factor, regions_of
from tracker.life import is_born, is_kept
from tracker.measure import ContourModel
from tracker.particles import VX, Floats, Particles, X, ellipse_of
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
        shown: (9,) its estimate, smoothed over time.
        missing: frames in a row in which the person was not seen.
    """

    id: int
    born_s: float
    belief: Belief
    shown: NDArray[np.float64]
    missing: int = 0


class PeopleTracker:
    """Finds people one after the other, and keeps each until it is no longer seen.

    Source: thesis, chapter 5.
    """

    def __init__(self, config: TrackerConfig, rng: np.random.Generator) -> None:
        self._config = config
        self._rng = rng
        self._model: ContourModel | None = None
        self._last_s: float | None = None
        self._detector: Belief | None = None
        self._hits = 0
        self._persons: tuple[Person, ...] = ()
        self._born = 0

    @property
    def particles(self) -> Mapping[int, Particles]:
        """The samples by track id; key 0 is the detector's cloud."""
        clouds = {person.id: person.belief.particles for person in self._persons}
        return clouds if self._detector is None else {DETECTOR_KEY: self._detector.particles, **clouds}

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Take in the next frame and tell who is seen.

        Raises:
            BadInput: time that does not go forward.
        """
        view = view_frame(frame, self._time_step(frame.time_s), self._model_for(frame), self._config)
        self._last_s = frame.time_s
        self._follow(view)
        tracks = [self._track(person, frame.time_s, self._status(person)) for person in self._persons]
        return (*tracks, *self._search(view, frame.time_s))

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

    def _follow(self, view: View) -> None:
        """Carry everybody's filter on, and give up those who have not been seen for too long."""
        expected = regions_of([predicted(person, view) for person in self._persons], self._config)
        kept = []
        for number, person in enumerate(self._persons):
            others = np.delete(expected, number, axis=0)
            follower = self._carried_on(person, others, view)
            # Without confidence no sample is within the limits, and the estimate may be no ellipse at all.
            if follower.missing < self._config.life.death_frames and follower.belief.confidence > 0:
                kept.append(follower)
        self._persons = tuple(kept)

    def _carried_on(self, person: Person, others: Floats, view: View) -> Person:
        config = self._config
        state = advance(person.belief.core, view, self._filter_of_a_person(), config, self._rng)
        shares = overlap_shares(state, others, config)
        factor = person_factor(shares, np.full(len(others), config.interaction.penalty))
        belief = weigh(state, view, config.person, config, factor)
        return replace(
            person,
            belief=belief,
            missing=0 if is_kept(belief, view, config.life) else person.missing + 1,
            shown=smoothed(person.shown, belief.estimate, view, config.smoothing),
        )

    def _filter_of_a_person(self) -> FilterConfig:
        """Give everybody N samples, or an equal part of what all share."""
        config = self._config
        if config.interaction.total_count == 0:
            return config.person
        return replace(config.person, count=max(1, config.interaction.total_count // len(self._persons)))

    def _search(self, view: View, time_s: float) -> tuple[Track, ...]:
        """Carry the detector on; a person is born when it has settled on one for long enough."""
        config = self._config
        if len(self._persons) >= config.interaction.max_persons:
            self._detector = None
            return ()
        self._detector = self._detected(view)
        self._hits = self._hits + 1 if is_born(self._detector, view, config.life) else 0
        if self._hits == 0:
            return ()
        person = Person(self._born + 1, time_s, self._detector, self._detector.estimate)
        if self._hits < config.life.birth_frames:
            return (self._track(person, time_s, Status.TENTATIVE),)
        self._born, self._hits, self._detector = person.id, 0, None
        self._persons = (*self._persons, person)
        return (self._track(person, time_s, Status.TRACKED),)

    def _detected(self, view: View) -> Belief:
        """Weigh the detector's samples, kept off the people that are tracked."""
        config, rng = self._config, self._rng
        if self._detector is None:
            state = draw_fresh(config.detector.count, view, config.detector, config, rng)
        else:
            state = advance(self._detector.particles, view, config.detector, config, rng)
        regions = regions_of([person.belief.estimate for person in self._persons], config)
        factor = detector_factor(overlap_shares(state, regions, config), config.interaction)
        return weigh(state, view, config.detector, config, factor)

    def _status(self, person: Person) -> Status:
        return Status.TRACKED if person.missing < self._config.life.doubt_frames else Status.TENTATIVE

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


def predicted(person: Person, view: View) -> NDArray[np.float64]:
    """Move a person's last estimate (9,) on to this frame, by its velocity and the camera's turn."""
    state = person.belief.estimate.copy()
    state[:4] += view.dt_s * state[VX:]
    state[[X]] = view.after_turn(state[[X]])
    return state
