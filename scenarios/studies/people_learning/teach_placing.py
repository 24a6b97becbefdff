"""Teaching the trees that tell where in a window somebody is."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.studies.people_learning.teach_cascade import as_tables
from peopleboy.tracker.proposals.cascade import DEPTH
from peopleboy.tracker.proposals.placing import Placing

_TREES: Final = 80
_RATE: Final = 0.15
_FEATURES_A_NODE: Final = 80
_SHARE_A_TREE: Final = 0.6
_SMALLEST_LEAF: Final = 15


def teach_placing(windows: NDArray[np.float16], offsets: NDArray[np.float64]) -> Placing:
    """Teach trees on windows (N, 1800) whose offsets (N, 4) are known.

    Raises:
        BadInput: scikit-learn is missing.
    """
    try:
        # Here, as it comes with the package's extra `train`.
        from sklearn.ensemble import GradientBoostingRegressor
    except ImportError as error:
        raise BadInput("train-detector needs scikit-learn: pip install scikit-learn") from error
    features = windows.astype(np.float32)
    tables = []
    for number, target in enumerate(offsets.T):
        trees = GradientBoostingRegressor(
            loss="huber", n_estimators=_TREES, learning_rate=_RATE, max_depth=DEPTH, random_state=number,
            max_features=_FEATURES_A_NODE, subsample=_SHARE_A_TREE, min_samples_leaf=_SMALLEST_LEAF,
        ).fit(features, target)  # fmt: skip
        feature, threshold, leaf = as_tables([tree.tree_ for tree in trees.estimators_[:, 0]], _RATE)
        leaf[0] += np.float32(np.ravel(trees.init_.constant_)[0])
        tables.append((feature, threshold, leaf))
    return Placing(*(np.stack(column) for column in zip(*tables, strict=True)))
