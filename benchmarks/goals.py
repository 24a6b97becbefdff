"""Results of `make bench`: goals, comparison with an earlier run, and the printed table."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.table import Table

from peopleboy.bad_input import BadInput


@dataclass(frozen=True, slots=True, kw_only=True)
class Goal:
    """Range in which a result should be, including both ends."""

    least: float = -math.inf
    most: float = math.inf
    unit: str = ""

    def is_met(self, value: float) -> bool:
        """Return whether a result is in the range."""
        return self.least <= value <= self.most

    def __str__(self) -> str:
        """Return the range as text."""
        ends = ((self.least, "at least"), (self.most, "at most"))
        return ", ".join(f"{word} {end:g}{self.unit}" for end, word in ends if math.isfinite(end))


@dataclass(frozen=True, slots=True)
class BenchFigure:
    """One result: its path, value, format, goal, and reason for a missed goal."""

    path: tuple[str, ...]
    value: float
    form: str
    goal: Goal | None = None
    reason: str = ""

    @property
    def name(self) -> str:
        """Readable name."""
        return ", ".join(self.path).removesuffix(", ms")

    @property
    def is_missed(self) -> bool:
        """Whether it misses its goal."""
        return self.goal is not None and not self.goal.is_met(self.value)


def nested(figures: Sequence[BenchFigure]) -> dict[str, Any]:
    """Return the results as nested mappings, by their paths."""
    whole: dict[str, Any] = {}
    for figure in figures:
        inner = whole
        for step in figure.path[:-1]:
            inner = inner.setdefault(step, {})
        inner[figure.path[-1]] = figure.value
    return whole


def read_figures(path: Path) -> dict[str, Any]:
    """Read the results of an earlier run.

    Raises:
        BadInput: it is not an output file of `make bench`.
    """
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: must be results as in runs/bench.json, got {error}") from error
    if not isinstance(found, dict):
        raise BadInput(f"{path}: must be results as in runs/bench.json, got {type(found).__name__}")
    return found


def earlier(figure: BenchFigure, before: Mapping[str, Any]) -> float | None:
    """Return the value of a result in an earlier run; None if it was not measured then."""
    found: Any = before
    for step in figure.path:
        found = found.get(step) if isinstance(found, Mapping) else None
    return float(found) if isinstance(found, int | float) else None


def table_of(figures: Sequence[BenchFigure], before: Mapping[str, Any] | None = None) -> Table:
    """Return a table of results next to those of an earlier run, with missed goals first."""
    table = Table("what", "figure", "goal", title="CPU time, medians of one run", box=None)
    if before is not None:
        table.add_column("before")
        table.add_column("now / before")
    for figure in sorted(figures, key=lambda one: not one.is_missed):
        goal = "" if figure.goal is None else f"{figure.goal}{', missed' if figure.is_missed else ''}"
        cells = [figure.name, figure.form.format(figure.value), goal]
        if before is not None:
            was = earlier(figure, before)
            cells += ["", ""] if was is None else [f"{was:.3g}", f"{figure.value / was:.2f}" if was else ""]
        table.add_row(*cells)
    return table


def reasons(figures: Sequence[BenchFigure]) -> list[str]:
    """Yield why results miss their goals, if known."""
    missed = (each for each in figures if each.is_missed and each.reason)
    return [f"{each.name} misses its goal: {each.reason}" for each in missed]
