"""Whether a person is seen, partly hidden, hidden or in doubt, after its samples were weighed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.thermal.appearance.colour_model import ColourModel
from peopleboy.tracker.thermal.appearance.colour_view import ColourView
from peopleboy.tracker.thermal.appearance.part_appearance import AppearanceView
from peopleboy.tracker.thermal.colour_config import ColourConfig
from peopleboy.tracker.thermal.config import TrackerConfig
from peopleboy.tracker.thermal.contour.coverage import body_share, head_share, seen_shares
from peopleboy.tracker.thermal.filter.particles import FOOT, VX, VY, D, Floats, H, W, X, Y, equally_weighted
from peopleboy.tracker.thermal.interaction import overlap_shares, regions_of
from peopleboy.tracker.thermal.life import is_kept
from peopleboy.tracker.thermal.occlusion.visibility import CLEAR, Surroundings, look_at
from peopleboy.tracker.thermal.particle_filter import Belief, FrameView
from peopleboy.tracker.thermal.smoothing import smoothed
from peopleboy.tracker.thermal.tracked_person import SIZE, TrackedPerson, approached, moved_on
from peopleboy.tracker.track import Status

VELOCITY_S = 0.4  # time constant of the velocity with which a hidden person walks on
FOOT_S = 0.5
Value = TypeVar("Value", float, NDArray[np.float64])
HIDDEN_BODY = 0.4  # least share of the contour by which a person with a covered head is still followed


def judge(
    person: TrackedPerson,
    belief: Belief,
    surroundings: Surroundings,
    view: FrameView,
    config: TrackerConfig,
    rng: np.random.Generator,
) -> TrackedPerson:
    """Tell how well a person is seen, and learn from it what may be learnt."""
    if config.occlusion.keeps_velocity:
        person = approached(person, view)
        return _judge_walking(person, belief, surroundings, view, config, rng)
    if surroundings.front:
        shares = seen_shares(surroundings.image, belief.estimate, view.model.probes)
        if head_share(shares) <= 1 - config.occlusion.head_covered:
            return _behind(person, belief, surroundings, view, config)
    return _seen(person, belief, surroundings, view, config)


def _behind(
    person: TrackedPerson, belief: Belief, surroundings: Surroundings, view: FrameView, config: TrackerConfig
) -> TrackedPerson:
    """Suppose a hidden person where its occluder is (thesis, section 7.3)."""
    occluder = main_occluder(belief, surroundings.front, config)
    return replace(_hidden(person, view), belief=belief, shown=occluder.shown, occluder=occluder.id)


def _judge_walking(
    person: TrackedPerson,
    belief: Belief,
    surroundings: Surroundings,
    view: FrameView,
    config: TrackerConfig,
    rng: np.random.Generator,
) -> TrackedPerson:
    """Judge by what is in view; who is hidden walks on, and is seen again once most of it is."""
    visibility = look_at(person, belief, surroundings, view, config)
    occluder = main_occluder(belief, surroundings.front, config).id if surroundings.front else None
    if person.is_hidden:
        if visibility.is_clear and visibility.confidence > config.life.birth_confidence:
            return _seen(person, belief, surroundings, view, config)
        missing = person.missing + (visibility.head > CLEAR)
        shown = _supposed(person, belief, surroundings, view, config)
        return replace(
            _hidden(person, view),
            belief=belief,
            shown=shown,
            missing=missing,
            occluder=occluder,
            is_behind=_is_behind(shown, surroundings, view),
        )
    is_covered = visibility.head <= 1 - config.occlusion.head_covered and visibility.body < HIDDEN_BODY
    seen = _seen(person, belief, surroundings, view, config)
    is_lost = config.occlusion.remembers_lost and seen.missing >= config.occlusion.lost_frames
    if (surroundings.front and is_covered) or (is_lost and person.is_settled):
        return walking_on(replace(_hidden(seen, view), occluder=occluder), rng)
    return seen


def _supposed(
    person: TrackedPerson, belief: Belief, surroundings: Surroundings, view: FrameView, config: TrackerConfig
) -> NDArray[np.float64]:
    """Suppose where a hidden person is (9,): it walks on, as tall as it was, on the floor where it was."""
    if surroundings.front:
        shown = smoothed(person.shown, belief.estimate, view, config.smoothing)
    else:
        shown = moved_on(person.shown, view)
        shown[VX : VX + 2] *= config.occlusion.hidden_memory
    shown[SIZE] = person.size
    if config.occlusion.hidden_w > 0:
        shown[W] = config.occlusion.hidden_w * shown[H]
    shown[Y] = person.foot - FOOT * shown[H]
    return shown


def _is_behind(state: NDArray[np.float64], surroundings: Surroundings, view: FrameView) -> bool:
    """Tell whether people in front explain why a person with this state (9,) is not seen."""
    if not surroundings.front:
        return False
    return body_share(seen_shares(surroundings.image, state, view.model.probes)) < HIDDEN_BODY


def _hidden(person: TrackedPerson, view: FrameView) -> TrackedPerson:
    return replace(
        person,
        status=Status.TOTALLY_OCCLUDED,
        missing=0,
        hidden_frames=person.hidden_frames + 1,
        hidden_s=person.hidden_s + view.dt_s,
    )


def _seen(
    person: TrackedPerson, belief: Belief, surroundings: Surroundings, view: FrameView, config: TrackerConfig
) -> TrackedPerson:
    missing = 0 if is_kept(belief, view, config.life) else person.missing + 1
    status = Status.PARTLY_OCCLUDED if surroundings.front else Status.TRACKED
    shown = smoothed(person.shown, belief.estimate, view, config.smoothing)
    if missing > 0 and config.occlusion.keeps_velocity:
        shown = moved_on(np.concatenate([person.shown[:VX], person.velocity, (0.0, 0.0)]), view)
    moved = replace(
        person,
        belief=belief,
        shown=shown,
        status=Status.TENTATIVE if missing >= config.life.doubt_frames else status,
        occluder=main_occluder(belief, surroundings.front, config).id if surroundings.front else None,
        is_behind=bool(surroundings.front),
        missing=missing,
        hidden_frames=0,
        hidden_s=0.0,
    )
    if missing > 0 or surroundings.front:
        return moved
    before = moved_on(person.belief.estimate, replace(view, dt_s=0.0))
    speed = (belief.estimate[[X, Y]] - before[[X, Y]]) / view.dt_s
    return replace(
        learn(moved, belief.estimate, view, config),
        seen_frames=person.seen_frames + 1,
        velocity=blend(person.velocity, speed, max(view.dt_s / VELOCITY_S, 1 / (person.seen_frames + 1))),
        foot=blend(person.foot, foot_of(belief.estimate), view.dt_s / FOOT_S),
        size=blend(person.size, belief.estimate[SIZE], view.dt_s / config.occlusion.size_s),
    )


def learn(
    person: TrackedPerson, state: NDArray[np.float64], view: FrameView, config: TrackerConfig
) -> TrackedPerson:
    """Remember what a person looks like who is seen whole.

    Source: thesis, sections 6.1.3 and 7.4, by which the model is not updated during occlusions.
    """
    if config.colour is None:
        return person
    rows = state.astype(np.float32)[None]
    return replace(
        person,
        colour=_updated(person.colour, view.colour, rows, config.colour),
        appearance=_updated(person.appearance, view.appearance, rows, config.colour),
    )


def _updated(
    model: ColourModel | None, source: ColourView | AppearanceView | None, rows: Floats, config: ColourConfig
) -> ColourModel | None:
    if source is None:
        return model
    features = source.describe(rows)[0]
    return ColourModel.begin(features, config) if model is None else model.updated(features)


def walking_on(person: TrackedPerson, rng: np.random.Generator) -> TrackedPerson:
    """Start the samples of a person who has just been hidden from where it is shown, with its velocity."""
    shown = person.shown.copy()
    shown[VX:] = [*person.velocity, 0.0, 0.0]
    size = float(shown[H])
    spread = np.zeros(9)
    spread[[X, Y, W, H, D]] = 0.15 * size, 0.05 * size, 0.03 * size, 0.05 * size, 0.05 * size
    spread[[VX, VY]] = 0.25 * float(np.hypot(*person.velocity)) + 0.3 * size, 0.1 * size
    chance = rng.standard_normal((len(person.belief.particles), 9))
    cloud = equally_weighted((shown + spread * chance).astype(np.float32))
    return replace(person, belief=replace(person.belief, particles=cloud), shown=shown)


def main_occluder(belief: Belief, front: Sequence[TrackedPerson], config: TrackerConfig) -> TrackedPerson:
    """Find the one of those in front who covers most of a person."""
    regions = regions_of([person.belief.estimate for person in front], config)
    shares = overlap_shares(belief.estimate.astype(np.float32)[None], regions, config)[0]
    return front[int(np.argmax(shares))]


def foot_of(state: NDArray[np.float64]) -> float:
    """Give the row of a person's feet [px]."""
    return float(state[Y] + FOOT * state[H])


def blend(before: Value, now: Value, share: float) -> Value:
    """Move a smoothed value on by a share of the way."""
    return before + min(share, 1.0) * (now - before)
