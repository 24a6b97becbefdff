"""One frame for everybody: the filters of all people, from front to back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracker.appearance.colour_model import ColourModel, likelihood, squared_distances
from tracker.appearance.colour_view import ColourView
from tracker.appearance.config import ColourConfig
from tracker.config import FilterConfig, MotionConfig, TrackerConfig
from tracker.contour import SECTIONS
from tracker.cover import body_share, covered_by, head_share, seen_shares
from tracker.filter import Belief, View, advance, weigh
from tracker.interaction import overlap_shares, person_factor, regions_of
from tracker.life import is_kept
from tracker.looks import LooksView, visible
from tracker.measure import probability
from tracker.order import Figure, Order, front_to_back
from tracker.particles import VX, VY, Floats, H, X, Y
from tracker.person import Person, moved_on
from tracker.smooth import smoothed
from tracker.track import Status

VELOCITY_S = 0.4  # time constant of the velocity with which a hidden person walks on
FOOT_S = 0.5
CLEAR = 0.5  # share of head and body in view from which a hidden person may be seen again
HIDDEN_BODY = 0.4  # least share of the contour by which a person with a covered head is still followed


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """The others, as one person's filter sees them.

    Attributes:
        front: those in front who overlap the person, as they are in this frame.
        others: everybody else who is seen: their regions (M, 4) [px].
        strength: (M,) rho of equation 5.3 towards each.
        image: (H, W) with the people in front marked as covered.
    """

    front: tuple[Person, ...]
    others: Floats
    strength: NDArray[np.float64]
    image: NDArray[np.uint8]


def follow(
    persons: Sequence[Person], view: View, config: TrackerConfig, order: Order, rng: np.random.Generator
) -> tuple[Person, ...]:
    """Carry everybody's filter on to this frame.

    Source: thesis, algorithm 6; but the order is found on the predictions, before the image is measured, so
    that those in front can be taken out of the evidence for those behind.
    """
    figures = [figure_of(person, view, config) for person in persons]
    if config.occlusion.is_handled:
        figures = list(front_to_back(figures, order, view))
    followed: list[Person] = []
    for number, figure in enumerate(figures):
        scene = _scene(figure, followed, figures[number + 1 :], view, config)
        followed.append(_carried_on(figure, scene, view, config, len(persons), rng))
    return tuple(sorted(followed, key=lambda person: person.id))


def figure_of(person: Person, view: View, config: TrackerConfig) -> Figure:
    """Predict where a person is in this frame."""
    state = moved_on(person.shown if person.is_hidden else person.belief.estimate, view)
    return Figure(person, state, regions_of([state], config)[0])


def _scene(
    figure: Figure, ahead: Sequence[Person], behind: Sequence[Figure], view: View, config: TrackerConfig
) -> Scene:
    """Sort the others into those who hide this person and those whom it is to keep off."""
    seen = [person for person in ahead if not person.is_hidden]
    regions = regions_of([person.belief.estimate for person in seen], config)
    overlaps = overlap_shares(figure.state.astype(np.float32)[None], regions, config)[0] > 0
    is_front = overlaps & config.occlusion.is_handled
    front = tuple(person for person, hides in zip(seen, is_front, strict=True) if hides)
    later = [other.region for other in behind if not other.person.is_hidden]
    interaction = config.interaction
    return Scene(
        front=front,
        others=np.concatenate([regions, np.array(later, dtype=np.float32).reshape(-1, 4)]),
        strength=np.concatenate(
            [
                np.where(is_front, interaction.occluded_penalty, interaction.penalty),
                np.full(len(later), interaction.penalty),
            ]
        ),
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
    figure: Figure, scene: Scene, view: View, config: TrackerConfig, count: int, rng: np.random.Generator
) -> Person:
    """Predict, weigh and judge one person."""
    person, handling = figure.person, config.occlusion
    was_hidden = person.is_hidden
    motion = hidden_motion(config) if was_hidden and handling.keeps_velocity else config.motion
    particles = person.belief.particles if was_hidden else person.belief.core
    state = advance(particles, view, shared_filter(config, count), config, rng, motion)
    own_view = view
    if scene.front and handling.removes_front:
        own_view = replace(view, image=scene.image, covered=handling.covered_response)
    factor = _factor(person, state, scene, view, config)
    belief = weigh(state, own_view, config.person, config, factor)
    judged = judge(person, belief, scene, view, config)
    if judged.is_hidden and not was_hidden and handling.keeps_velocity:
        judged = walking_on(judged, rng)
    return judged


def shared_filter(config: TrackerConfig, persons: int) -> FilterConfig:
    """Give everybody N samples, or an equal part of what all share."""
    if config.interaction.total_count == 0:
        return config.person
    return replace(config.person, count=max(1, config.interaction.total_count // persons))


def hidden_motion(config: TrackerConfig) -> MotionConfig:
    """Let a hidden person walk on steadily."""
    share, motion = config.occlusion.hidden_noise, config.motion
    return replace(
        motion,
        noise_x=share * motion.noise_x,
        noise_y=share * motion.noise_y,
        noise_w=share * motion.noise_w,
        noise_h=share * motion.noise_h,
        noise_d=share * motion.noise_d,
        place_memory=config.occlusion.hidden_memory,
    )


def _factor(person: Person, state: Floats, scene: Scene, view: View, config: TrackerConfig) -> Floats:
    """Weigh samples (N,) by what is known beside the contour: the others, and the person's colours.

    Source: thesis, equations 5.2 and 6.17; section 7.3, by which a hidden person is not penalised.
    """
    factor = np.ones(len(state), dtype=np.float32)
    if not person.is_hidden:
        factor = person_factor(overlap_shares(state, scene.others, config), scene.strength)
    model = appearance(person)
    if model is None or config.colour is None:
        return factor
    front = scene.front if config.occlusion.removes_front else ()
    features = describe(state, front, view, config)
    return factor if features is None else factor * likelihood(features, model, config.colour)


def appearance(person: Person) -> ColourModel | None:
    """Give what a person's samples are compared with."""
    return person.colour if person.looks is None else person.looks


def describe(state: Floats, front: Sequence[Person], view: View, config: TrackerConfig) -> Floats | None:
    """Describe people (N, 9) as their models do, (N, F); NaN for parts that people in front hide."""
    source = view.colour if view.looks is None else view.looks
    if source is None:
        return None
    hiding = regions_of([other.belief.estimate for other in front], config)
    return visible(source.describe(state), state, hiding)


def judge(person: Person, belief: Belief, scene: Scene, view: View, config: TrackerConfig) -> Person:
    """Tell how well a person is seen after weighing, and learn from it what may be learnt."""
    handling = config.occlusion
    occluder = main_occluder(belief, scene.front, config) if scene.front else None
    if not handling.keeps_velocity:
        shares = seen_shares(scene.image, belief.estimate, view.model.probes) if scene.front else None
        if shares is not None and head_share(shares) <= 1 - handling.head_covered:
            front = next(other for other in scene.front if other.id == occluder)
            return replace(_hidden(person, belief, occluder, view, config), shown=front.shown)
        return _seen(person, belief, occluder, view, config)
    sight = look_at(person, belief, scene, view, config)
    if person.is_hidden:
        if sight.is_clear and sight.confidence > config.life.birth_confidence:
            return _seen(person, belief, occluder, view, config)
        hidden = _hidden(person, belief, occluder, view, config)
        return replace(hidden, missing=person.missing + (sight.head > CLEAR))
    if scene.front and sight.head <= 1 - handling.head_covered and sight.body < HIDDEN_BODY:
        return _hidden(person, belief, occluder, view, config)
    return _seen(person, belief, occluder, view, config)


@dataclass(frozen=True, slots=True)
class Sight:
    """What can be seen of a person at its estimate.

    Attributes:
        head: share of the head's contour that is in view.
        body: share of the whole contour.
        confidence: probability by what is in view alone.
        is_alike: whether what is in view has the person's colours, as far as they are known.
    """

    head: float
    body: float
    confidence: float
    is_alike: bool

    @property
    def is_clear(self) -> bool:
        """Whether most of the right person is in view."""
        return min(self.head, self.body) > CLEAR and self.is_alike


def look_at(person: Person, belief: Belief, scene: Scene, view: View, config: TrackerConfig) -> Sight:
    """Judge a person by what is in view of it alone."""
    rows = belief.estimate.astype(np.float32)[None]
    image = scene.image if scene.front else view.image
    shares = seen_shares(image, belief.estimate, view.model.probes) if scene.front else np.ones(SECTIONS)
    differences = view.model.differences(image, rows, 0.0 if scene.front else None)
    seen = float(shares @ view.model.weights)
    fit = differences[0] @ view.model.weights / max(seen, 1e-3)
    chance = float(probability(np.array([fit], dtype=np.float32), config.likelihood)[0])
    model, features = appearance(person), describe(rows, scene.front, view, config)
    away = np.nan
    if model is not None and features is not None:
        away = float(squared_distances(features, model)[0])
    is_alike = not away > config.occlusion.colour_gate
    return Sight(head_share(shares), body_share(shares), chance, is_alike)


def _hidden(
    person: Person, belief: Belief, occluder: int | None, view: View, config: TrackerConfig
) -> Person:
    return replace(
        person,
        belief=belief,
        shown=smoothed(person.shown, belief.estimate, view, config.smoothing),
        status=Status.TOTALLY_OCCLUDED,
        occluder=occluder,
        missing=0,
        hidden_frames=person.hidden_frames + 1,
        hidden_s=person.hidden_s + view.dt_s,
    )


def _seen(person: Person, belief: Belief, occluder: int | None, view: View, config: TrackerConfig) -> Person:
    status = Status.TRACKED if occluder is None else Status.PARTLY_OCCLUDED
    missing = 0 if is_kept(belief, view, config.life) else person.missing + 1
    if missing >= config.life.doubt_frames:
        status = Status.TENTATIVE
    before = moved_on(person.belief.estimate, replace(view, dt_s=0.0))
    moved = replace(
        person,
        belief=belief,
        shown=smoothed(person.shown, belief.estimate, view, config.smoothing),
        status=status,
        occluder=occluder,
        missing=missing,
        hidden_frames=0,
        hidden_s=0.0,
    )
    if missing > 0 or status is not Status.TRACKED:
        return moved
    speed = (belief.estimate[[X, Y]] - before[[X, Y]]) / view.dt_s
    learned = learn(moved, belief.estimate, view, config)
    return replace(
        learned,
        velocity=blend(person.velocity, speed, view.dt_s / VELOCITY_S),
        foot=float(blend(np.array(person.foot), np.array(foot_of(belief.estimate)), view.dt_s / FOOT_S)),
    )


def learn(person: Person, state: NDArray[np.float64], view: View, config: TrackerConfig) -> Person:
    """Remember what a person looks like who is seen whole.

    Source: thesis, sections 6.1.3 and 7.4, by which the model is not updated during occlusions.
    """
    if config.colour is None:
        return person
    rows = state.astype(np.float32)[None]
    return replace(
        person,
        colour=_updated(person.colour, view.colour, rows, config.colour),
        looks=_updated(person.looks, view.looks, rows, config.colour),
    )


def _updated(
    model: ColourModel | None, source: ColourView | LooksView | None, rows: Floats, config: ColourConfig
) -> ColourModel | None:
    if source is None:
        return model
    features = source.describe(rows)[0]
    return ColourModel.begin(features, config) if model is None else model.updated(features)


def walking_on(person: Person, rng: np.random.Generator) -> Person:
    """Give the samples of a person who has just been hidden its long-time velocity, more or less."""
    belief = person.belief
    state = belief.particles.state.copy()
    spread = 0.25 * float(np.hypot(*person.velocity)) + 4.0
    state[:, [VX, VY]] = person.velocity + spread * rng.standard_normal((len(state), 2)) * (1.0, 0.2)
    shown = person.shown.copy()
    shown[VX:] = [*person.velocity, 0.0, 0.0]
    return replace(
        person, belief=replace(belief, particles=replace(belief.particles, state=state)), shown=shown
    )


def main_occluder(belief: Belief, front: Sequence[Person], config: TrackerConfig) -> int:
    """Name the one of those in front who covers most of a person."""
    regions = regions_of([person.belief.estimate for person in front], config)
    shares = overlap_shares(belief.estimate.astype(np.float32)[None], regions, config)[0]
    return front[int(np.argmax(shares))].id


def foot_of(state: NDArray[np.float64]) -> float:
    """Give the row of a person's feet [px]."""
    return float(state[Y] + 2.05 * state[H])


def blend(before: NDArray[np.float64], now: NDArray[np.float64], share: float) -> NDArray[np.float64]:
    """Move a smoothed value on by a share of the way."""
    return before + min(share, 1.0) * (now - before)
