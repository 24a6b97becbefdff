"""Learn the order from examples. The only file that needs scikit-learn; a running tracker does without."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.contour.occlusion.learned_table import LearnedTable, WeakClassifier
from peopleboy.tracker.contour.occlusion.pair_features import FEATURES, Features
from peopleboy.tracker.contour.occlusion.weak_classifiers import SortedSums, Stump, best_stump, weighted_sums

try:
    from sklearn.base import BaseEstimator, ClassifierMixin
    from sklearn.ensemble import AdaBoostClassifier
except ImportError:
    raise BadInput("learning the order needs scikit-learn: pip install scikit-learn") from None


class WeakLearner(ClassifierMixin, BaseEstimator):  # type: ignore[misc]
    """Picks the best weak classifier there is; scikit-learn's AdaBoostClassifier asks it once a round.

    All rounds share the weights and the sorted sums, which do not depend on the examples' weights.
    """

    def __init__(self, weights: Features) -> None:
        self.weights = weights
        self._sorted: dict[int, tuple[Features, SortedSums]] = {}

    def __sklearn_clone__(self) -> WeakLearner:
        copy = WeakLearner(self.weights)
        copy._sorted = self._sorted
        return copy

    def fit(
        self, examples: Features, labels: NDArray[np.int64], sample_weight: NDArray[np.float64]
    ) -> WeakLearner:
        """Choose a stump for examples (N, features) with labels 0 or 1 that count as much as their weight."""
        self.classes_ = np.array([0, 1])
        self.stump_: Stump = best_stump(self._sums_of(examples), labels > 0, sample_weight)
        return self

    def predict(self, examples: Features) -> NDArray[np.int64]:
        """Say 0 or 1 for each example."""
        stump = self.stump_
        is_front = stump.parity * (examples @ self.weights[stump.row]) < stump.parity * stump.threshold
        return np.asarray(is_front, np.int64)

    def _sums_of(self, examples: Features) -> SortedSums:
        # The examples are kept beside their sums: an id is only unique as long as its object lives.
        if id(examples) not in self._sorted:
            self._sorted.clear()
            self._sorted[id(examples)] = (examples, SortedSums.build(examples, self.weights))
        return self._sorted[id(examples)][1]


def train(
    features: Features,
    is_front: NDArray[np.bool_],
    *,
    most: int = 2,
    rounds: int = 40,
    uses: tuple[str, ...] = FEATURES,
) -> LearnedTable:
    """Boost weak classifiers on pairs of people.

    Args:
        features: (N, 6) of pairs.
        is_front: (N,) whether the one is in front of the other.
        most: how many features a weak classifier may add up.
        rounds: how many weak classifiers to choose.
        uses: names of the features to learn from.

    Raises:
        BadInput: examples in which all these features are 0.

    Source: thesis, algorithm 5, with scikit-learn's AdaBoostClassifier (SAMME, which for two classes is the
    same).
    """
    columns = [FEATURES.index(name) for name in uses]
    scale = np.maximum(features.std(axis=0), 1e-6)
    if not (features[:, columns] != 0).any():
        raise BadInput(f"the examples' {', '.join(uses)} are all 0: that tells nothing")
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
