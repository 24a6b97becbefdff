"""Samples of overlapping people: features that a tracker measures, and which person is in front."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.random_streams import stream
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.truth.truth import PersonTruth
from peopleboy.sim.world_config import WorldConfig
from peopleboy.studies.training.samples import Arrays
from peopleboy.tracker.boxes import add_edge_noise, iou
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.reproductions.contour.contour_config import TrackerConfig
from peopleboy.tracker.reproductions.contour.contour_tracker import ContourTracker
from peopleboy.tracker.reproductions.contour.occlusion.depth_order import (
    ExpectedPerson,
    Leads,
    Order,
    lower_foot,
)
from peopleboy.tracker.reproductions.contour.occlusion.learned_order import features_of
from peopleboy.tracker.reproductions.contour.occlusion.pair_features import (
    FEATURES,
    Features,
    overlapping_pairs,
)
from peopleboy.tracker.reproductions.contour.particle_filter import FrameView

# A track matches the true person whose box it overlaps most, by at least this IoU (thesis, section 3.4).
_LEAST_IOU = 0.5
# Visible share below which a person counts as totally occluded. It is higher than in the event log, since
# appearance cannot be measured on so small a part of a person.
_TOTAL = 0.15
# Neither person is in front if one occludes less than this share of the other and their distances differ by
# less than this.
_LEAST_HIDDEN, _LEAST_GAP_M = 0.02, 0.3
# Frames between two samples of one occlusion, and gap in frames after which it counts as a new one.
_EVERY, _PAUSE = 2, 15


PairRow = tuple[int, str, str, Features, bool]
"""Frame, names of the first and the second person, features, and whether the first is in front."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PairSamples(Arrays):
    """N pairs of overlapping people.

    Attributes:
        scenario, seed, frame: (N,) origin of the pair.
        one, other: (N,) names of the two people.
        features: (N, 6) features of `one` minus those of `other`.
        is_front: (N,) whether `one` is in front.
    """

    scenario: NDArray[np.str_]
    seed: NDArray[np.int64]
    frame: NDArray[np.int64]
    one: NDArray[np.str_]
    other: NDArray[np.str_]
    features: Features
    is_front: NDArray[np.bool_]

    @classmethod
    def from_rows(cls, scenario: str, seed: int, rows: Sequence[PairRow]) -> "PairSamples":
        """Build samples from the pairs of a run."""
        frame, one, other, features, is_front = zip(*rows, strict=True) if rows else [()] * 5
        return cls(
            scenario=np.full(len(rows), scenario),
            seed=np.full(len(rows), seed),
            frame=np.array(frame, np.int64),
            one=np.array(one, np.str_),
            other=np.array(other, np.str_),
            features=np.array(features, np.float64).reshape(-1, len(FEATURES)),
            is_front=np.array(is_front, np.bool_),
        )

    def mirror(self) -> tuple[Features, NDArray[np.bool_]]:
        """Return features (2 N, 6) and labels (2 N,) of all pairs, followed by those of the swapped pairs.

        The classes are therefore balanced (thesis, section 7.4).
        """
        labels = np.concatenate([self.is_front, ~self.is_front])
        return np.concatenate([self.features, -self.features]), labels


@dataclass(slots=True)
class RecordingOrder:
    """A depth order that delegates to another one and records its inputs.

    Attributes:
        remembers_feet: as in `pair_features`.
        order: the wrapped depth order.
        asked: recorded pairs of overlapping people with their features; cleared by the caller.
    """

    remembers_feet: bool
    order: Order = lower_foot
    asked: list[tuple[ExpectedPerson, ExpectedPerson, Features]] = field(default_factory=list)

    def __call__(self, figures: Sequence[ExpectedPerson], view: FrameView) -> Leads:
        """Return whether the first person is in front."""
        seen = [figure for figure in figures if not figure.person.is_hidden]
        if len(seen) > 1:
            pairs = overlapping_pairs(np.stack([figure.state for figure in seen]))
            features = features_of(seen, pairs, view, remembers_feet=self.remembers_feet)
            self.asked += [(seen[i], seen[j], row) for (i, j), row in zip(pairs, features, strict=True)]
        return self.order(figures, view)


@dataclass(slots=True)
class Episodes:
    """Current occlusions, by the names of the two people."""

    last_frame: dict[frozenset[str], int] = field(default_factory=dict)
    last_taken: dict[frozenset[str], int] = field(default_factory=dict)
    over: set[frozenset[str]] = field(default_factory=set)

    def takes(self, one: PersonTruth, other: PersonTruth, frame: int) -> bool:
        """Return whether to keep this sample: not in every frame, and not after a total occlusion.

        Source: thesis, section 7.4: only frames before the moment of total occlusion.
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
    """Return whether the first occludes more of the second, or is clearly nearer; None if undecided."""
    hides = other.hidden_by.get(one.name, 0.0) - one.hidden_by.get(other.name, 0.0)
    if abs(hides) >= _LEAST_HIDDEN:
        return hides > 0.0
    gap = other.distance_m - one.distance_m
    return gap > 0.0 if abs(gap) >= _LEAST_GAP_M else None


def collect_pairs(
    scenario: str, seed: int, config: TrackerConfig, label_noise_px: float = 0.0, tilt_rad: float = 0.0
) -> PairSamples:
    """Run a tracker through a scenario, and collect its features of overlapping people.

    Args:
        scenario: name of the scenario.
        seed: seed of the scenario.
        config: settings of the tracker.
        label_noise_px: [px] standard deviation of noise at the edges of ground-truth boxes, by which tracks
            match people.
        tilt_rad: [rad] by which the thermal camera is tilted up.

    Raises:
        BadInput: an unknown scenario.
    """
    from peopleboy.sim.world import (
        SimulatedWorld,  # imported late: reading existing samples does not need PyBullet
    )

    loaded = load_scenario(scenario)
    order, episodes = RecordingOrder(config.depth.remembers_feet), Episodes()
    people = ContourTracker(config, stream(seed, "tracker"), order)
    labels = stream(seed, f"labels {scenario}")
    rows: list[PairRow] = []
    with SimulatedWorld(_tilted(loaded.world(seed), tilt_rad)) as world:
        frames = round(loaded.duration_s * world.config.control_hz)
        for tick in closed_loop(world, people, loaded.make_behaviour(), frames):
            boxed = [person for person in tick.truth.people if person.box is not None]
            boxes = np.array([person.box for person in boxed], np.float64).reshape(-1, 4)
            boxes = add_edge_noise(boxes, label_noise_px, labels)
            for *pair, features in order.asked:
                one, other = (_true_person(figure, boxed, boxes) for figure in pair)
                if one is None or other is None or one is other:
                    continue
                is_front = is_in_front(one, other)
                if episodes.takes(one, other, tick.frame) and is_front is not None:
                    rows.append((tick.frame, one.name, other.name, features, is_front))
            order.asked.clear()
    return PairSamples.from_rows(loaded.name, seed, rows)


def _tilted(world: WorldConfig, tilt_rad: float) -> WorldConfig:
    """Return a world in which the thermal camera is tilted up."""
    thermal = world.robot.cameras[THERMAL]
    assert isinstance(thermal.camera, Pinhole)
    tilted = replace(thermal, camera=replace(thermal.camera, pitch_rad=thermal.camera.pitch_rad - tilt_rad))
    cameras = {**world.robot.cameras, THERMAL: tilted}
    return replace(world, robot=replace(world.robot, cameras=cameras))


def _true_person(
    figure: ExpectedPerson, people: Sequence[PersonTruth], boxes: NDArray[np.float64]
) -> PersonTruth | None:
    """Return the person whose box a track overlaps most; None if the overlap is too small."""
    if not people:
        return None
    overlap = iou(boxes, np.asarray(figure.region, np.float64))
    best = int(np.argmax(overlap))
    return people[best] if overlap[best] >= _LEAST_IOU else None
