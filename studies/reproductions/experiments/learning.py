"""Experiments on learning which of two people is in front: the thesis's tables 7.1 to 7.4."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from peopleboy.random_streams import stream
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.experiment import Line, Samples
from peopleboy.studies.reproductions.plan import Plan
from peopleboy.studies.reproductions.statistics import SHARE, TRAINING_SHARE
from peopleboy.studies.reproductions.tracker_settings import TrackerSetting
from peopleboy.studies.reproductions.units import Measurement, Unit
from peopleboy.studies.training.occlusion import (
    LEAST,
    SCENARIOS,
    PairSamples,
    accuracy,
    boost,
    collect_pairs,
)
from peopleboy.studies.training.samples import Split
from peopleboy.tracker.contour.occlusion.learned_table import LearnedTable
from peopleboy.tracker.contour.occlusion.pair_features import FEATURES
from peopleboy.tracker.contour.occlusion.weak_classifiers import weighted_sums

CLASSIFIERS, PAIRS = "weak classifiers", "pairs"
THESIS_PAIRS: Final = 121
"""How many pairs the thesis has; with their mirror images, 242 examples."""
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
    collected = using.grouped(
        {
            tracker: [
                Unit.of(measure_pairs, scenario, seed, setting)
                for seed in range(plan.pair_seeds)
                for scenario in SCENES
            ]
            for tracker, setting in TRACKERS.items()
        }
    )
    examples = {
        tracker: PairSamples.join([PairSamples.from_plain(result) for result in results])
        for tracker, results in collected.items()
    }
    units = {
        (name, tracker): [
            learn_unit(way, plan, examples[tracker], tracker, split) for split in range(plan.splits)
        ]
        for name, way in ways.items()
        for tracker in TRACKERS
    }
    return {tracker: len(found) for tracker, found in examples.items()}, using.grouped(units)


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

    Features that are 0 in all examples to learn from tell nothing: half of all answers are right then.

    Source: thesis, section 7.4.

    Args:
        features: names of those that are used.
        most: how many of them a weak classifier may add up.
        rounds: of boosting; a single feature is one weak classifier, and boosting has nothing to add to it.
        split: number of the splits, from 0.
        examples: to split.

    Returns:
        The share of right answers [%] by the names of `TESTS`, and the weights of the "best" classifiers,
        which are learned from the random split.
    """
    if len(examples) < LEAST:
        return dict.fromkeys(TESTS, math.nan) | {"best": []}
    rng = stream(split, "occlusion.split")
    result: Result = {}
    splits = random_split(examples, rng), split_by_scenario(examples, rng)
    for test, parts in zip(TESTS, splits, strict=True):
        table = LearnedTable(scale=dict.fromkeys(FEATURES, 1.0), classifiers=())
        measured, is_front = parts.training.mirror()
        is_informative = measured[:, [FEATURES.index(name) for name in features]].any()
        if is_informative:
            rounds_of = 1 if len(features) == 1 else rounds
            table = boost(measured, is_front, most=most, uses=features, rounds=rounds_of)
        result[test] = accuracy(table, parts.validation) if is_informative else 50.0
        result.setdefault("best", [weak.weights for weak in table.classifiers[:10]])
    return result


def random_split(examples: PairSamples, rng: np.random.Generator) -> Split[PairSamples]:
    """Draw as many pairs as the thesis has, and learn from 60 % of them.

    The same occlusion may be on both sides.

    Source: thesis, section 7.4.
    """
    rows = rng.permutation(len(examples))[:THESIS_PAIRS]
    cut = round(TRAINING_SHARE * len(rows))
    return Split(examples.take(rows[:cut]), examples.take(rows[cut:]))


def split_by_scenario(examples: PairSamples, rng: np.random.Generator) -> Split[PairSamples]:
    """Draw scenarios until they have 60 % of the pairs, learn from these, and test with the others.

    One is left to test with, unless there is but one, even if the others have less.
    """
    names = np.unique(examples.scenario)
    is_learned = np.zeros(len(examples), np.bool_)
    for row in rng.permutation(len(names))[: max(1, len(names) - 1)]:
        if is_learned.sum() >= TRAINING_SHARE * len(examples):
            break
        is_learned |= examples.scenario == names[row]
    return Split(examples.take(is_learned), examples.take(~is_learned))
