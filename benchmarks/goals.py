"""Figures of `make bench`: what each should be, what it was before, and how all of them are printed."""

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
    """Between what a figure should be, both ends included."""

    least: float = -math.inf
    most: float = math.inf
    unit: str = ""

    def is_met(self, value: float) -> bool:
        """Return whether a figure is good enough."""
        return self.least <= value <= self.most

    def __str__(self) -> str:
        """Say it in words."""
        ends = ((self.least, "at least"), (self.most, "at most"))
        return ", ".join(f"{word} {end:g}{self.unit}" for end, word in ends if math.isfinite(end))


@dataclass(frozen=True, slots=True)
class BenchFigure:
    """One figure: what it is of, as a path, how it is written, what it should be, and where its time goes."""

    path: tuple[str, ...]
    value: float
    form: str
    goal: Goal | None = None
    reason: str = ""

    @property
    def name(self) -> str:
        """What it is of, in words."""
        return ", ".join(self.path).removesuffix(", ms")

    @property
    def is_missed(self) -> bool:
        """Whether it is not what it should be."""
        return self.goal is not None and not self.goal.is_met(self.value)


def nested(figures: Sequence[BenchFigure]) -> dict[str, Any]:
    """Put the figures into mappings within mappings, as their paths say."""
    whole: dict[str, Any] = {}
    for figure in figures:
        inner = whole
        for step in figure.path[:-1]:
            inner = inner.setdefault(step, {})
        inner[figure.path[-1]] = figure.value
    return whole


def read_figures(path: Path) -> dict[str, Any]:
    """Read the figures of an earlier run.

    Raises:
        BadInput: no file that `make bench` left.
    """
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: must be figures as in runs/bench.json, got {error}") from error
    if not isinstance(found, dict):
        raise BadInput(f"{path}: must be figures as in runs/bench.json, got {type(found).__name__}")
    return found


def earlier(figure: BenchFigure, before: Mapping[str, Any]) -> float | None:
    """Find what a figure was in an earlier run; None if it was not measured then."""
    found: Any = before
    for step in figure.path:
        found = found.get(step) if isinstance(found, Mapping) else None
    return float(found) if isinstance(found, int | float) else None


def table_of(figures: Sequence[BenchFigure], before: Mapping[str, Any] | None = None) -> Table:
    """Lay out figures, those that miss their goal first, beside those of an earlier run."""
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
    """Say why figures miss their goals, as far as their parts were timed."""
    missed = (each for each in figures if each.is_missed and each.reason)
    return [f"{each.name} misses its goal: {each.reason}" for each in missed]
