"""One frame for everybody: the filters of all people, from front to back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from peopleboy.tracker.thermal.appearance.colour_model import likelihood, squared_distances
from peopleboy.tracker.thermal.config import FilterConfig, MotionConfig, TrackerConfig
from peopleboy.tracker.thermal.contour.coverage import covered_by
from peopleboy.tracker.thermal.contour.likelihood import fitness
from peopleboy.tracker.thermal.filter.particles import STATE_SIZE, Floats, H
from peopleboy.tracker.thermal.interaction import overlap_shares, person_factor, regions_of
from peopleboy.tracker.thermal.occlusion.depth_order import ExpectedPerson, Order, front_to_back
from peopleboy.tracker.thermal.occlusion.occlusion_status import judge
from peopleboy.tracker.thermal.occlusion.visibility import Surroundings, appearance, describe
from peopleboy.tracker.thermal.particle_filter import FrameView, advance, weigh
from peopleboy.tracker.thermal.tracked_person import TrackedPerson, moved_on


def follow(
    persons: Sequence[TrackedPerson],
    view: FrameView,
    config: TrackerConfig,
    order: Order,
    rng: np.random.Generator,
) -> tuple[TrackedPerson, ...]:
    """Carry everybody's filter on to this frame.

    Source: thesis, algorithm 6; but the order is found on the predictions, before the image is measured, so
    that those in front can be taken out of the evidence for those behind.
    """
    figures = figures_of(persons, view, config)
    if config.occlusion.is_handled:
        figures = list(front_to_back(figures, order, view))
    followed: list[TrackedPerson] = []
    for number, figure in enumerate(figures):
        surroundings = _surroundings(figure, followed, figures[number + 1 :], view, config)
        followed.append(_carried_on(figure, surroundings, view, config, len(persons), rng))
    return tuple(sorted(followed, key=lambda person: person.id))


def figures_of(
    persons: Sequence[TrackedPerson], view: FrameView, config: TrackerConfig
) -> list[ExpectedPerson]:
    """Predict where people are in this frame, and compare what is seen there with their looks."""
    states = [
        moved_on(person.shown if person.is_hidden else person.belief.estimate, view) for person in persons
    ]
    unlikeness, fits = [0.0] * len(persons), [0.0] * len(persons)
    rows = np.array(states, dtype=np.float32).reshape(-1, STATE_SIZE)
    if (
        config.occlusion.order in ("appearance", "contour")
        and view.appearance is not None
        and len(persons) > 1
    ):
        features = view.appearance.describe(rows)
        unlikeness = [_unlikeness(*each) for each in zip(persons, features, strict=True)]
    if config.occlusion.order == "contour" and len(persons) > 1:
        differences = view.model.differences(view.image, rows)
        fits = fitness(differences, view.model.weights, config.likelihood).tolist()
    regions = regions_of(states, config)
    return [ExpectedPerson(*each) for each in zip(persons, states, regions, unlikeness, fits, strict=True)]


def _unlikeness(person: TrackedPerson, features: Floats) -> float:
    if person.appearance is None:
        return 0.0
    distance = float(squared_distances(features[None], person.appearance)[0])
    return 0.0 if np.isnan(distance) else distance


def _surroundings(
    figure: ExpectedPerson,
    ahead: Sequence[TrackedPerson],
    behind: Sequence[ExpectedPerson],
    view: FrameView,
    config: TrackerConfig,
) -> Surroundings:
    """Sort the others into those who hide this person and those whom it is to keep off."""
    seen = [person for person in ahead if not person.is_hidden]
    regions = regions_of([person.belief.estimate for person in seen], config)
    overlaps = overlap_shares(figure.state.astype(np.float32)[None], regions, config)[0] > 0
    is_front = overlaps & config.occlusion.is_handled
    front = tuple(person for person, hides in zip(seen, is_front, strict=True) if hides)
    later = [other.region for other in behind if not other.person.is_hidden]
    rivals = np.concatenate([regions[~is_front], np.array(later, dtype=np.float32).reshape(-1, 4)])
    interaction = config.interaction
    return Surroundings(
        front=front,
        others=np.concatenate([regions[is_front], rivals]),
        strength=np.repeat([interaction.occluded_penalty, interaction.penalty], [len(front), len(rivals)]),
        image=covered_by(
            view.image,
            [person.belief.estimate for person in front],
            config.contour,
            config.occlusion.growth,
        )
        if front
        else view.image,
    )


def _carried_on(
    figure: ExpectedPerson,
    surroundings: Surroundings,
    view: FrameView,
    config: TrackerConfig,
    count: int,
    rng: np.random.Generator,
) -> TrackedPerson:
    """Predict, weigh and judge one person."""
    person, handling = figure.person, config.occlusion
    was_hidden = person.is_hidden
    motion = hidden_motion(config) if was_hidden and handling.keeps_velocity else config.motion
    particles = person.belief.particles if was_hidden else person.belief.core
    samples = shared_filter(config, count)
    if was_hidden or surroundings.front:
        samples = replace(samples, resized_share=0.0)
    state = advance(particles, view, samples, config, rng, motion)
    own_view = view
    if surroundings.front and handling.removes_front:
        own_view = replace(view, image=surroundings.image, covered=handling.covered_response)
    likeness = _likeness(person, state, surroundings, view, config)
    belief = weigh(
        state, own_view, config.person, config, _distance_kept(person, state, surroundings, config), likeness
    )
    return judge(person, belief, surroundings, view, config, rng)


def shared_filter(config: TrackerConfig, persons: int) -> FilterConfig:
    """Give everybody N samples, or an equal part of what all share."""
    if config.interaction.total_count == 0:
        return config.person
    return replace(config.person, count=max(1, config.interaction.total_count // persons))


def hidden_motion(config: TrackerConfig) -> MotionConfig:
    """Let a hidden person walk on along the floor, and keep its size."""
    handling, motion = config.occlusion, config.motion
    return replace(
        motion,
        noise_x=handling.hidden_noise * motion.noise_x,
        noise_y=handling.hidden_stiffness * motion.noise_y,
        noise_w=handling.hidden_stiffness * motion.noise_w,
        noise_h=handling.hidden_stiffness * motion.noise_h,
        noise_d=handling.hidden_stiffness * motion.noise_d,
        place_memory=handling.hidden_memory,
    )


def _distance_kept(
    person: TrackedPerson, state: Floats, surroundings: Surroundings, config: TrackerConfig
) -> Floats | None:
    """Penalise samples (N,) that overlap the others.

    Source: thesis, equation 5.2; section 7.3, by which a hidden person is not penalised. Ours is, towards all
    who are not in front, or it would come back as one of them.
    """
    if person.is_hidden and not config.occlusion.keeps_velocity:
        return None
    factor = person_factor(overlap_shares(state, surroundings.others, config), surroundings.strength)
    is_overlapped = bool(surroundings.front) or person.is_hidden
    spread = config.occlusion.size_spread if is_overlapped else config.occlusion.seen_size_spread
    return factor if spread == 0 else factor * _size_kept(person, state, spread)


def _size_kept(person: TrackedPerson, state: Floats, spread: float) -> Floats:
    """Penalise samples (N,) that have not the height that the person had of late when seen whole."""
    growth = np.log(np.maximum(state[:, H], np.float32(1)) / np.float32(max(person.size[1], 1.0)))
    factor: Floats = np.exp(np.float32(-0.5 / spread**2) * growth * growth)
    return factor


def _likeness(
    person: TrackedPerson, state: Floats, surroundings: Surroundings, view: FrameView, config: TrackerConfig
) -> Floats | None:
    """Tell how likely samples (N,) look like the person (thesis, equation 6.4); None if nobody knows."""
    model = appearance(person)
    if model is None or config.colour is None:
        return None
    removes = config.occlusion.removes_front
    features = describe(state, surroundings.front if removes else (), view, config)
    if features is None:
        return None
    likeness = likelihood(features, model, config.colour)
    if removes:
        # Who is not seen at all looks as a person usually does: one spread off in every feature.
        unseen = np.isnan(features).all(axis=1)
        likeness[unseen] = np.exp(-config.colour.sharpness * features.shape[1])
    return likeness
