"""Pairs of overlapping people: what a tracker measured of them, and which one truly was in front."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import Tick, closed_loop
from peopleboy.scenarios.running.engine.task import Tell
from peopleboy.sim.random_streams import stream
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.tracker.boxes import iou
from peopleboy.tracker.contour.contour_config import TrackerConfig
from peopleboy.tracker.contour.contour_tracker import ContourTracker
from peopleboy.tracker.contour.occlusion.depth_order import ExpectedPerson, Leads, Order, lower_foot
from peopleboy.tracker.contour.occlusion.learned_order import LearnedOrder, features_of
from peopleboy.tracker.contour.occlusion.learned_table import LearnedTable
from peopleboy.tracker.contour.occlusion.pair_features import FEATURES, Features, overlapping_pairs
from peopleboy.tracker.contour.particle_filter import FrameView

SCENARIOS = (
    "crossing_pair",
    "crossing_3",
    "pass_behind",
    "stop_and_talk",
    "group_abreast",
    "crowd_8_moving",
    "crossing_2",
    "crossing_2_moving",
    "crossing_4",
    "three_depths",
    "leader_swap",
    "same_uniform",
)
"""Where people occlude each other, and samples come from."""

LEAST = 20
"""Fewer pairs are not trained on."""

# A tracked person is the true one whose box it overlaps most, and by at least this (thesis, section 3.4).
_LEAST_IOU = 0.5
# With less than this of a person in view, the moment of total occlusion has come: earlier than in the event
# log, as so little of a person has no appearance to measure.
_TOTAL = 0.15
# Neither is in front if one occludes less than this share of the other, and their distances differ by less.
_LEAST_HIDDEN, _LEAST_GAP_M = 0.02, 0.3
# Frames between two samples of one occlusion, and frames apart after which it is another one.
_EVERY, _PAUSE = 2, 15


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PairSample:
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
    """An order of people that answers like another, and keeps what it was asked since `asked` was cleared.

    Attributes:
        remembers_feet: as in `pair_features`.
        order: that answers.
        asked: the people who overlap, two by two, with their features.
    """

    remembers_feet: bool
    order: Order = lower_foot
    asked: list[tuple[ExpectedPerson, ExpectedPerson, Features]] = field(default_factory=list)

    def __call__(self, figures: Sequence[ExpectedPerson], view: FrameView) -> Leads:
        """Return who is in front."""
        seen = [figure for figure in figures if not figure.person.is_hidden]
        if len(seen) > 1:
            pairs = overlapping_pairs(np.stack([figure.state for figure in seen]))
            features = features_of(seen, pairs, view, remembers_feet=self.remembers_feet)
            self.asked += [(seen[i], seen[j], row) for (i, j), row in zip(pairs, features, strict=True)]
        return self.order(figures, view)


@dataclass(slots=True)
class Episodes:
    """The occlusions that are going on, by the names of the two."""

    last_frame: dict[frozenset[str], int] = field(default_factory=dict)
    last_taken: dict[frozenset[str], int] = field(default_factory=dict)
    over: set[frozenset[str]] = field(default_factory=set)

    def takes(self, one: PersonTruth, other: PersonTruth, frame: int) -> bool:
        """Return whether to keep this sample: not every frame, and none from a total occlusion on.

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


def is_in_front(one: PersonTruth, other: PersonTruth) -> bool | None:
    """Tell whether the one is in front: it hides more of the other, or is clearly nearer; None if neither."""
    hides = other.hidden_by.get(one.name, 0.0) - one.hidden_by.get(other.name, 0.0)
    if abs(hides) >= _LEAST_HIDDEN:
        return hides > 0.0
    gap = other.distance_m - one.distance_m
    return gap > 0.0 if abs(gap) >= _LEAST_GAP_M else None


def collect_pairs(scenario: str, seed: int, config: TrackerConfig) -> Iterator[PairSample]:
    """Run a tracker through a scenario and yield the samples of each frame.

    Raises:
        BadInput: an unknown scenario.
    """
    from peopleboy.sim.world import World  # here, as samples that are there can be read without PyBullet

    loaded = load_scenario(scenario)
    order, episodes = RecordingOrder(config.depth.remembers_feet), Episodes()
    people = ContourTracker(config, stream(seed, "tracker"), order)
    with World(loaded.world(seed)) as world:
        frames = round(loaded.duration_s * world.config.control_hz)
        for tick in closed_loop(world, people, loaded.make_behaviour(), frames):
            for one, other, features in order.asked:
                sample = _sample(loaded.name, seed, tick, one, other, features, episodes)
                if sample is not None:
                    yield sample
            order.asked.clear()


def _sample(
    scenario: str,
    seed: int,
    tick: Tick,
    one: ExpectedPerson,
    other: ExpectedPerson,
    features: Features,
    episodes: Episodes,
) -> PairSample | None:
    """Identify two tracked people, and make a sample of them if they are fit for one."""
    true_one, true_other = (_true_person(figure, tick.truth.people) for figure in (one, other))
    if true_one is None or true_other is None or true_one is true_other:
        return None
    is_front = is_in_front(true_one, true_other)
    if not episodes.takes(true_one, true_other, tick.frame) or is_front is None:
        return None
    return PairSample(
        scenario=scenario,
        seed=seed,
        frame=tick.frame,
        one=true_one.name,
        other=true_other.name,
        features=features,
        is_front=is_front,
    )


def _true_person(figure: ExpectedPerson, people: Sequence[PersonTruth]) -> PersonTruth | None:
    """Return the person whose box a tracked one overlaps most; None if it overlaps none enough."""
    boxed = [person for person in people if person.box is not None]
    if not boxed:
        return None
    overlap = iou(np.array([person.box for person in boxed]), np.asarray(figure.region, np.float64))
    best = int(np.argmax(overlap))
    return boxed[best] if overlap[best] >= _LEAST_IOU else None


def mirror(samples: Sequence[PairSample]) -> tuple[Features, NDArray[np.bool_]]:
    """Return features (2 P, 6) and labels (2 P,) of all pairs one way round, then of all the other way round.

    So as many are positive as negative (thesis, section 7.4).
    """
    features = np.array([sample.features for sample in samples]).reshape(-1, len(FEATURES))
    is_front = np.array([sample.is_front for sample in samples], dtype=bool)
    return np.concatenate([features, -features]), np.concatenate([is_front, ~is_front])


def check_samples(samples: Sequence[PairSample]) -> None:
    """Refuse to train on next to nothing.

    Raises:
        BadInput: too few samples.
    """
    if len(samples) < LEAST:
        raise BadInput(f"{len(samples)} pairs: at least {LEAST} are needed; take more sequences")


def accuracy(table: LearnedTable, samples: Sequence[PairSample]) -> float:
    """Return the share of right answers [%] among pairs and their mirror images; no answer counts half."""
    features, is_front = mirror(samples)
    return share_right(LearnedOrder.build(table).lead(features), is_front)


def share_right(lead: Features, is_front: NDArray[np.bool_]) -> float:
    """Return the share of right answers [%]; no answer counts half, NaN without any question."""
    if len(lead) == 0:
        return float("nan")
    right = np.where(is_front, lead, -lead)
    return float(100 * ((right > 0) + 0.5 * (right == 0)).mean())


@dataclass(frozen=True, slots=True)
class PairTask:
    """Run a tracker through a scenario, and keep what it measured of people who overlap."""

    scenario: str
    seed: int
    tracker: str
    config: TrackerConfig
    size: int = 1

    @property
    def name(self) -> str:
        """Tracker and run."""
        return f"{self.tracker} {self.scenario}-{self.seed}"

    def __call__(self, tell: Tell) -> dict[str, Any]:  # noqa: ARG002
        """Collect the samples."""
        return {"pairs": plain_pairs(collect_pairs(self.scenario, self.seed, self.config))}


def plain_pairs(samples: Iterable[PairSample]) -> list[list[object]]:
    """Turn the samples of a run into plain data; its scenario and seed are left out."""
    return [[s.frame, s.one, s.other, bool(s.is_front), *s.features.tolist()] for s in samples]


def parse_pairs(scenario: str, seed: int, pairs: Sequence[Sequence[Any]]) -> list[PairSample]:
    """Make samples out of plain data again, equal to the last digit."""
    return [
        PairSample(
            scenario=scenario,
            seed=seed,
            frame=frame,
            one=one,
            other=other,
            is_front=is_front,
            features=np.array(features),
        )
        for frame, one, other, is_front, *features in pairs
    ]


_COLUMNS = ("scenario", "seed", "frame", "one", "other", *FEATURES, "is_front")


def write_pairs(path: Path, samples: Sequence[PairSample]) -> None:
    """Write samples as a CSV table, so that training can be repeated without a run."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(_COLUMNS)
        for s in samples:
            numbers = [f"{value:.6g}" for value in s.features]
            writer.writerow([s.scenario, s.seed, s.frame, s.one, s.other, *numbers, int(s.is_front)])


def read_pairs(path: Path) -> list[PairSample]:
    """Read such a table.

    Raises:
        BadInput: a file that is missing or is no such table.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            return [_parse_row(row) for row in csv.DictReader(file)]
    except OSError as error:
        raise BadInput(f"{path}: cannot be read: {error.strerror}") from None
    except (KeyError, ValueError, TypeError) as error:
        raise BadInput(f"{path}: must be a table of {', '.join(_COLUMNS)}; {error!r}") from None


def _parse_row(row: dict[str, str]) -> PairSample:
    features = [float(row[name]) for name in FEATURES]
    if not np.isfinite(features).all():
        raise ValueError(f"features must be finite, got {features}")
    plain = [int(row["frame"]), row["one"], row["other"], bool(int(row["is_front"])), *features]
    return parse_pairs(row["scenario"], int(row["seed"]), [plain])[0]
