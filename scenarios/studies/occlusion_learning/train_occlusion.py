"""Learn who is in front of whom from scenarios, and compare what comes out with the thesis."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.studies.occlusion_learning.occlusion_pairs import PairExample, mirrored
from peopleboy.tracker.thermal.occlusion.learned_order import LearnedOrder
from peopleboy.tracker.thermal.occlusion.learned_table import LearnedTable
from peopleboy.tracker.thermal.occlusion.pair_features import COLOUR, FEATURES, THERMAL, Features
from peopleboy.tracker.thermal.occlusion.weak_classifiers import weighted_sums

TRAINING = ("crossing_pair", "crossing_3", "pass_behind", "stop_and_talk", "group_abreast", "crowd_8_moving")
UNSEEN = ("crossing_2", "crossing_2_moving", "crossing_4", "three_depths", "leader_swap", "same_uniform")
"""Scenarios to learn from, and others to be tested on."""

REPEATS = 10
PAIRS = 121
"""How many pairs the thesis has; with their mirror images, 242 examples."""
_TRAINING_SHARE = 0.6

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One way to build weak classifiers, and how well it does. Shares in percent.

    Attributes:
        table: number of the thesis' table.
        name: as in that table.
        classifiers: how many weak classifiers there are to choose from.
        thesis: (mean, deviation) there.
        held_out: of each split, on the rest of the training scenarios' examples.
        unseen: of the same classifiers, on the other scenarios.
    """

    table: str
    name: str
    classifiers: int
    thesis: tuple[float, float]
    held_out: tuple[float, ...]
    unseen: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class _Plan:
    table: str
    name: str
    uses: tuple[str, ...]
    most: int
    thesis: tuple[float, float]


_SINGLE = {
    "strength": (50.10, 4.91),
    "top": (72.99, 3.85),
    "bottom": (56.49, 4.25),
    "colour": (67.62, 3.04),
    "colour_o": (45.56, 2.69),
    "colour_no": (67.42, 2.92),
}
_PLANS = (
    _Plan("7.1", "thermal", THERMAL, 2, (76.39, 4.49)),
    _Plan("7.1", "colour", COLOUR, 2, (69.07, 1.94)),
    _Plan("7.1", "both", FEATURES, 2, (89.38, 2.48)),
    _Plan("7.2", "single", FEATURES, 1, (74.94, 4.88)),
    _Plan("7.2", "weighted pairs", FEATURES, 2, (89.36, 2.48)),
    _Plan("7.2", "weighted triplets", FEATURES, 3, (89.38, 1.82)),
    *(_Plan("7.3", name, (name,), 1, figures) for name, figures in _SINGLE.items()),
)


def run_trials(
    training: Sequence[PairExample],
    unseen: Sequence[PairExample],
    rng: np.random.Generator,
    *,
    most: int = 3,
    rounds: int = 40,
    repeats: int = REPEATS,
) -> Iterator[Trial]:
    """Repeat the experiments of tables 7.1 to 7.3 with as many examples as the thesis has.

    Each time, that many are drawn, and 60 % of them are learned from, the rest is for testing. A pair and its
    mirror image are on the same side of every split, and all trials share the splits.

    Args:
        training: examples to draw from.
        unseen: examples from other scenarios.
        rng: draws the splits.
        most: 3 for weighted triplets as well, which take minutes.
        rounds: of boosting.
        repeats: how many splits.

    Source: thesis, section 7.4.
    """
    splits = [rng.permutation(len(training))[:PAIRS] for _ in range(repeats)]
    for plan in _PLANS:
        if plan.most <= most:
            yield _try_out(plan, splits, training, unseen, rounds)


def _try_out(
    plan: _Plan,
    splits: Sequence[NDArray[np.int64]],
    training: Sequence[PairExample],
    unseen: Sequence[PairExample],
    rounds: int,
) -> Trial:
    from peopleboy.tracker.thermal.occlusion.boosting import (
        train,  # here, as only learning needs scikit-learn
    )

    held_out, elsewhere = [], []
    for split in splits:
        cut = round(_TRAINING_SHARE * len(split))
        chosen, rest = ([training[i] for i in rows] for rows in (split[:cut], split[cut:]))
        features, is_front = mirrored(chosen)
        # A single feature is one weak classifier, and boosting has nothing to add to it.
        table = train(
            features, is_front, most=plan.most, uses=plan.uses, rounds=1 if len(plan.uses) == 1 else rounds
        )
        held_out.append(accuracy(table, rest))
        elsewhere.append(accuracy(table, unseen))
    return Trial(
        table=plan.table,
        name=plan.name,
        classifiers=len(weighted_sums(len(plan.uses), plan.most)),
        thesis=plan.thesis,
        held_out=tuple(held_out),
        unseen=tuple(elsewhere),
    )


def accuracy(table: LearnedTable, examples: Sequence[PairExample]) -> float:
    """Give the share of right answers [%] among pairs and their mirror images; no answer counts half."""
    features, is_front = mirrored(examples)
    return share_right(LearnedOrder.build(table).lead(features), is_front)


def share_right(lead: Features, is_front: NDArray[np.bool_]) -> float:
    """Give the share of right answers [%]; no answer counts half, NaN without any question."""
    if len(lead) == 0:
        return float("nan")
    right = np.where(is_front, lead, -lead)
    return float(100 * ((right > 0) + 0.5 * (right == 0)).mean())


def learn(
    training: Sequence[PairExample], unseen: Sequence[PairExample], *, rounds: int = 40
) -> LearnedTable:
    """Learn the table to ship from all training examples, with weighted pairs.

    Raises:
        BadInput: too few examples.
    """
    from peopleboy.tracker.thermal.occlusion.boosting import train

    check_examples(training, "training")
    check_examples(unseen, "unseen")
    table = train(*mirrored(training), rounds=rounds)
    about = {
        "learned from": f"{len(training)} pairs and their mirror images: {_count_by_scenario(training)}",
        "right on those": f"{accuracy(table, training):.1f} %",
        "tested on": f"{len(unseen)} pairs: {_count_by_scenario(unseen)}",
        "right on these": f"{accuracy(table, unseen):.1f} %",
        "weak classifiers": "weighted pairs of the six features (thesis, equation 7.4)",
    }
    return replace(table, about=about)


def check_examples(examples: Sequence[PairExample], what: str) -> None:
    """Refuse to learn from next to nothing."""
    if len(examples) < 20:
        raise BadInput(f"{len(examples)} {what} pairs: at least 20 are needed; take more seeds or scenarios")


def _count_by_scenario(examples: Sequence[PairExample]) -> str:
    count = Counter(example.scenario for example in examples)
    return ", ".join(f"{name} {number}" for name, number in count.items())
