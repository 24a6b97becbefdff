"""Tables 7.1 to 7.4 of the thesis, ours beside its own."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from itertools import groupby, zip_longest

from rich.console import Console
from rich.table import Table

from scenarios.train_occlusion import Trial
from tracker.occlusion.learned_table import LearnedTable
from tracker.occlusion.pair_features import FEATURES

_TITLES = {
    "7.1": "Table 7.1: type of features [%]",
    "7.2": "Table 7.2: combinations of features [%]",
    "7.3": "Table 7.3: single features [%]",
}
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
            figures = [_percent(*pair) for pair in (trial.thesis, trial.held_out, trial.unseen)]
            table.add_row(trial.name, str(trial.classifiers), *figures)
        _print(table)


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


def _percent(mean: float, deviation: float) -> str:
    return "-" if math.isnan(mean) else f"{mean:.2f} ± {deviation:.2f}"


def _table(title: str) -> Table:
    return Table(title=title, title_justify="left", box=None, pad_edge=False)


def _print(table: Table) -> None:
    console = Console(width=None if sys.stdout.isatty() else 140)
    console.print(table)
    console.print()
