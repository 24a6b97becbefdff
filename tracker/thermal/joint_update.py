"""One frame for everybody: the filters of all people, from front to back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from peopleboy.tracker.thermal.appearance.appearance_model import likelihood
from peopleboy.tracker.thermal.config import FilterConfig, TrackerConfig
from peopleboy.tracker.thermal.interaction import overlap_shares, person_factor
from peopleboy.tracker.thermal.occlusion.depth_order import (
    ExpectedPerson,
    Order,
    Surroundings,
    expected,
    front_to_back,
    surroundings_of,
)
from peopleboy.tracker.thermal.occlusion.policy import OcclusionPolicy
from peopleboy.tracker.thermal.particle_filter import FrameView, advance, weigh
from peopleboy.tracker.thermal.particles import Floats, H
from peopleboy.tracker.thermal.tracked_person import TrackedPerson

COVERED_RESPONSE = 0.4  # what a point of the contour on people in front counts: neither for nor against
NOBODY = np.empty((0, 4), dtype=np.float32)


def follow(
    persons: Sequence[TrackedPerson],
    view: FrameView,
    config: TrackerConfig,
    order: Order | None,
    policy: OcclusionPolicy,
    rng: np.random.Generator,
) -> tuple[TrackedPerson, ...]:
    """Carry everybody's filter on to this frame.

    Source: thesis, algorithm 6; but the order is found on the predictions, before the image is measured, so
    that those in front can be taken out of the evidence for those behind.
    """
    figures: Sequence[ExpectedPerson] = expected(persons, view, config)
    if order is not None:
        figures = front_to_back(figures, order, view)
    samples = _shared_filter(config, len(persons))
    followed: list[TrackedPerson] = []
    for number, figure in enumerate(figures):
        surroundings = surroundings_of(figure, followed, figures[number + 1 :], view, config)
        followed.append(_carried_on(figure.person, surroundings, view, samples, config, policy, rng))
    return tuple(sorted(followed, key=lambda person: person.id))


def _shared_filter(config: TrackerConfig, persons: int) -> FilterConfig:
    """Give everybody N samples, or an equal part of what all share."""
    if config.interaction.total_count == 0 or persons == 0:
        return config.person
    return replace(config.person, count=max(1, config.interaction.total_count // persons))


def _carried_on(
    person: TrackedPerson,
    surroundings: Surroundings,
    view: FrameView,
    samples: FilterConfig,
    config: TrackerConfig,
    policy: OcclusionPolicy,
    rng: np.random.Generator,
) -> TrackedPerson:
    """Predict, weigh and judge one person."""
    is_overlapped = bool(surroundings.front) or person.is_hidden
    particles = person.belief.particles if person.is_hidden else person.belief.core
    state = advance(particles, view, samples, config, rng, policy.motion_of(person), not is_overlapped)
    own_view = view
    if surroundings.front and config.depth.removes_front:
        own_view = replace(view, image=surroundings.image, covered=COVERED_RESPONSE)
    likeness = _likeness(person, state, surroundings, view, config)
    factor = None
    if policy.keeps_off(person):
        shares = overlap_shares(state, surroundings.others, config)
        factor = person_factor(shares, surroundings.strength)
        spread = config.height.overlapped_spread if is_overlapped else config.height.seen_spread
        if spread > 0:
            factor = factor * _height_kept(person, state, spread)
    belief = weigh(state, own_view, config.person, config, factor, likeness)
    return policy.judge(person, belief, surroundings, view, rng)


def _height_kept(person: TrackedPerson, state: Floats, spread: float) -> Floats:
    """Penalise samples (N,) that have not the height that the person had of late when seen whole."""
    growth = np.log(np.maximum(state[:, H], np.float32(1)) / np.float32(max(person.size[1], 1.0)))
    factor: Floats = np.exp(np.float32(-0.5 / spread**2) * growth * growth)
    return factor


def _likeness(
    person: TrackedPerson, state: Floats, surroundings: Surroundings, view: FrameView, config: TrackerConfig
) -> Floats | None:
    """Tell how likely samples (N,) look like the person (thesis, equation 6.4); None if nobody knows."""
    if person.looks is None or config.colour is None:
        return None
    removes = config.depth.removes_front
    features = view.describe(state, surroundings.hiding if removes else NOBODY)
    if features is None:
        return None
    likeness = likelihood(features, person.looks, config.colour)
    if removes:
        # Who is not seen at all looks as a person usually does: one spread off in every feature.
        unseen = np.isnan(features).all(axis=1)
        likeness[unseen] = np.exp(-config.colour.sharpness * features.shape[1])
    return likeness
