"""Train which of two overlapping people is in front: AdaBoost on sums of features (thesis, chapter 7)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from rich.console import Console
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.ensemble import AdaBoostClassifier

from peopleboy.bad_input import BadInput
from peopleboy.studies.training import occlusion_pairs
from peopleboy.studies.training.occlusion_pairs import LEAST, SCENARIOS, PairSamples, accuracy, collect_pairs
from peopleboy.studies.training.samples import SampleTask, Split, Tasks, load_samples, sample_folder
from peopleboy.studies.training.specification import Specification
from peopleboy.tracker.contour.contour_config import TrackerConfig
from peopleboy.tracker.contour.occlusion.learned_table import TABLES, LearnedTable, WeakClassifier
from peopleboy.tracker.contour.occlusion.pair_features import FEATURES, Features
from peopleboy.tracker.contour.occlusion.weak_classifiers import SortedSums, Stump, best_stump, weighted_sums
from peopleboy.tracker.contour.variants import CONTOUR, THESIS_OCCLUSION

TRACKERS: dict[str, TrackerConfig] = {"contour": CONTOUR, "thesis": THESIS_OCCLUSION}
"""The trackers that order people by a learned table, by name."""

ROUNDS = 40


@dataclass(frozen=True, slots=True, kw_only=True)
class OcclusionTraining(Specification[PairSamples]):
    """Train on pairs of people that overlap in scenarios, as a tracker measures them.

    The table of the tracker of that name is trained on all pairs. It is evaluated on each scenario by a table
    that was trained on the others.
    """

    SHIPPED_IN: ClassVar[Path] = TABLES
    HINT: ClassVar[str] = "`peopleboy reproduce 7.1 7.2 7.3 7.4` measures it by the thesis's experiments"

    sequences: Annotated[int, Field(ge=1, description="Runs of each scenario.")] = 5
    tracker: Annotated[Literal["contour", "thesis"], Field(description="Tracker to train.")] = "contour"

    def default_folder(self, model: str) -> Path:
        """Return a folder of the tracker's own, since each measures other features."""
        return Path("runs") / f"{model}-{self.tracker}"

    def tasks(self, out: Path) -> Tasks:
        """Run the tracker through the scenarios."""
        folder, config = sample_folder(out, Path(occlusion_pairs.__file__)), TRACKERS[self.tracker]
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
        """Boost weighted pairs of features."""
        if len(data) < LEAST:
            raise BadInput(f"{len(data)} pairs: at least {LEAST} are needed; take more sequences")
        with Console(stderr=True).status("training"):
            table = boost(*data.mirror())
        listed = ", ".join(f"{name} {count}" for name, count in Counter(data.scenario.tolist()).items())
        about = {
            "trained on": f"{len(data)} pairs and their mirror images: {listed}",
            "weak classifiers": "weighted pairs of the six features (thesis, equation 7.4)",
        }
        return {f"{self.tracker}.yaml": replace(table, about=about)}

    def evaluate(self, model: LearnedTable, data: PairSamples) -> Mapping[str, str]:
        """Measure the share of right answers."""
        return {
            "right on those": f"{accuracy(model, data):.1f} %",
            "right on each scenario, trained on the others": f"{cross_accuracy(data):.1f} %",
        }


def cross_accuracy(samples: PairSamples, rounds: int = ROUNDS) -> float:
    """Leave one scenario out after the other, and return the share of right answers [%] on all of them."""
    right = 0.0
    for name, count in Counter(samples.scenario.tolist()).items():
        is_left_out = samples.scenario == name
        if is_left_out.all():
            return float("nan")
        table = boost(*samples.take(~is_left_out).mirror(), rounds=rounds)
        right += count * accuracy(table, samples.take(is_left_out))
    return right / len(samples)


class WeakLearner(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Picks the best weak classifier there is; scikit-learn's AdaBoostClassifier asks it once a round.

    All rounds share the weights and the sorted sums, which do not depend on the samples' weights.
    """

    def __init__(self, weights: Features) -> None:
        self.weights = weights
        self._sorted: dict[int, tuple[Features, SortedSums]] = {}

    def __sklearn_clone__(self) -> WeakLearner:
        copy = WeakLearner(self.weights)
        copy._sorted = self._sorted
        return copy

    def fit(
        self, samples: Features, labels: NDArray[np.int64], sample_weight: NDArray[np.float64]
    ) -> WeakLearner:
        """Choose a stump for samples (N, features) with labels 0 or 1 that count as much as their weight."""
        self.classes_ = np.array([0, 1])
        self.stump_: Stump = best_stump(self._sums_of(samples), labels > 0, sample_weight)
        return self

    def predict(self, samples: Features) -> NDArray[np.int64]:
        """Return 0 or 1 for each sample."""
        stump = self.stump_
        is_front = stump.parity * (samples @ self.weights[stump.row]) < stump.parity * stump.threshold
        return np.asarray(is_front, np.int64)

    def _sums_of(self, samples: Features) -> SortedSums:
        # The samples are kept with their sums: an id is only unique as long as its object lives.
        if id(samples) not in self._sorted:
            self._sorted.clear()
            self._sorted[id(samples)] = (samples, SortedSums.build(samples, self.weights))
        return self._sorted[id(samples)][1]


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
        features: (N, 6) of pairs.
        is_front: (N,) whether the one is in front of the other.
        most: how many features a weak classifier may add up.
        rounds: how many weak classifiers to choose.
        uses: names of the features to train on.

    Raises:
        BadInput: samples in which all these features are 0.

    Source: thesis, algorithm 5, with scikit-learn's AdaBoostClassifier (SAMME, which for two classes is the
    same).
    """
    columns = [FEATURES.index(name) for name in uses]
    scale = np.maximum(features.std(axis=0), 1e-6)
    if not (features[:, columns] != 0).any():
        raise BadInput(f"{', '.join(uses)} are 0 in all samples: there is nothing to train on")
    weights = weighted_sums(len(columns), most)
    boosted = AdaBoostClassifier(WeakLearner(weights), n_estimators=rounds)
    boosted.fit((features / scale)[:, columns], is_front.astype(np.int64))
    chosen = tuple(
        WeakClassifier(
            weights={name: float(w) for name, w in zip(uses, weights[learner.stump_.row], strict=True) if w},
            threshold=learner.stump_.threshold,
            parity=learner.stump_.parity,
            importance=float(importance),
        )
        for learner, importance in zip(boosted.estimators_, boosted.estimator_weights_, strict=False)
    )
    return LearnedTable(scale=dict(zip(FEATURES, scale.tolist(), strict=True)), classifiers=chosen)
