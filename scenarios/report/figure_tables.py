"""The tables of figures on a page, with words for readers who do not know their names."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, stdev
from typing import Any, Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.report.columns import Column
from peopleboy.scenarios.report.findings.finished_run import FinishedRun
from peopleboy.scenarios.scores.bootstrap import bootstrap
from peopleboy.scenarios.scores.corridor_metrics import CorridorScore
from peopleboy.scenarios.scores.following_metrics import FollowingScore, Row
from peopleboy.tracker.evaluation.table import FIGURES, Figure

_FEWEST_PAIRS = 3  # runs of the same scenario and seed, for an interval of their differences

# Name of the figure, what to call it, and what it says to somebody who reads it for the first time.
PLAIN: Final = (
    ("CR", "people found", "Of all moments in which somebody was to be found: in how many a box lay there."),
    ("CP", "boxes on people", "Of all boxes: how many lie on a person. The rest are false alarms."),
    ("AA", "fit of the boxes", "How well boxes and people cover each other; 100 would be the very same box."),
    ("IDF1", "who is who", "How constantly one person has one number. Lost or swapped identities lower it."),
    ("HOTA", "all in one", "Finding people and telling them apart in one, as public benchmarks have it."),
    ("MOTA", "few mistakes", "100 less all misses, false alarms and switches; it may fall below 0."),
    ("IDSW", "switches", "How often the number on a person became another, even if only for a moment."),
    ("false_tracks", "tracks on nobody", "Track numbers that never lay on a person at all."),
)  # fmt: skip
_SCORES: Final = {"following": FollowingScore, "corridor": CorridorScore}


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One line of a table of figures.

    Attributes:
        name: of the figure.
        meaning: in words.
        cells: one a column, as text.
        difference: second column less the first, as text; empty unless there are two.
    """

    name: str
    meaning: str
    cells: tuple[str, ...]
    difference: str


def plain_lines(columns: Sequence[Column]) -> list[Line]:
    """The few figures that say most, under plain names."""
    by_name = {figure.name: figure for figure in FIGURES}
    lines = []
    for name, plain, meaning in PLAIN:
        values = [_scores_of(column, by_name[name]) for column in columns]
        lines.append(_line(f"{plain} ({name})", meaning, by_name[name].unit, columns, values))
    return lines


def all_lines(columns: Sequence[Column]) -> list[Line]:
    """Every figure, with its usual name."""
    return [
        _line(f.name, f.meaning, f.unit, columns, [_scores_of(column, f) for column in columns])
        for f in FIGURES
    ]


def drive_lines(columns: Sequence[Column], group: str) -> list[Line]:
    """How the robot drove, if any run says: `following` or `corridor`."""
    rows = [[_rows(outcome.run, group) for outcome in column.outcomes] for column in columns]
    first = next((of_run for column in rows for of_run in column if of_run), [])
    lines = []
    for name, _, unit, meaning in first:
        values = [
            [next((value for other, value, _, _ in of_run if other == name), math.nan) for of_run in column]
            for column in rows
        ]
        lines.append(_line(name, meaning, unit, columns, values))
    return lines


def _rows(run: FinishedRun, group: str) -> list[Row]:
    figures: Mapping[str, Any] | None = run.metrics.get(group)
    if figures is None:
        return []
    try:
        known = {name: math.nan if value is None else value for name, value in figures.items()}
        rows: list[Row] = _SCORES[group](**known).rows()
    except (TypeError, AttributeError) as error:
        path = run.folder / "metrics.json"
        raise BadInput(f"{path}: {group}: not the figures of this version; run the scenario again") from error
    return rows


def _scores_of(column: Column, figure: Figure) -> list[float]:
    return [figure.of(scores) for scores in column.scores]


def _line(
    name: str, meaning: str, unit: str, columns: Sequence[Column], values: Sequence[Sequence[float]]
) -> Line:
    difference = _difference(columns, values, unit) if len(columns) == 2 else ""
    return Line(
        name=name, meaning=meaning, cells=tuple(_cell(of, unit) for of in values), difference=difference
    )


def _cell(values: Sequence[float], unit: str) -> str:
    """One value, or mean and standard deviation over runs."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return "-"
    if len(values) == 1:
        return number(known[0], unit)
    spread = f" ± {stdev(known):.1f}" if len(known) > 1 else ""
    return f"{fmean(known):.1f}{spread} {unit}".rstrip()


def number(value: float, unit: str = "") -> str:
    """Write a figure."""
    if math.isnan(value):
        return "-"
    text = f"{value:.0f}" if value == int(value) and unit != "%" else f"{value:.{1 if unit == '%' else 2}f}"
    return f"{text} {unit}".rstrip()


def _difference(columns: Sequence[Column], values: Sequence[Sequence[float]], unit: str) -> str:
    """Second less first: of runs of the same scenario and seed, with an interval where there are enough."""
    names = [[outcome.run.name for outcome in column.outcomes] for column in columns]
    one, other = (dict(zip(of, found, strict=True)) for of, found in zip(names, values, strict=True))
    both = [other[name] - one[name] for name in one if name in other]
    known = [value for value in both if not math.isnan(value)]
    if len(known) >= _FEWEST_PAIRS:
        interval = bootstrap(known, np.random.default_rng(0))
        return f"{interval.mean:+.1f} [{interval.low:+.1f}, {interval.high:+.1f}]"
    if known and len(both) == len(names[0]) == len(names[1]):
        mean = fmean(known)
        return f"{mean:+.0f}" if mean == int(mean) and unit != "%" else f"{mean:+.{1 if unit == '%' else 2}f}"
    return "-"
