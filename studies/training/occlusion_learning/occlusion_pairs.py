"""Examples of overlapping people: what the tracker measured of them, and who truly was in front."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.contour.contour_config import TrackerConfig
from peopleboy.tracker.contour.contour_tracker import ContourTracker
from peopleboy.tracker.contour.occlusion.depth_order import ExpectedPerson, Leads, Order, lower_foot
from peopleboy.tracker.contour.occlusion.learned_order import features_of
from peopleboy.tracker.contour.occlusion.pair_features import FEATURES, Features, overlapping_pairs
from peopleboy.tracker.contour.particle_filter import FrameView

# A tracked person is the true one whose box it overlaps most, and by at least this (thesis, section 3.4).
_LEAST_IOU = 0.5
# With less than this of a person in view, the moment of total occlusion has come: earlier than in the event
# log, as so little of a person has no looks to learn from.
_TOTAL = 0.15
# Nobody is in front of whom the other hides less than this share, and who is no nearer than that.
_LEAST_HIDDEN, _LEAST_GAP_M = 0.02, 0.3
# Frames between two examples of one occlusion, and frames apart after which it is another one.
_EVERY, _PAUSE = 2, 15


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PairExample:
    """Two overlapping people at one instant.

    Attributes:
        scenario, seed, frame: where they are from.
        one, other: their names.
        features: (6,) the one's minus the other's.
        is_front: whether the one is in front.
    """

    scenario: str
    seed: int
    frame: int
    one: str
    other: str
    features: Features
    is_front: bool


@dataclass(slots=True)
class RecordingOrder:
    """Answers like another order, and keeps what it was asked since `asked` was last cleared.

    Attributes:
        remembers_feet: as in `pair_features`.
        order: who answers.
        asked: the people who overlap, two by two, with their features.
    """

    remembers_feet: bool
    order: Order = lower_foot
    asked: list[tuple[ExpectedPerson, ExpectedPerson, Features]] = field(default_factory=list)

    def __call__(self, figures: Sequence[ExpectedPerson], view: FrameView) -> Leads:
        """Tell who is in front."""
        seen = [figure for figure in figures if not figure.person.is_hidden]
        if len(seen) > 1:
            pairs = overlapping_pairs(np.stack([figure.state for figure in seen]))
            features = features_of(seen, pairs, view, remembers_feet=self.remembers_feet)
            self.asked += [(seen[i], seen[j], row) for (i, j), row in zip(pairs, features, strict=True)]
        return self.order(figures, view)


@dataclass(slots=True)
class Episodes:
    """Which occlusions are going on, by the names of the two."""

    last_frame: dict[frozenset[str], int] = field(default_factory=dict)
    last_taken: dict[frozenset[str], int] = field(default_factory=dict)
    over: set[frozenset[str]] = field(default_factory=set)

    def takes(self, one: PersonTruth, other: PersonTruth, frame: int) -> bool:
        """Tell whether to keep this example: not every frame, and none from a total occlusion on.

        Source: thesis, section 7.4: only what precedes the moment of total occlusion.
        """
        pair = frozenset((one.name, other.name))
        if frame - self.last_frame.get(pair, frame) > _PAUSE:
            self.over.discard(pair)
        self.last_frame[pair] = frame
        if 1.0 - max(one.occluded_fraction, other.occluded_fraction) < _TOTAL:
            self.over.add(pair)
        if pair in self.over or frame - self.last_taken.get(pair, -_EVERY) < _EVERY:
            return False
        self.last_taken[pair] = frame
        return True


def who_is_in_front(one: PersonTruth, other: PersonTruth) -> bool | None:
    """Tell whether the one is in front: it hides more of the other, or is clearly nearer; None if neither."""
    hides = other.hidden_by.get(one.name, 0.0) - one.hidden_by.get(other.name, 0.0)
    if abs(hides) >= _LEAST_HIDDEN:
        return hides > 0.0
    gap = other.distance_m - one.distance_m
    return gap > 0.0 if abs(gap) >= _LEAST_GAP_M else None


def collect(scenario: str, seed: int, config: TrackerConfig) -> Iterator[PairExample]:
    """Run a tracker through a scenario and yield the examples of each frame.

    Raises:
        BadInput: an unknown scenario.
    """
    from peopleboy.sim.world import World  # here, as examples that are there can be read without PyBullet

    loaded = load_scenario(scenario)
    order, episodes = RecordingOrder(config.depth.remembers_feet), Episodes()
    people = ContourTracker(config, stream(seed, "tracker"), order)
    with World(loaded.world(seed)) as world:
        frames = round(loaded.duration_s * world.config.control_hz)
        for tick in closed_loop(world, people, loaded.make_behaviour(), frames):
            for one, other, features in order.asked:
                example = _example(loaded.name, seed, tick, one, other, features, episodes)
                if example is not None:
                    yield example
            order.asked.clear()


def _example(
    scenario: str,
    seed: int,
    tick: Tick,
    one: ExpectedPerson,
    other: ExpectedPerson,
    features: Features,
    episodes: Episodes,
) -> PairExample | None:
    """Find out who two figures are, and make an example of them if they are fit for one."""
    true_one, true_other = (_true_person(figure, tick.truth.people) for figure in (one, other))
    if true_one is None or true_other is None or true_one is true_other:
        return None
    is_front = who_is_in_front(true_one, true_other)
    if not episodes.takes(true_one, true_other, tick.frame) or is_front is None:
        return None
    return PairExample(
        scenario=scenario,
        seed=seed,
        frame=tick.frame,
        one=true_one.name,
        other=true_other.name,
        features=features,
        is_front=is_front,
    )


def _true_person(figure: ExpectedPerson, people: Sequence[PersonTruth]) -> PersonTruth | None:
    """Find the person whose box a tracked one overlaps most; None if it overlaps nobody's enough."""
    boxed = [person for person in people if person.box is not None]
    if not boxed:
        return None
    overlap = iou(np.array([person.box for person in boxed]), np.asarray(figure.region, np.float64))
    best = int(np.argmax(overlap))
    return boxed[best] if overlap[best] >= _LEAST_IOU else None


def mirrored(examples: Sequence[PairExample]) -> tuple[Features, NDArray[np.bool_]]:
    """Give features (2 P, 6) and truths (2 P,) of all pairs one way round, then of all the other way round.

    So as many are positive as negative (thesis, section 7.4).
    """
    features = np.array([example.features for example in examples]).reshape(-1, len(FEATURES))
    is_front = np.array([example.is_front for example in examples], dtype=bool)
    return np.concatenate([features, -features]), np.concatenate([is_front, ~is_front])
