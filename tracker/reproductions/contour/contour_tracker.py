"""The contour tracker: a sequential detector finds people, and each has its own particle filter."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import Calibration, PinholeCalibration
from peopleboy.tracker.camera_mount import Mount, mount_of
from peopleboy.tracker.frame import COLOUR, THERMAL, Frame, check_frame, time_step
from peopleboy.tracker.reproductions.contour.appearance.appearance_model import likelihood
from peopleboy.tracker.reproductions.contour.box_interaction import (
    Regions,
    box_of,
    detector_factor,
    overlap_shares,
    person_factor,
    places_on_floor,
    regions_of,
    size_factor,
)
from peopleboy.tracker.reproductions.contour.contour_config import FilterConfig, TrackerConfig
from peopleboy.tracker.reproductions.contour.estimated_mount import (
    MountBelief,
    believed_from,
    is_learnable,
    reports_mount,
    seen_from,
)
from peopleboy.tracker.reproductions.contour.explanation import DETECTOR_KEY, ContourExplanation, ellipse_of
from peopleboy.tracker.reproductions.contour.measurement.likelihood import (
    ContourModel,
    clutter_of,
    settled_clutter,
)
from peopleboy.tracker.reproductions.contour.occlusion.depth_order import (
    ExpectedPerson,
    Order,
    OrderContext,
    expected,
    sorted_by_lead,
    surroundings_of,
)
from peopleboy.tracker.reproductions.contour.occlusion.learned_order import make_order
from peopleboy.tracker.reproductions.contour.occlusion.occlusion_policy import OcclusionPolicy, make_policy
from peopleboy.tracker.reproductions.contour.particle_filter import (
    Belief,
    FrameView,
    advance,
    draw_fresh,
    view_frame,
    weigh,
)
from peopleboy.tracker.reproductions.contour.particles import Floats, draw_around
from peopleboy.tracker.reproductions.contour.tracked_person import (
    FORGET_S,
    Streak,
    TrackedPerson,
    initiate_person,
)
from peopleboy.tracker.track import Box, FloorPlace, Status, Track

COVERED_RESPONSE = 0.4  # response of contour points on people in front: neutral


class ContourTracker:
    """Finds people one after the other, tracks each while visible, and remembers occluded ones.

    Source: thesis, chapters 5 and 7.
    """

    def __init__(self, config: TrackerConfig, rng: np.random.Generator, order: Order | None = None) -> None:
        self._given = config
        self._config = config  # the same with limits for the camera
        self._mount: tuple[Calibration | None, int, Mount] | None = None
        self._belief: MountBelief | None = None  # of an uncalibrated camera
        self._rng = rng
        self._order = order or make_order(config.depth)
        self._policy = make_policy(config)
        self._model: ContourModel | None = None
        self._clutter: float | None = None
        self._last_s: float | None = None
        self._detector: Belief | None = None
        self._streak = Streak()
        self._persons: tuple[TrackedPerson, ...] = ()
        self._memories: tuple[TrackedPerson, ...] = ()
        self._confirmed: tuple[TrackedPerson, ...] = ()
        self._born = 0
        self._introduced: Box | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """The thermal camera, and the colour camera if colours are used; it is optional."""
        return (THERMAL,) if self._config.colour is None else (THERMAL, COLOUR)

    def introduce(self, box: Box) -> None:
        """Report that a person is at this box [px] in the next frame, to initialise it.

        The person's filter starts there, and the detector avoids it.
        """
        self._introduced = box

    @property
    def explanation(self) -> ContourExplanation:
        """Contours and samples behind the tracks of the last frame."""
        clouds = {person.id: person.belief.particles for person in self._persons}
        if self._detector is not None:
            clouds = {DETECTOR_KEY: self._detector.particles, **clouds}
        return ContourExplanation(
            config=self._config,
            ellipses={person.id: ellipse_of(person.shown) for person in self._confirmed},
            spread_px2={person.id: person.belief.uncertainty_px2 for person in self._confirmed},
            particles=clouds,
        )

    def update(self, frame: Frame) -> tuple[Track, ...]:
        """Process the next frame and return the reported tracks.

        Raises:
            BadInput: the time does not increase.
        """
        check_frame(frame)
        dt_s = time_step(frame.time_s, self._last_s)
        image = frame.grey(THERMAL)
        mount = self._mount_for(frame.calibrations.get(THERMAL), image.shape[0])
        model = self._model_for(image, dt_s)
        view = view_frame(frame, dt_s, model, self._config, mount)
        self._last_s = frame.time_s
        self._memories = self._remembered(view)
        self._part(_follow(self._persons, view, self._config, self._order, self._policy, self._rng))
        if self._introduced is not None:
            self._meet(self._introduced, view, frame.time_s)
            self._introduced = None
        self._identify(view, frame.time_s)
        newcomer = self._search(view, frame.time_s)
        self._learn_mount(model.shape[0])
        known = (*self._persons, *self._memories)
        shown = [person for person in known if not person.is_hidden or self._is_shown(person, view)]
        self._confirmed = (*shown, *newcomer)
        return self._tracks(frame)

    def _model_for(self, image: NDArray[np.uint8], dt_s: float) -> ContourModel:
        shape = (image.shape[0], image.shape[1])
        if self._model is None or self._model.shape != shape:
            self._model = ContourModel.build(shape, self._config.contour)
        if self._config.contour.clutter_share == 0:
            return self._model
        self._clutter = settled_clutter(self._clutter, clutter_of(image), dt_s)
        return self._model.amid(self._clutter)

    def _mount_for(self, calibration: Calibration | None, rows: int) -> Mount:
        """Return the camera's mount, and adapt the limits to it, once for each camera."""
        if self._mount is None or self._mount[0] is not calibration or self._mount[1] != rows:
            mount = mount_of(calibration, rows)
            self._mount = calibration, rows, mount
            self._config, self._model = seen_from(self._given, mount, rows), None
            is_known = isinstance(calibration, PinholeCalibration)
            self._belief = None
            if not is_known and is_learnable(self._given):
                self._belief = MountBelief.usual(self._given.detector.limits)
                self._config = believed_from(self._given, self._belief)
        return self._mount[2]

    def _learn_mount(self, rows: int) -> None:
        """Update the estimated mount of an uncalibrated camera from clearly visible people."""
        if self._belief is None:
            return
        telling = [person for person in self._persons if reports_mount(person, rows)]
        for person in telling:
            self._belief = self._belief.learnt(person.belief.estimate, rows)
        if telling:
            self._config = believed_from(self._given, self._belief)

    def _remembered(self, view: FrameView) -> tuple[TrackedPerson, ...]:
        """Keep people who are no longer searched for in memory for a limited time."""
        later = (
            replace(
                person,
                shown=self._policy.whereabouts(person, self._persons, view),
                hidden_s=person.hidden_s + view.dt_s,
                hidden_frames=person.hidden_frames + 1,
            )
            for person in self._memories
        )
        return tuple(person for person in later if person.hidden_s <= FORGET_S)

    def _part(self, persons: tuple[TrackedPerson, ...]) -> None:
        """Divide people into those who are tracked, only remembered, and deleted."""
        kept, memories = [], []
        for person in persons:
            if self._is_kept(person):
                kept.append(person)
            elif person.is_hidden or self._policy.remembers_lost(person):
                memories.append(replace(person, status=Status.TOTALLY_OCCLUDED, is_behind=False))
        self._persons = tuple(kept)
        self._memories = (*self._memories, *memories)

    def _is_kept(self, person: TrackedPerson) -> bool:
        if person.is_hidden:
            return self._policy.searches(person)
        # Without confidence no sample is within the limits, and the estimate may not be an ellipse at all.
        return person.missing < self._config.life.death_frames and person.belief.confidence > 0

    def _search(self, view: FrameView, time_s: float) -> tuple[TrackedPerson, ...]:
        """Update the detector; a track is initiated when it has settled on a person for long enough.

        Returns:
            The tentative candidate; empty if there is none.
        """
        config = self._config
        self._detector = self._detected(view)
        known = [person.shown for person in (*self._persons, *self._memories)]
        self._streak = self._streak.after(self._detector, known, view, config)
        if not self._streak.is_some:
            return ()
        found = initiate_person(self._born + 1, self._detector, view, time_s, config)
        if not self._streak.is_enough(config):
            return (replace(found, status=Status.TENTATIVE),)
        self._streak, self._detector = Streak(), None
        found = self._identified(found, view, time_s)
        self._born = max(self._born, found.id)
        self._persons = tuple(sorted((*self._persons, found), key=lambda person: person.id))
        return ()

    def _identify(self, view: FrameView, time_s: float) -> None:
        """Identify people who were hardly visible when they were found."""
        for person in self._persons:
            if person.is_unidentified and not person.is_hidden:
                found = self._identified(person, view, time_s)
                others = (other for other in self._persons if other is not person)
                self._persons = tuple(sorted((*others, found), key=lambda other: other.id))

    def _identified(self, found: TrackedPerson, view: FrameView, time_s: float) -> TrackedPerson:
        """Return a person with the identity of the matching person who was lost before.

        While comparison with some lost person is impossible, the identity stays undecided.
        """
        hidden = (person for person in self._persons if person.is_hidden)
        before = [one for one in (*self._memories, *hidden) if one.hidden_s >= time_s - found.born_s]
        if not all(self._policy.can_compare(found, person) for person in before):
            return replace(found, is_unidentified=True)
        known = self._policy.recognised(found, before, view) if before else None
        if known is None:
            return replace(found, is_unidentified=False)
        self._memories = tuple(person for person in self._memories if person is not known)
        self._persons = tuple(person for person in self._persons if person is not known)
        return replace(
            found,
            id=known.id,
            born_s=known.born_s,
            appearance=known.appearance or found.appearance,
            is_unidentified=False,
        )

    def _meet(self, box: Box, view: FrameView, time_s: float) -> None:
        """Start a filter on samples around a hinted person."""
        state = draw_around(box, self._config, self._rng)
        belief = weigh(state, view, self._config.person, self._config)
        found = initiate_person(self._born + 1, belief, view, time_s, self._config)
        self._born = found.id
        self._persons = (*self._persons, found)

    def _detected(self, view: FrameView) -> Belief:
        """Move and weigh the detector's samples in each scan, away from tracked people."""
        config, rng, belief = self._config, self._rng, self._detector
        seen = [person.belief.estimate for person in self._persons if not person.is_hidden]
        regions = regions_of(seen, config)
        for look in range(config.search.scans):
            if belief is None:
                state = draw_fresh(config.detector.count, view, config.detector, config, rng)
            else:
                moved = view if look == 0 else replace(view, turn_rad=0.0)  # the camera turns once
                state = advance(belief.particles, moved, config.detector, config, rng)
            factor = detector_factor(state, regions, config)
            belief = weigh(state, view, config.detector, config, factor)
        assert belief is not None
        return belief

    def _is_shown(self, person: TrackedPerson, view: FrameView) -> bool:
        """Return whether an occluded person is output: only inside the image."""
        region = regions_of([person.shown], self._config)[0]
        is_in_image = region[0] <= view.image.shape[1] and region[0] + region[2] >= 0
        return bool(is_in_image) and self._policy.is_shown(person, region, view)

    def _tracks(self, frame: Frame) -> tuple[Track, ...]:
        config, calibration = self._config, frame.calibrations.get(THERMAL)
        boxes = [box_of(person.shown, config.box) for person in self._confirmed]
        places: Sequence[FloorPlace | None] = [None] * len(boxes)
        if calibration is not None:
            places = places_on_floor(boxes, [person.status for person in self._confirmed], calibration)
        return tuple(
            Track(
                id=person.id,
                boxes={THERMAL: box},
                place=place,
                confidence=person.belief.confidence,
                status=person.status,
                age_s=frame.time_s - person.born_s,
                occluder=person.occluder,
            )
            for person, box, place in zip(self._confirmed, boxes, places, strict=True)
        )


def _follow(
    persons: Sequence[TrackedPerson],
    view: FrameView,
    config: TrackerConfig,
    order: Order | None,
    policy: OcclusionPolicy,
    rng: np.random.Generator,
) -> tuple[TrackedPerson, ...]:
    """Update all filters with a frame.

    Source: thesis, algorithm 6; but the order is determined from the predictions, before the measurement, so
    that people in front can be excluded from the evidence for those behind.
    """
    figures: Sequence[ExpectedPerson] = expected(persons, view, config)
    if order is not None and len(figures) > 1:
        figures = [figures[row] for row in sorted_by_lead(order(figures, view))]
    samples = _shared_filter(config, len(persons))
    followed: list[tuple[TrackedPerson, Regions]] = []
    for number, figure in enumerate(figures):
        surroundings = surroundings_of(figure, followed, figures[number + 1 :], view, config)
        person = _carried_on(figure.person, surroundings, view, samples, config, policy, rng)
        followed.append((person, regions_of([person.belief.estimate], config)[0]))
    return tuple(sorted((person for person, _ in followed), key=lambda person: person.id))


def _shared_filter(config: TrackerConfig, persons: int) -> FilterConfig:
    """Give everybody N samples, or an equal part of a common number."""
    if config.interaction.total_count == 0 or persons == 0:
        return config.person
    return replace(config.person, count=max(1, config.interaction.total_count // persons))


def _carried_on(
    person: TrackedPerson,
    surroundings: OrderContext,
    view: FrameView,
    samples: FilterConfig,
    config: TrackerConfig,
    policy: OcclusionPolicy,
    rng: np.random.Generator,
) -> TrackedPerson:
    """Predict, weigh and evaluate one person."""
    is_overlapped = bool(surroundings.front) or person.is_hidden
    is_core = samples.resamples_core and not person.is_hidden
    particles = person.belief.core if is_core else person.belief.particles
    state = advance(particles, view, samples, config, rng, policy.motion_of(person), not is_overlapped)
    own_view = view
    if surroundings.front and config.depth.removes_front:
        own_view = replace(view, image=surroundings.image, covered=COVERED_RESPONSE)
    likeness = _likeness(person, state, surroundings, view, config)
    factor = None
    if policy.keeps_off(person):
        shares = overlap_shares(state, surroundings.others, config)
        factor = person_factor(shares, surroundings.strength)
        if is_overlapped and config.height.overlapped_spread > 0:
            factor = factor * _height_kept(person, state, config.height.overlapped_spread)
    belief = weigh(state, own_view, config.person, config, factor, likeness)
    return policy.judge(person, belief, surroundings, view, rng)


def _height_kept(person: TrackedPerson, state: Floats, spread: float) -> Floats:
    """Penalise samples (N,) whose height differs from the person's height when last fully visible."""
    factor: Floats = size_factor(state, max(float(person.size[1]), 1.0), spread)
    return factor


def _likeness(
    person: TrackedPerson, state: Floats, surroundings: OrderContext, view: FrameView, config: TrackerConfig
) -> Floats | None:
    """Return the likelihood of samples (N,) by appearance (thesis, equation 6.4); None if unknown."""
    if person.appearance is None or config.colour is None:
        return None
    removes = config.depth.removes_front
    features = view.describe(state, surroundings.hiding if removes else None)
    if features is None:
        return None
    # An invisible person gets the typical appearance: one standard deviation off in every feature.
    return likelihood(features, person.appearance, config.colour, 1.0 if removes else math.nan)
