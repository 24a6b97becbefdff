"""Experiments on classifying which of two people is in front: the thesis's tables 7.1 to 7.4."""

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
    accuracy,
    boost,
)
from peopleboy.studies.training.occlusion_pairs import PairSamples, collect_pairs
from peopleboy.studies.training.samples import Split
from peopleboy.studies.training.weak_classifiers import weighted_sums
from peopleboy.tracker.reproductions.contour.occlusion.learned_table import LearnedTable
from peopleboy.tracker.reproductions.contour.occlusion.pair_features import FEATURES

CLASSIFIERS, PAIRS = "weak classifiers", "pairs"
THESIS_PAIRS: Final = 121
"""Number of pairs in the thesis; with their mirror images, 242 samples."""
SCENES: Final = (
    *SCENARIOS,
    "dark_crossing",
    "crowd_8",
    "turn_while_hidden",
    "hidden_2s_moving",
    "hall_visits",
    "corridor_patrol",
)
"""Sources of the samples: scenarios of the shipped tables, harder ones, and runs of data sets 3 and 4."""
TESTS: Final = ("held out", "unseen scenarios", "feet cut off")
"""Tests of a classifier: on pairs held out at random, on pairs of other scenarios, and on pairs held out at
random in which the camera is tilted up, so that it sees no feet of people nearer than 11 m."""
_TILT_RAD: Final = math.radians(16.0)
TRACKERS: Final = {"literal": TrackerSetting("thesis-occlusion"), "default": TrackerSetting("contour")}
"""Trackers that measure the samples; the thesis has no test on scenes outside its training set."""


@dataclass(frozen=True, slots=True)
class Classifiers:
    """How weak classifiers are built.

    Attributes:
        features: names of the features.
        most: maximum number of features in a sum.
    """

    features: Sequence[str] = FEATURES
    most: int = 2


def learning(using: Measurement, *, groups: Mapping[str, Mapping[str, Any] | None]) -> Samples:
    """Compare kinds of weak classifiers by the share of correct answers, split by split.

    Args:
        using: the plan and stored results.
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
    """Return the weights of the classifiers chosen first, of the first split; NaN for unused features."""
    _, learned = _learned(using, {"both": Classifiers()})
    return {
        Line(str(place), tracker): {name: np.array([weights.get(name, np.nan)]) for name in FEATURES}
        for (_, tracker), (first, *_) in learned.items()
        for place, weights in enumerate(first["best"], 1)
    }


def _learned(
    using: Measurement, ways: Mapping[str, Classifiers]
) -> tuple[dict[str, int], dict[tuple[str, str], list[Result]]]:
    """Collect samples and train: return their number by tracker, and the splits of each kind."""
    plan = using.plan
    collected = using.grouped(
        {
            (tracker, tilt_rad): [
                pairs_unit(scenario, seed, setting, plan.label_noise_px, tilt_rad)
                for seed in range(plan.pair_seeds)
                for scenario in SCENES
            ]
            for tracker, setting in TRACKERS.items()
            for tilt_rad in (0.0, _TILT_RAD)
        }
    )
    pairs = {
        key: PairSamples.join([PairSamples.from_plain(result) for result in results])
        for key, results in collected.items()
    }
    examples = {tracker: (pairs[tracker, 0.0], pairs[tracker, _TILT_RAD]) for tracker in TRACKERS}
    units = {
        (name, tracker): [
            learn_unit(way, plan, examples[tracker], tracker, split) for split in range(plan.splits)
        ]
        for name, way in ways.items()
        for tracker in TRACKERS
    }
    return {tracker: len(found) for tracker, (found, _) in examples.items()}, using.grouped(units)


def pairs_unit(
    scenario: str, seed: int, setting: TrackerSetting, label_noise_px: float, tilt_rad: float
) -> Unit:
    """Return the unit that collects the pairs of one run."""
    return Unit.of(measure_pairs, scenario, seed, setting, label_noise_px, tilt_rad)


def learn_unit(
    way: Classifiers, plan: Plan, examples: tuple[PairSamples, PairSamples], tracker: str, split: int
) -> Unit:
    """Return the unit that trains on one split of a tracker's samples."""
    labels = f", labels {plan.label_noise_px:g} px" if plan.label_noise_px else ""
    count = " and ".join(str(len(part)) for part in examples)
    key = (
        f"learn {','.join(way.features)} by {way.most} | {count} pairs of {TRACKERS[tracker].key}, "
        f"{plan.rounds} rounds{labels} | {split}"
    )
    return Unit(key, learn_pairs, (tuple(way.features), way.most, plan.rounds, split, *examples))


def measure_pairs(
    scenario: str, seed: int, setting: TrackerSetting, label_noise_px: float, tilt_rad: float
) -> Result:
    """Run a tracker on a scenario, and return its measurements of people who overlap."""
    return collect_pairs(scenario, seed, setting.config(), label_noise_px, tilt_rad).to_plain()


def learn_pairs(
    features: tuple[str, ...],
    most: int,
    rounds: int,
    split: int,
    examples: PairSamples,
    without_feet: PairSamples,
) -> Result:
    """Train on samples that are split at random, and by scenario, and test on the rest.

    Features that are 0 in all training samples have no information: half of all answers are correct then.

    Source: thesis, section 7.4.

    Args:
        features: names of the features.
        most: maximum number of features in a weak classifier.
        rounds: rounds of boosting; a single feature is one weak classifier, which boosting cannot improve.
        split: number of the split, from 0.
        examples: samples to split.
        without_feet: samples to split, of people whose feet are outside the image.

    Returns:
        The share of correct answers [%] by the names of `TESTS`, and the weights of the "best" classifiers,
        which are trained on the random split.
    """
    rng = stream(split, "occlusion.split")
    result: Result = {"best": []}
    parts_of = {
        "held out": (random_split, examples),
        "unseen scenarios": (split_by_scenario, examples),
        "feet cut off": (random_split, without_feet),
    }
    for test, (split_samples, samples) in parts_of.items():
        if len(samples) < LEAST:
            result[test] = math.nan
            continue
        parts = split_samples(samples, rng)
        table = LearnedTable(scale=dict.fromkeys(FEATURES, 1.0), classifiers=())
        measured, is_front = parts.training.mirror()
        is_informative = measured[:, [FEATURES.index(name) for name in features]].any()
        if is_informative:
            rounds_of = 1 if len(features) == 1 else rounds
            table = boost(measured, is_front, most=most, uses=features, rounds=rounds_of)
        result[test] = accuracy(table, parts.validation) if is_informative else 50.0
        if test == TESTS[0]:
            result["best"] = [weak.weights for weak in table.classifiers[:10]]
    return result


def random_split(examples: PairSamples, rng: np.random.Generator) -> Split[PairSamples]:
    """Return a random split: as many pairs as in the thesis, 60 % of them for training.

    The same occlusion may be in training and test.

    Source: thesis, section 7.4.
    """
    rows = rng.permutation(len(examples))[:THESIS_PAIRS]
    cut = round(TRAINING_SHARE * len(rows))
    return Split(examples.take(rows[:cut]), examples.take(rows[cut:]))


def split_by_scenario(examples: PairSamples, rng: np.random.Generator) -> Split[PairSamples]:
    """Split by scenario: random scenarios with 60 % of the pairs are for training, the rest for the test.

    At least one scenario is kept for the test, unless there is only one.
    """
    names = np.unique(examples.scenario)
    is_learned = np.zeros(len(examples), np.bool_)
    for row in rng.permutation(len(names))[: max(1, len(names) - 1)]:
        if is_learned.sum() >= TRAINING_SHARE * len(examples):
            break
        is_learned |= examples.scenario == names[row]
    return Split(examples.take(is_learned), examples.take(~is_learned))
