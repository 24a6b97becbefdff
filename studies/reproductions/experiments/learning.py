"""Experiments on learning which of two people is in front: the thesis's tables 7.1 to 7.4."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.sim.random_streams import stream
from peopleboy.studies.reproductions.experiment import Line, Samples
from peopleboy.studies.reproductions.occlusion_splits import learn_split
from peopleboy.studies.reproductions.plan import Plan
from peopleboy.studies.reproductions.statistics import SHARE
from peopleboy.studies.reproductions.tracker_settings import TrackerSetting
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.studies.training.occlusion_pairs import LEAST, SCENARIOS, PairSamples, collect_pairs
from peopleboy.tracker.contour.occlusion.pair_features import FEATURES
from peopleboy.tracker.contour.occlusion.weak_classifiers import weighted_sums

CLASSIFIERS, PAIRS = "weak classifiers", "pairs"
SCENES: Final = (
    *SCENARIOS,
    "dark_crossing",
    "crowd_8",
    "turn_while_hidden",
    "hidden_2s_moving",
    "hall_visits",
    "corridor_patrol",
)
"""Where examples come from: those of the shipped tables, harder ones, and the runs of data sets 3 and 4."""
TESTS: Final = ("held out", "unseen scenarios")
TRACKERS: Final = {"literal": TrackerSetting("thesis-occlusion"), "default": TrackerSetting("contour")}
"""Who measures the examples; the thesis does not test on other scenes than those it learned from."""


@dataclass(frozen=True, slots=True)
class Classifiers:
    """How weak classifiers are built.

    Attributes:
        features: names of those that they use.
        most: how many of them are added up.
    """

    features: Sequence[str] = FEATURES
    most: int = 2


def learning(using: Measurement, *, groups: Mapping[str, Mapping[str, Any] | None]) -> Samples:
    """Compare ways to build weak classifiers by the share of right answers, split by split.

    Args:
        using: how much is measured, and what is there.
        groups: fields of `Classifiers` by name.
    """
    most = 3 if using.plan.triplets else 2
    ways = {name: Classifiers(**(fields or {})) for name, fields in groups.items()}
    pairs, learned = _learned(using, {name: way for name, way in ways.items() if way.most <= most})
    return {
        Line(name, f"{tracker}, {test}"): {
            CLASSIFIERS: np.array([float(len(weighted_sums(len(ways[name].features), ways[name].most)))]),
            PAIRS: np.array([float(pairs[tracker])]),
            SHARE: np.array([split[test] for split in splits]),
        }
        for (name, tracker), splits in learned.items()
        for test in TESTS
    }


def best_classifiers(using: Measurement) -> Samples:
    """List the weights of those chosen first, of the first split; NaN for features that one does not use."""
    _, learned = _learned(using, {"both": Classifiers()})
    return {
        Line(str(place), tracker): {name: np.array([weights.get(name, np.nan)]) for name in FEATURES}
        for (_, tracker), (first, *_) in learned.items()
        for place, weights in enumerate(first["best"], 1)
    }


def _learned(
    using: Measurement, ways: Mapping[str, Classifiers]
) -> tuple[dict[str, int], dict[tuple[str, str], list[Result]]]:
    """Collect the examples, then learn from them: their number by tracker, and each way's splits."""
    plan = using.plan
    collected = {name: _pair_units(plan, setting) for name, setting in TRACKERS.items()}
    examples = {
        name: PairSamples.join([PairSamples.from_plain(result) for result in results])
        for name, results in using.grouped(collected).items()
    }
    units = {
        (name, tracker): [
            learn_unit(way, plan, examples[tracker], tracker, split) for split in range(plan.splits)
        ]
        for name, way in ways.items()
        for tracker in TRACKERS
    }
    return {tracker: len(found) for tracker, found in examples.items()}, using.grouped(units)


def _pair_units(plan: Plan, setting: TrackerSetting) -> list[Unit]:
    """List the runs in which a tracker measures people who overlap."""
    return [
        Unit(f"pairs {name}-{seed} | {setting.key}", measure_pairs, (name, seed, setting))
        for seed in range(plan.pair_seeds)
        for name in SCENES
    ]


def learn_unit(way: Classifiers, plan: Plan, examples: PairSamples, tracker: str, split: int) -> Unit:
    """Learn from one split of a tracker's examples."""
    key = (
        f"learn {','.join(way.features)} by {way.most} | {len(examples)} pairs of {TRACKERS[tracker].key}, "
        f"{plan.rounds} rounds | {split}"
    )
    return Unit(key, learn_pairs, (tuple(way.features), way.most, plan.rounds, split, examples))


def measure_pairs(scenario: str, seed: int, setting: TrackerSetting) -> Result:
    """Run a tracker through a scenario, and keep what it measured of people who overlap."""
    return collect_pairs(scenario, seed, setting.config()).to_plain()


def learn_pairs(
    features: tuple[str, ...], most: int, rounds: int, split: int, examples: PairSamples
) -> Result:
    """Learn from examples that are split at random, and scenario by scenario, and test on the rest.

    Source: thesis, section 7.4.

    Args:
        features: names of those that are used.
        most: how many of them a weak classifier may add up.
        rounds: of boosting.
        split: number of the splits, from 0.
        examples: to split.
    """
    if len(examples) < LEAST:
        return {"held out": math.nan, "unseen scenarios": math.nan, "best": []}
    found = learn_split(examples, features, most, rounds, stream(split, "occlusion.split"))
    return {
        "held out": found.held_out,
        "unseen scenarios": found.unseen,
        "best": [weak.weights for weak in found.table.classifiers[:10]],
    }
