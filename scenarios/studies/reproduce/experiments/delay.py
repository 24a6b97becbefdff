"""How soon a person is detected: thesis, section 5.3."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.studies.reproduce.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.scenarios.studies.reproduce.measuring.delay_units import DelayUnit
from peopleboy.scenarios.studies.reproduce.measuring.tracker_settings import Setting
from peopleboy.scenarios.studies.reproduce.measuring.units import FilmUnit, Unit
from peopleboy.scenarios.studies.reproduce.measuring.workload import Plan

RATE_HZ = 15
COLUMNS = ("frames", "s", "found in 2 s [%]")


@dataclass(frozen=True, slots=True)
class Delay:
    """Frames until somebody in plain view is detected, by a tracker that has just been switched on.

    Attributes:
        suites: data sets with one person.
        trackers: who is tried, by the name of the line.
    """

    suites: Sequence[str]
    trackers: Mapping[str, Setting]
    id: str = "section-5.3"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Films first, then who sees them."""
        films = [FilmUnit(play, plan.cache) for name in self.suites for play in plan.suites[name]]
        tries = [
            unit for line in self._lines() for r in range(plan.repeats) for unit in self._units(plan, line, r)
        ]
        return missing(films, done) or missing(tries, done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Take the means over all starts, repeat by repeat."""
        return {line: self._figures(plan, done, line) for line in self._lines()}

    def _lines(self) -> list[Line]:
        return [Line(suite, who) for suite in self.suites for who in self.trackers]

    def _units(self, plan: Plan, line: Line, repeat: int) -> list[DelayUnit]:
        setting = self.trackers[line.who]
        return [DelayUnit(play, plan.cache, setting, repeat) for play in plan.suites[line.group]]

    def _figures(self, plan: Plan, done: Done, line: Line) -> dict[str, NDArray[np.float64]]:
        rows = []
        for repeat in range(plan.repeats):
            results = [done[unit.key] for unit in self._units(plan, line, repeat)]
            needed = [frames for result in results for frames in result["needed"]]
            starts = sum(result["starts"] for result in results)
            frames = float(np.mean(needed)) if needed else float("nan")
            rows.append((frames, frames / RATE_HZ, 100 * len(needed) / max(starts, 1)))
        return dict(zip(COLUMNS, np.array(rows).T, strict=True))
