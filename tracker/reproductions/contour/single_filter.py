"""The sources' tracker of a single person: one particle filter that always runs."""

import math
from dataclasses import replace
from typing import Final

import numpy as np

from peopleboy.tracker.frame import THERMAL, Frame, check_frame, time_step
from peopleboy.tracker.reproductions.contour.box_interaction import box_of, places_on_floor
from peopleboy.tracker.reproductions.contour.contour_config import TrackerConfig
from peopleboy.tracker.reproductions.contour.explanation import ContourExplanation, ellipse_of
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel
from peopleboy.tracker.reproductions.contour.particle_filter import Belief, FrameView, begin, step, view_frame
from peopleboy.tracker.reproductions.contour.tracked_person import is_born
from peopleboy.tracker.track import Status, Track

NEW_PERSON_S: Final = 2.0  # after this time without a detection, the next one has a new id


class SingleFilter:
    """Tracks one person at a time with one filter, which neither begins nor ends with the person.

    In each frame, a person counts as detected if the filter's mean probability is above its threshold and
    its uncertainty below. The samples are kept in either case. The sources give no ids; here, the id changes
    if nothing is detected for `NEW_PERSON_S`.

    Source: thesis, chapter 4; paper, section 3.
    """

    def __init__(self, config: TrackerConfig, rng: np.random.Generator) -> None:
        self._config, self._rng = config, rng
        self._model: ContourModel | None = None
        self._belief: Belief | None = None
        self._is_detected = False
        self._last_s: float | None = None
        self._id, self._born_s, self._seen_s = 0, 0.0, -math.inf

    @property
    def cameras(self) -> tuple[str, ...]:
        """The thermal camera."""
        return (THERMAL,)

    @property
    def explanation(self) -> ContourExplanation:
        """Contour and samples behind the track of the last frame."""
        belief = self._belief
        shown = {self._id: belief} if belief is not None and self._is_detected else {}
        return ContourExplanation(
            config=self._config,
            ellipses={number: ellipse_of(one.estimate) for number, one in shown.items()},
            spread_px2={number: one.uncertainty_px2 for number, one in shown.items()},
            particles={} if belief is None else {max(self._id, 1): belief.particles},
        )

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame, and return the track of the person if one is detected.

        Raises:
            BadInput: the time does not increase.
        """
        check_frame(frame)
        view = self._view(frame)
        config, belief = self._config, self._belief
        if belief is None:
            belief = begin(view, config.person, config, self._rng)
        else:
            belief = step(belief.particles, view, config.person, config, self._rng)
        self._belief, self._is_detected = belief, is_born(belief, view, config.life)
        if not self._is_detected:
            return ()
        if frame.time_s - self._seen_s > NEW_PERSON_S:
            self._id, self._born_s = self._id + 1, frame.time_s
        self._seen_s = frame.time_s
        return (self._track(belief, frame),)

    def _view(self, frame: Frame) -> FrameView:
        dt_s = time_step(frame.time_s, self._last_s)
        self._last_s = frame.time_s
        rows, columns = frame.grey(THERMAL).shape
        if self._model is None or self._model.shape != (rows, columns):
            self._model = ContourModel.build((rows, columns), self._config.contour)
        return view_frame(frame, dt_s, self._model, self._config)

    def _track(self, belief: Belief, frame: Frame) -> Track:
        box, calibration = box_of(belief.estimate, self._config.box), frame.calibrations.get(THERMAL)
        track = Track(
            id=self._id,
            boxes={THERMAL: box},
            place=None,
            confidence=belief.confidence,
            status=Status.TRACKED,
            age_s=frame.time_s - self._born_s,
        )
        if calibration is None:
            return track
        (place,) = places_on_floor([box], [track.status], calibration)
        return replace(track, place=place)
