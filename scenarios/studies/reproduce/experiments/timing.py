"""Experiments that measure time: the thesis's tables 4.1, 5.1, 6.1 and 6.2."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.studies.reproduce.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.scenarios.studies.reproduce.measuring.stopwatch import (
    Milliseconds,
    time_attention,
    time_colours,
    time_integrals,
    time_people,
    time_steps,
)
from peopleboy.scenarios.studies.reproduce.measuring.tracker_settings import Setting
from peopleboy.scenarios.studies.reproduce.measuring.units import Unit
from peopleboy.scenarios.studies.reproduce.measuring.workload import Plan
from peopleboy.tracker.attention.attention_config import PRINTED, AttentionConfig

MS = "ms"

Measure = Callable[[int], Milliseconds]


@dataclass(frozen=True, slots=True)
class TimeUnit:
    """One column of a timing table, once; times are not exact, so the units run alone.

    Attributes:
        table: id of the experiment.
        who: whose column.
        steps: how often every step is timed.
    """

    table: str
    who: str
    steps: int
    is_timing: bool = True

    @property
    def key(self) -> str:
        """Table and column."""
        return f"time {self.table} | {self.who} | {self.steps}"

    def run(self) -> Result:
        """Measure."""
        return dict(_MEASURES[self.table][self.who](self.steps))


@dataclass(frozen=True, slots=True)
class Timing:
    """A table of times."""

    id: str
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Each column is one piece of work."""
        return missing(self._units(plan), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give milliseconds, step by step."""
        return {
            Line(step, unit.who): {MS: np.array([time_ms])}
            for unit in self._units(plan)
            for step, time_ms in done[unit.key].items()
        }

    def _units(self, plan: Plan) -> list[TimeUnit]:
        return [TimeUnit(self.id, who, plan.timing_steps) for who in _MEASURES[self.id]]


def _by_tracker(
    measure: Callable[[Setting, int], Milliseconds], literal: str, ours: str
) -> dict[str, Measure]:
    return {
        "literal": lambda steps: measure(Setting(literal), steps),
        "default": lambda steps: measure(Setting(ours), steps),
    }


_MEASURES: dict[str, dict[str, Measure]] = {
    "table-4.1": _by_tracker(time_steps, "thesis-single", "peopleboy"),
    "table-5.1": {
        "literal": lambda steps: time_people(Setting("thesis-thermal"), steps),
        "default, thermal only": lambda steps: time_people(Setting("peopleboy-thermal"), steps),
        "default": lambda steps: time_people(Setting("peopleboy"), steps),
    },
    "table-6.1": {"PeopleBoy": time_integrals},
    "table-6.2": _by_tracker(time_colours, "thesis-single", "peopleboy"),
    "situation-attention-times": {
        "printed": lambda steps: time_attention(PRINTED, steps),
        "default": lambda steps: time_attention(AttentionConfig(), steps),
    },
}

*TIMINGS, ATTENTION_TIMES = (Timing(table) for table in _MEASURES)
