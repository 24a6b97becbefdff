"""Teaching linear support vector machines, and judging them."""

from __future__ import annotations

import warnings
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.window_learning.window_examples import WindowExamples
from peopleboy.tracker.rgbd.verification.window_model import WindowModel, feature_length
from peopleboy.tracker.rgbd.verification.windows import Features, Range

COST: Final = {Range.FAR: 0.01, Range.NEAR: 0.01}
FALSE_ALARMS: Final = 0.01
"""Share of windows without people at which the share of people found is told."""


def teach_windows(examples: WindowExamples, *, sees_depth: bool) -> WindowModel:
    """Teach a machine for either range, by colour alone or with depth.

    Raises:
        BadInput: scikit-learn is missing, or there are no people or nothing else in one range.
    """
    return WindowModel({kind: _taught(examples, kind, sees_depth=sees_depth) for kind in Range})


def _taught(examples: WindowExamples, kind: Range, *, sees_depth: bool) -> Features:
    try:
        from sklearn.svm import LinearSVC  # here, as it comes with the package's extra `train`
    except ImportError as error:
        raise BadInput("train-windows needs scikit-learn: pip install scikit-learn") from error
    is_person = examples.is_person[kind]
    if is_person.all() or not is_person.any():
        raise BadInput(f"{kind} windows: {len(is_person)} with {is_person.sum()} people; take more scenes")
    count = (1 + sees_depth) * feature_length(kind)
    machine = LinearSVC(C=COST[kind], class_weight="balanced", random_state=0, max_iter=4000)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that it did not converge to the last digit
        machine.fit(examples.features[kind][:, :count].astype(np.float32), is_person)
    return np.concatenate([machine.coef_[0], machine.intercept_]).astype(np.float32)


def judgement(model: WindowModel, examples: WindowExamples) -> dict[str, str]:
    """Say in words, by range, how well the machines do."""
    return {str(kind): _judged(model, examples, kind) for kind in Range}


def recall_at(scores: NDArray[np.float64], is_person: NDArray[np.bool_], false_alarms: float) -> float:
    """Tell which share of people scores above all but a share of what is none."""
    limit = np.quantile(scores[~is_person], 1.0 - false_alarms)
    return float(np.mean(scores[is_person] > limit))


def scores_of(model: WindowModel, examples: WindowExamples, kind: Range) -> NDArray[np.float64]:
    """Rate all windows (N,) of a range."""
    weights = model.weights[kind]
    features = examples.features[kind][:, : len(weights) - 1].astype(np.float64)
    return np.asarray(features @ weights[:-1] + weights[-1])


def _judged(model: WindowModel, examples: WindowExamples, kind: Range) -> str:
    scores, is_person = scores_of(model, examples, kind), examples.is_person[kind]
    if is_person.all() or not is_person.any():
        return "no examples"
    return (
        f"{is_person.sum()} people, {(~is_person).sum()} others; recall "
        f"{recall_at(scores, is_person, FALSE_ALARMS):.3f} at 1 % false alarms; at 0: recall "
        f"{np.mean(scores[is_person] > 0):.3f}, false alarms {np.mean(scores[~is_person] > 0):.3f}"
    )
