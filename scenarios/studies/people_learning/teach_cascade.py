"""Teaching boosted trees, and setting when a window is let go."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.tracker.proposals.cascade import DEPTH, LEAVES, NODES, Cascade

_FEATURES_A_NODE: Final = 40  # drawn at random; of all it would take 45 times as long
_SHARE_A_TREE: Final = 0.5  # of the windows
_SMALLEST_LEAF: Final = 20  # windows
_WEAKEST: Final = 0.03  # of people, whom no tree needs to keep
_LET_GO: Final = 0.005  # of all others may be let go
_STRICTER: Final = np.float32(0.7)  # than that, as most who are let go by it are hardly sure in the end
_AFTER: Final = np.float32(32.0)  # trees: the first ones tell people from others by less
_LAST: Final = -4.0
"""Score below which nothing is told."""


class Boosting(NamedTuple):
    """How much is learned: how many trees, and how much of what each says is believed."""

    trees: int
    rate: float


def teach_cascade(people: NDArray[np.float16], others: NDArray[np.float16], boosting: Boosting) -> Cascade:
    """Teach trees on windows (N, 1800) with people and without; both together weigh the same.

    Raises:
        BadInput: scikit-learn is missing, or there are too few windows.
    """
    try:
        # Here, as it comes with the package's extra `train`.
        from sklearn.ensemble import GradientBoostingClassifier
    except ImportError as error:
        raise BadInput("train-detector needs scikit-learn: pip install scikit-learn") from error
    if min(len(people), len(others)) < _SMALLEST_LEAF:
        raise BadInput(f"{len(people)} windows with people and {len(others)} without; take more worlds")
    windows = np.concatenate([people, others]).astype(np.float32)
    is_person = np.arange(len(windows)) < len(people)
    weight = np.where(is_person, 1.0 / len(people), 1.0 / len(others)) * len(windows) / 2.0
    trees = GradientBoostingClassifier(
        n_estimators=boosting.trees, learning_rate=boosting.rate, max_depth=DEPTH,
        max_features=_FEATURES_A_NODE, subsample=_SHARE_A_TREE, min_samples_leaf=_SMALLEST_LEAF,
        random_state=0,
    ).fit(windows, is_person, sample_weight=weight)  # fmt: skip
    tables = as_tables([tree.tree_ for tree in trees.estimators_[:, 0]], boosting.rate)
    return _letting_go(Cascade(*tables, np.full(boosting.trees, -np.inf, np.float32)), windows[: len(people)])


def as_tables(
    trees: list[Any], rate: float
) -> tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.float32]]:
    """Write scikit-learn's trees as tables; those that end early go on with both ways alike.

    Returns:
        Feature (T, 7), threshold (T, 7) and leaf (T, 8) as a `Cascade` has them.
    """
    feature = np.zeros((len(trees), NODES), np.int32)
    threshold = np.full((len(trees), NODES), np.inf, np.float32)
    leaf = np.zeros((len(trees), LEAVES), np.float32)

    def put(number: int, tree: Any, node: int, place: int) -> None:
        if place >= NODES:
            leaf[number, place - NODES] = rate * tree.value[node, 0, 0]
            return
        ways = (node, node)
        if tree.children_left[node] >= 0:
            feature[number, place], threshold[number, place] = tree.feature[node], tree.threshold[node]
            ways = (tree.children_left[node], tree.children_right[node])
        put(number, tree, ways[0], 2 * place + 1)
        put(number, tree, ways[1], 2 * place + 2)

    for number, tree in enumerate(trees):
        put(number, tree, 0, 0)
    return feature, threshold, leaf


def _letting_go(cascade: Cascade, people: NDArray[np.float32]) -> Cascade:
    """Set after each tree what nearly all people have, who end up well."""
    running = cascade.running(people)
    is_found = running[:, -1] > np.quantile(running[:, -1], _WEAKEST)
    least = np.quantile(running[is_found], _LET_GO, axis=0).astype(np.float32)
    least += _STRICTER * np.minimum(np.arange(len(least), dtype=np.float32) / _AFTER, 1.0)
    least[-1] = _LAST
    return Cascade(cascade.feature, cascade.threshold, cascade.leaf, least)
