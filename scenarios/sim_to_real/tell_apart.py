"""Whether a small classifier tells rendered patches from real ones: a two-sample test as one number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.scores.bootstrap import Interval, bootstrap
from peopleboy.scenarios.sim_to_real.clips import Grey
from peopleboy.scenarios.sim_to_real.measures import gradient
from peopleboy.scenarios.sim_to_real.patches import SIDE

Floats = NDArray[np.float64]

FEWEST: Final = 24
"""Patches that a side must have."""

_FOLDS: Final = 5
_REPEATS: Final = 4
_STRENGTH: Final = 0.01  # C of the logistic regression: 332 features, some hundreds of patches
_GRADIENTS: Final = np.array([0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, np.inf])


@dataclass(frozen=True, slots=True)
class Told:
    """How well patches are told apart.

    Attributes:
        auc: area under the ROC curve, 0.5 where nothing tells them apart, 1 where everything does: mean over
            folds, and the 95 % interval of that mean by the bootstrap over folds.
        folds: of each fold.
        scenes: how many rendered and real scenes there are.
        patches: how many rendered and real patches.
    """

    auc: Interval
    folds: tuple[float, ...]
    scenes: tuple[int, int]
    patches: tuple[int, int]


def features(patch: Grey) -> Floats:
    """Describe a patch (32, 32) by gradients alone: HOG (324,) and shares of eight steps of magnitude.

    Source: N. Dalal and B. Triggs, Histograms of oriented gradients for human detection, CVPR 2005: cells of
    8 x 8 pixels, blocks of 2 x 2 cells, 9 orientations.
    """
    hog = np.asarray(_HOG.compute(patch), np.float64).ravel()
    steps = np.histogram(gradient(patch), _GRADIENTS)[0] / patch.size
    return np.concatenate([hog, np.sqrt(steps)])


def tell_apart(
    rendered: Sequence[Sequence[Grey]], real: Sequence[Sequence[Grey]], seed: int, of_what: str
) -> Told:
    """Teach a logistic regression, and judge it by scenes that it has not seen.

    The scenes of both sides are dealt into folds, as many as the side with fewer scenes has, at most five,
    four times over. No scene is in training and in test at once.

    Args:
        rendered: patches of each rendered scene.
        real: patches of each real scene.
        seed: of the deals.
        of_what: what the patches are, for errors.

    Raises:
        BadInput: scikit-learn is missing, or there are too few scenes or patches.
    """
    try:
        from sklearn.linear_model import LogisticRegression
        from sklearn.metrics import roc_auc_score
        from sklearn.pipeline import make_pipeline
        from sklearn.preprocessing import StandardScaler
    except ImportError as error:
        raise BadInput("sim-to-real needs scikit-learn: pip install scikit-learn") from error
    sides = [[_table(scene) for scene in side if len(scene)] for side in (rendered, real)]
    for name, side in zip(("rendered", "real"), sides, strict=True):
        _check_enough(name, side, of_what)
    rng = np.random.default_rng([seed, 1998])
    count = min(_FOLDS, *(len(side) for side in sides))
    aucs = []
    for _ in range(_REPEATS):
        dealt = [_deal(len(side), count, rng) for side in sides]
        for fold in range(count):
            train, test = [_gather(sides, dealt, fold, kept) for kept in (False, True)]
            model: Any = make_pipeline(
                StandardScaler(), LogisticRegression(C=_STRENGTH, class_weight="balanced", max_iter=2000)
            )
            model.fit(*train)
            aucs.append(float(roc_auc_score(test[1], model.decision_function(test[0]))))
    return Told(
        auc=bootstrap(aucs, rng),
        folds=tuple(aucs),
        scenes=(len(sides[0]), len(sides[1])),
        patches=(sum(map(len, sides[0])), sum(map(len, sides[1]))),
    )


def _check_enough(name: str, side: Sequence[Floats], of_what: str) -> None:
    if len(side) < 2:
        raise BadInput(
            f"{of_what}: {len(side)} {name} scene has any; at least 2 are needed, "
            "to learn from one and judge by another"
        )
    patches = sum(map(len, side))
    if patches < FEWEST:
        raise BadInput(f"{of_what}: only {patches} {name} patches; at least {FEWEST} are needed")


def _table(scene: Sequence[Grey]) -> Floats:
    return np.array([features(patch) for patch in scene])


def _deal(scenes: int, folds: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Give every scene a fold, so that each fold has one at least."""
    return np.asarray(rng.permutation(np.arange(scenes) % folds))


def _gather(
    sides: Sequence[Sequence[Floats]], dealt: Sequence[NDArray[np.int64]], fold: int, is_test: bool
) -> tuple[Floats, NDArray[np.int64]]:
    """Put features (N, F) of a fold, or of all others, together, and whether each is real (N,)."""
    chosen = [
        np.concatenate([rows for rows, own in zip(side, folds, strict=True) if (own == fold) == is_test])
        for side, folds in zip(sides, dealt, strict=True)
    ]
    labels = np.repeat([0, 1], [len(rows) for rows in chosen])
    return np.concatenate(chosen), labels


_HOG = cv2.HOGDescriptor((SIDE, SIDE), (16, 16), (8, 8), (8, 8), 9)
