"""Train which of two overlapping people is in front: AdaBoost on sums of features (thesis, chapter 7)."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from rich.console import Console

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.occlusion_pairs import PairSamples, collect_pairs
from peopleboy.studies.training.samples import (
    SampleTask,
    Split,
    Tasks,
    load_samples,
    sample_folder,
)
from peopleboy.studies.training.specification import Specification
from peopleboy.studies.training.weak_classifiers import (
    SortedSums,
    best_stump,
    weighted_sums,
)
from peopleboy.tracker.reproductions.contour.contour_config import TrackerConfig
from peopleboy.tracker.reproductions.contour.occlusion.learned_order import LearnedOrder
from peopleboy.tracker.reproductions.contour.occlusion.learned_table import (
    TABLES,
    LearnedTable,
    WeakClassifier,
)
from peopleboy.tracker.reproductions.contour.occlusion.pair_features import (
    FEATURES,
    Features,
)
from peopleboy.tracker.reproductions.contour.variants import CONTOUR, THESIS_OCCLUSION

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
"""Scenarios in which people occlude each other, from which samples are collected."""

LEAST = 20
"""Least number of pairs for training."""


def accuracy(table: LearnedTable, samples: PairSamples) -> float:
    """Return the accuracy [%] on pairs and swapped pairs; an undecided answer counts half."""
    features, is_front = samples.mirror()
    return share_right(LearnedOrder.build(table).lead(features), is_front)


def share_right(lead: Features, is_front: NDArray[np.bool_]) -> float:
    """Return the accuracy [%]; an undecided answer counts half; NaN without samples."""
    if len(lead) == 0:
        return float("nan")
    right = np.where(is_front, lead, -lead)
    return float(100 * ((right > 0) + 0.5 * (right == 0)).mean())


TRACKERS: dict[str, TrackerConfig] = {"contour": CONTOUR, "thesis": THESIS_OCCLUSION}
"""The trackers that order people by a learned classifier, by name."""

ROUNDS = 40


@dataclass(frozen=True, slots=True, kw_only=True)
class OcclusionTraining(Specification[PairSamples]):
    """The contour trackers use this classifier.

    The training data are pairs of overlapping people in scenarios, with features that a tracker measures. The
    shipped classifier is trained on all pairs. For evaluation, cross-validation trains without one scenario
    at a time, and tests on that scenario.
    """

    SHIPPED_IN: ClassVar[Path] = TABLES
    HINT: ClassVar[str] = "`peopleboy reproduce 7.1 7.2 7.3 7.4` evaluates it in the thesis's experiments"

    sequences: Annotated[
        int,
        Field(
            ge=1, le=100_000, alias="seeds", description="Number of seeds; each scenario runs once per seed."
        ),
    ] = 5
    tracker: Annotated[
        Literal["contour", "thesis"], Field(description="Tracker that the classifier is for.")
    ] = "contour"

    def default_folder(self, model: str) -> Path:
        """Return a separate folder for each tracker, since their features differ."""
        return Path("runs") / f"{model}-{self.tracker}"

    def tasks(self, out: Path) -> Tasks:
        """Run the tracker through the scenarios."""
        folder, config = sample_folder(out, Path(__file__)), TRACKERS[self.tracker]
        runs = [(name, seed) for seed in range(self.sequences) for name in SCENARIOS]
        return Split(
            [
                SampleTask(folder / f"{name}_{seed}.npz", collect_pairs, (name, seed, config))
                for name, seed in runs
            ],
            [],
        )

    def load(self, tasks: Tasks) -> PairSamples:
        """Read the pairs of all runs."""
        return load_samples(PairSamples, tasks.training)

    def fit(self, data: PairSamples) -> Mapping[str, LearnedTable]:
        """Train the classifier by AdaBoost."""
        if len(data) < LEAST:
            raise BadInput(f"{len(data)} pairs: at least {LEAST} are needed; use more sequences")
        with Console(stderr=True).status("training"):
            table = boost(*data.mirror())
        listed = ", ".join(f"{name} {count}" for name, count in Counter(data.scenario.tolist()).items())
        about = {
            "trained on": f"{len(data)} pairs and the swapped pairs: {listed}",
            "weak classifiers": "weighted pairs of the six features (thesis, equation 7.4)",
        }
        return {f"{self.tracker}.yaml": replace(table, about=about)}

    def evaluate(self, model: LearnedTable, data: PairSamples) -> Mapping[str, str]:
        """Measure the accuracy on the training samples, and by cross-validation."""
        return {
            "training accuracy": f"{accuracy(model, data):.1f} %",
            "accuracy on each scenario, trained on the others": f"{cross_accuracy(data):.1f} %",
        }


def cross_accuracy(samples: PairSamples, rounds: int = ROUNDS) -> float:
    """Return the accuracy [%] of a cross-validation that leaves out one scenario at a time."""
    right = 0.0
    for name, count in Counter(samples.scenario.tolist()).items():
        is_left_out = samples.scenario == name
        if is_left_out.all():
            return float("nan")
        table = boost(*samples.take(~is_left_out).mirror(), rounds=rounds)
        right += count * accuracy(table, samples.take(is_left_out))
    return right / len(samples)


def boost(
    features: Features,
    is_front: NDArray[np.bool_],
    *,
    most: int = 2,
    rounds: int = ROUNDS,
    uses: tuple[str, ...] = FEATURES,
) -> LearnedTable:
    """Boost weak classifiers on pairs of people.

    Args:
        features: (N, 6) features of the pairs.
        is_front: (N,) whether the first person is in front.
        most: largest number of features that a weak classifier sums.
        rounds: number of weak classifiers.
        uses: names of the features to use.

    Raises:
        BadInput: all these features are 0 in all samples.

    Source: thesis, algorithm 5.
    """
    columns = [FEATURES.index(name) for name in uses]
    scale = np.maximum(features.std(axis=0), 1e-6)
    if not (features[:, columns] != 0).any():
        raise BadInput(f"{', '.join(uses)} are 0 in all samples: there is nothing to train on")
    weights, samples = weighted_sums(len(columns), most), (features / scale)[:, columns]
    sums, counts = SortedSums.build(samples, weights), np.full(len(samples), 1.0 / len(samples))
    chosen: list[WeakClassifier] = []
    for _ in range(rounds):
        counts = np.maximum(counts, np.finfo(np.float64).eps)  # a weight of 0 would remain 0
        stump = best_stump(sums, is_front, counts)
        answer = stump.parity * (samples @ weights[stump.row]) < stump.parity * stump.threshold
        error = float(np.average(answer != is_front, weights=counts))
        if error >= 0.5:
            break
        importance = float(np.log((1.0 - error) / error)) if error > 0.0 else 1.0
        chosen.append(
            WeakClassifier(
                weights={name: float(w) for name, w in zip(uses, weights[stump.row], strict=True) if w},
                threshold=stump.threshold,
                parity=stump.parity,
                importance=importance,
            )
        )
        if error <= 0.0:
            break
        counts = np.exp(np.log(counts) + importance * (answer != is_front))
        counts /= counts.sum()
    named_scale = dict(zip(FEATURES, scale.tolist(), strict=True))
    return LearnedTable(scale=named_scale, classifiers=tuple(chosen))
