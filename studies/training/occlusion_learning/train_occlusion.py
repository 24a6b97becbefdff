"""Learn who is in front of whom from scenarios, and compare what comes out with the thesis."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from peopleboy.bad_input import BadInput
from peopleboy.sim.random_streams import stream
from peopleboy.studies.training.occlusion_learning.example_splits import accuracy, learn_split
from peopleboy.studies.training.occlusion_learning.occlusion_pairs import PairExample, mirrored
from peopleboy.tracker.contour.occlusion.learned_table import LearnedTable
from peopleboy.tracker.contour.occlusion.pair_features import COLOUR, FEATURES, THERMAL
from peopleboy.tracker.contour.occlusion.weak_classifiers import weighted_sums

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
"""Where people hide each other, and examples come from."""

REPEATS = 10
LEAST = 20
"""Pairs with fewer of which nothing is learned."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One way to build weak classifiers, and how well it does. Shares in percent.

    Attributes:
        table: number of the thesis' table.
        name: as in that table.
        classifiers: how many weak classifiers there are to choose from.
        thesis: (mean, deviation) there.
        held_out: of each random split, on the examples that were not learned from.
        unseen: of each split by scenario, on the scenarios that were not.
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
    examples: Sequence[PairExample],
    *,
    most: int = 3,
    rounds: int = 40,
    repeats: int = REPEATS,
) -> Iterator[Trial]:
    """Repeat the experiments of tables 7.1 to 7.3; all trials share the splits.

    Args:
        examples: of all scenarios.
        most: 3 for weighted triplets as well, which take minutes.
        rounds: of boosting.
        repeats: how many splits.

    Source: thesis, section 7.4.
    """
    for plan in _PLANS:
        if plan.most <= most:
            yield _try_out(plan, examples, rounds, repeats)


def _try_out(plan: _Plan, examples: Sequence[PairExample], rounds: int, repeats: int) -> Trial:
    found = [
        learn_split(examples, plan.uses, plan.most, rounds, stream(number, "occlusion.split"))
        for number in range(repeats)
    ]
    return Trial(
        table=plan.table,
        name=plan.name,
        classifiers=len(weighted_sums(len(plan.uses), plan.most)),
        thesis=plan.thesis,
        held_out=tuple(one.held_out for one in found),
        unseen=tuple(one.unseen for one in found),
    )


def learn(examples: Sequence[PairExample], *, rounds: int = 40) -> LearnedTable:
    """Learn the table to ship from all examples, with weighted pairs.

    Raises:
        BadInput: too few examples.
    """
    from peopleboy.tracker.contour.occlusion.boosting import train  # only learning needs scikit-learn

    check_examples(examples)
    table = train(*mirrored(examples), rounds=rounds)
    about = {
        "learned from": f"{len(examples)} pairs and their mirror images: {_count_by_scenario(examples)}",
        "right on those": f"{accuracy(table, examples):.1f} %",
        "right on each scenario, learned from the others": f"{_right_left_out(examples, rounds):.1f} %",
        "weak classifiers": "weighted pairs of the six features (thesis, equation 7.4)",
    }
    return replace(table, about=about)


def _right_left_out(examples: Sequence[PairExample], rounds: int) -> float:
    """Leave one scenario out after the other, and give the share of right answers [%] on all of them."""
    from peopleboy.tracker.contour.occlusion.boosting import train

    right = 0.0
    for name, count in Counter(example.scenario for example in examples).items():
        others = [example for example in examples if example.scenario != name]
        if not others:
            return float("nan")
        table = train(*mirrored(others), rounds=rounds)
        right += count * accuracy(table, [example for example in examples if example.scenario == name])
    return right / len(examples)


def check_examples(examples: Sequence[PairExample]) -> None:
    """Refuse to learn from next to nothing."""
    if len(examples) < LEAST:
        raise BadInput(f"{len(examples)} pairs: at least {LEAST} are needed; take more seeds or scenarios")


def _count_by_scenario(examples: Sequence[PairExample]) -> str:
    count = Counter(example.scenario for example in examples)
    return ", ".join(f"{name} {number}" for name, number in count.items())
