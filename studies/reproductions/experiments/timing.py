"""Experiments that measure time: the thesis's tables 4.1, 5.1, 6.1 and 6.2, and a step with 300 samples."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.stopwatch import (
    Milliseconds,
    time_attention,
    time_colours,
    time_counts,
    time_integrals,
    time_people,
    time_steps,
)
from peopleboy.studies.reproductions.measuring.tracker_settings import Setting
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.tracker.attention.attention_config import PRINTED, AttentionConfig

MS = "ms"
TURNS = 5
"""How often a table is measured."""

Measure = Callable[[int], Milliseconds]


@dataclass(frozen=True, slots=True)
class TimeUnit:
    """One column of a timing table, once; times are not exact, so the units run alone.

    Attributes:
        table: id of the experiment.
        who: whose column.
        steps: how often every step is timed.
        turn: which of several measurements it is, from 0.
    """

    table: str
    who: str
    steps: int
    turn: int
    is_timing: bool = True

    @property
    def key(self) -> str:
        """Table, column and turn."""
        return f"time {self.table} | {self.who} | {self.steps} | {self.turn}"

    def run(self) -> Result:
        """Measure."""
        return dict(_MEASURES[self.table][self.who](self.steps))


@dataclass(frozen=True, slots=True)
class Timing:
    """A table of times, all of which are measured several times over."""

    id: str
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Each column is one piece of work in each turn."""
        units = (unit for turn in range(TURNS) for unit in self._units(plan, turn))
        return missing(units, done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give milliseconds, step by step and turn by turn."""
        turns = [self._units(plan, turn) for turn in range(TURNS)]
        return {
            Line(step, same[0].who): {MS: np.array([done[unit.key][step] for unit in same])}
            for same in zip(*turns, strict=True)
            for step in done[same[0].key]
        }

    def _units(self, plan: Plan, turn: int) -> list[TimeUnit]:
        return [TimeUnit(self.id, who, plan.timing_steps, turn) for who in _MEASURES[self.id]]


def _by_tracker(
    measure: Callable[[Setting, int], Milliseconds], literal: str, ours: str
) -> dict[str, Measure]:
    return {
        "literal": lambda steps: measure(Setting(literal), steps),
        "default": lambda steps: measure(Setting(ours), steps),
    }


_MEASURES: dict[str, dict[str, Measure]] = {
    "table-4.1": _by_tracker(time_steps, "thesis-single", "contour"),
    "section-4.4": _by_tracker(time_counts, "thesis-single", "contour")
    | {"literal, paper": lambda steps: time_counts(Setting("paper-single"), steps)},
    "table-5.1": {
        "literal": lambda steps: time_people(Setting("thesis-thermal"), steps),
        "default, thermal only": lambda steps: time_people(Setting("contour-thermal"), steps),
        "default": lambda steps: time_people(Setting("contour"), steps),
    },
    "table-6.1": {"PeopleBoy": time_integrals},
    "table-6.2": _by_tracker(time_colours, "thesis-single", "contour"),
    "situation-attention-times": {
        "printed": lambda steps: time_attention(PRINTED, steps),
        "default": lambda steps: time_attention(AttentionConfig(), steps),
    },
}

*TIMINGS, ATTENTION_TIMES = (Timing(table) for table in _MEASURES)
