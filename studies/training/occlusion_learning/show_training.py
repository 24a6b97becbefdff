"""Tables 7.1 to 7.4 of the thesis, ours beside its own."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from itertools import groupby, zip_longest

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.stats import ttest_rel

from peopleboy.studies.training.occlusion_learning.train_occlusion import Trial
from peopleboy.tracker.contour.occlusion.learned_table import LearnedTable
from peopleboy.tracker.contour.occlusion.pair_features import FEATURES

_TITLES = {
    "7.1": "Table 7.1: type of features [%]",
    "7.2": "Table 7.2: combinations of features [%]",
    "7.3": "Table 7.3: single features [%]",
}
_TESTS = (
    ("both", "thermal", "< 0.01"),
    ("both", "colour", "< 0.01"),
    ("thermal", "colour", "significant"),
    ("weighted pairs", "single", "-"),
    ("weighted pairs", "weighted triplets", "> 0.01"),
)
# The weights of the ten best weak classifiers, by feature.
_THESIS_BEST: tuple[dict[str, float], ...] = (
    {"strength": -0.05, "colour_no": 1.0},
    {"top": -0.05, "colour": 1.0},
    {"top": -1.0, "bottom": 0.45},
    {"top": -0.75, "bottom": 1.0},
    {"bottom": 0.05, "colour_no": 1.0},
    {"top": -0.8, "bottom": 1.0},
    {"bottom": 0.1, "colour_no": 1.0},
    {"strength": -0.55, "top": 1.0},
    {"strength": -1.0, "top": 0.05},
    {"bottom": -0.05, "colour": 1.0},
)


def print_trials(trials: Sequence[Trial]) -> None:
    """Print tables 7.1 to 7.3, means and deviations over the repeated splits."""
    for number, rows in groupby(trials, key=lambda trial: trial.table):
        table = _table(_TITLES[number])
        for column in ("", "weak classifiers", "thesis", "ours", "ours, unseen scenarios"):
            table.add_column(column, justify="right" if column else "left")
        for trial in rows:
            ours = [_percent(np.mean(each), np.std(each, ddof=1)) for each in (trial.held_out, trial.unseen)]
            table.add_row(trial.name, str(trial.classifiers), _percent(*trial.thesis), *ours)
        _print(table)
    _print_tests({trial.name: trial for trial in trials})


def _print_tests(trials: Mapping[str, Trial]) -> None:
    """Print the paired t-tests of section 7.4, over the splits that two ways share."""
    table = _table("Paired t-tests: p that the two are equally good")
    for column in ("", "thesis", "ours", "ours, unseen scenarios"):
        table.add_column(column, justify="right" if column else "left")
    for one, other, thesis in _TESTS:
        if one in trials and other in trials:
            a, b = trials[one], trials[other]
            ours = [_p_value(a.held_out, b.held_out), _p_value(a.unseen, b.unseen)]
            table.add_row(f"{one}, {other}", thesis, *ours)
    _print(table)


def _p_value(one: Sequence[float], other: Sequence[float]) -> str:
    if np.allclose(one, other):
        return "1"
    return f"{ttest_rel(one, other).pvalue:.2g}"


def print_best(learned: LearnedTable) -> None:
    """Print table 7.4: the ten weak classifiers that were chosen first."""
    table = _table("Table 7.4: best weak classifiers; weights of the thesis | ours, of scaled features")
    for column in ("place", *FEATURES, "|", *FEATURES, "importance"):
        table.add_column(column, justify="right")
    rows = zip_longest(_THESIS_BEST, learned.classifiers[:10])
    for place, (theirs, ours) in enumerate(rows, start=1):
        weights = ours.weights if ours is not None else {}
        importance = f"{ours.importance:.2f}" if ours is not None else ""
        table.add_row(str(place), *_weights(theirs), "|", *_weights(weights), importance)
    _print(table)


def _weights(weights: dict[str, float]) -> list[str]:
    return [f"{weights[name]:.2f}" if name in weights else "-" for name in FEATURES]


def _percent(mean: float | np.floating, deviation: float | np.floating) -> str:
    return "-" if math.isnan(mean) else f"{mean:.2f} ± {deviation:.2f}"


def _table(title: str) -> Table:
    return Table(title=title, title_justify="left", box=None, pad_edge=False)


def _print(table: Table) -> None:
    console = Console(width=None if sys.stdout.isatty() else 140)
    console.print(table)
    console.print()
