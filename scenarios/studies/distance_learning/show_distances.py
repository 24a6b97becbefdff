"""The paper's tables, ours beside its own."""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from peopleboy.scenarios.studies.distance_learning.distance_examples import Examples
from peopleboy.scenarios.studies.distance_learning.distance_trials import (
    FILTERS,
    SPLITS,
    ErrorSummary,
    correlations,
    general_trials,
    personal_trials,
    position_trials,
)
from peopleboy.tracker.panoramic.paper.depth_cues import DepthCues
from peopleboy.tracker.panoramic.paper.distance_network import Lessons

_ANGLE = (2.01, 1.60)
_GENERAL = {"average": (0.126, 0.167), "best": (0.110, 0.099), "worst": (0.163, 0.325)}
_PERSONAL = {(1, 1): (0.096, 0.074), (1, 2): (0.133, 0.126), (2, 1): (0.231, 0.276), (2, 2): (0.117, 0.111)}
_POSITION = {
    "appearance model": (0.154, 0.094),
    "Kalman filter, printed Q and R, u = last step": (0.145, 0.092),
}
"""What the paper prints, mean and deviation; which u its filter had, it does not say."""


def print_trials(runs: Sequence[Examples], lessons: Lessons) -> None:
    """Repeat the paper's experiments on every run, and print their tables."""
    _print_angles(runs)
    _print_general(runs, lessons)
    _print_personal(runs, lessons)
    _print_positions(runs, lessons)


def pooled(splits: Sequence[ErrorSummary]) -> tuple[float, float]:
    """Give mean and standard deviation over the errors of all splits together."""
    counts = np.array([one.count for one in splits], np.float64)
    means = np.array([one.mean for one in splits])
    squares = np.array([one.deviation**2 + one.mean**2 for one in splits])
    mean = float(np.average(means, weights=counts))
    return mean, float(np.sqrt(max(np.average(squares, weights=counts) - mean**2, 0.0)))


def of_three(splits: Sequence[ErrorSummary]) -> dict[str, tuple[float, float]]:
    """Summarise splits as the paper does: all together, the best one, the worst one."""
    best = min(splits, key=lambda one: one.mean)
    worst = max(splits, key=lambda one: one.mean)
    return {
        "average": pooled(splits),
        "best": (best.mean, best.deviation),
        "worst": (worst.mean, worst.deviation),
    }


def _print_angles(runs: Sequence[Examples]) -> None:
    table = _table("Angle [deg], r of cues and distance", "", "paper", "ours")
    degrees = np.degrees(np.concatenate([run.angle_error_rad for run in runs]))
    table.add_row("angle error", _error(_ANGLE, 2), _error((degrees.mean(), degrees.std()), 2))
    for name, r in zip(DepthCues._fields, correlations(runs), strict=True):
        table.add_row(f"r of {name}", "lost", f"{r:.3f}")
    _print(table)


def _print_general(runs: Sequence[Examples], lessons: Lessons) -> None:
    table = _table(f"Distance, one model for all [m], {lessons.epochs} epochs", "", "paper", *SPLITS)
    splits = {name: [one for run in runs for one in general_trials(run, name, lessons)] for name in SPLITS}
    ours = {name: of_three(found) for name, found in splits.items()}
    for row, paper in _GENERAL.items():
        table.add_row(row, _error(paper), *(_error(ours[name][row]) for name in SPLITS))
    _print(table)


def _print_personal(runs: Sequence[Examples], lessons: Lessons) -> None:
    table = _table("Distance, a model for each person [m]", "", "paper", *SPLITS)
    found = {name: [personal_trials(run, name, lessons) for run in runs] for name in SPLITS}
    for pair, paper in _PERSONAL.items():
        ours = [[one for run in found[name] for one in run.get(pair, [])] for name in SPLITS]
        told = [_error(pooled(splits)) if splits else "-" for splits in ours]
        table.add_row(f"person {pair[0]}, model of {pair[1]}", _error(paper), *told)
    _print(table)


def _print_positions(runs: Sequence[Examples], lessons: Lessons) -> None:
    table = _table("Position [m]", "", "paper", *SPLITS)
    found = {name: [position_trials(run, name, lessons) for run in runs] for name in SPLITS}
    for way in FILTERS:
        paper = _error(_POSITION[way]) if way in _POSITION else "-"
        ours = [_error(pooled([one for run in found[name] for one in run[way]])) for name in SPLITS]
        table.add_row(way, paper, *ours)
    _print(table)


def _error(error: tuple[float, float], digits: int = 3) -> str:
    mean, deviation = error
    return f"{mean:.{digits}f} ± {deviation:.{digits}f}"


def _table(title: str, *columns: str) -> Table:
    table = Table(title=Text(title), title_justify="left", box=None, pad_edge=False)
    for column in columns:
        table.add_column(column, justify="right" if column else "left")
    return table


def _print(table: Table) -> None:
    console = Console(width=None if sys.stdout.isatty() else 140)
    console.print(table)
    console.print()
