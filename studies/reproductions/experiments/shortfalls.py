"""Where the default falls short: how soon it detects a person, and what its errors are due to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.cause_units import STRICT, WAYS, CauseUnit
from peopleboy.studies.reproductions.measuring.delay_units import DelayUnit
from peopleboy.studies.reproductions.measuring.tracker_settings import Setting
from peopleboy.studies.reproductions.measuring.units import FilmUnit, Unit, restored
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.tracker.evaluation.area_metrics import PaperMetrics, ThesisMetrics

RATE_HZ = 15
COLUMNS = ("frames", "s", "found in 2 s [%]")
PAPER = ("DC", "OCR", "OCP", "OCA", "BAP")
BOXES, PEOPLE = "boxes aside [%]", "people aside [%]"


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


@dataclass(frozen=True, slots=True)
class Causes:
    """Metrics of one tracker, counted in all ways of `cause_units`.

    Attributes:
        who: name of the tracker in its lines.
        setting: the tracker.
        groups: data sets that are taken together, by the name of the group.
    """

    who: str
    setting: Setting
    groups: Mapping[str, Sequence[str]]
    id: str = "paper-section-4.2"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Films first, then who sees them."""
        films = [
            FilmUnit(play, plan.cache) for suites in self.groups.values() for play in _plays(plan, suites)
        ]
        tries = [
            unit for group in self.groups for r in range(plan.repeats) for unit in self._units(plan, group, r)
        ]
        return missing(films, done) or missing(tries, done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Add up the runs of each repeat; shares are of what strictly counts."""
        return {
            Line(group, f"{self.who}, {way}" if way else self.who): self._figures(plan, done, group, way)
            for group in self.groups
            for way in WAYS
        }

    def _units(self, plan: Plan, group: str, repeat: int) -> list[CauseUnit]:
        return [
            CauseUnit(play, plan.cache, self.setting, repeat) for play in _plays(plan, self.groups[group])
        ]

    def _figures(self, plan: Plan, done: Done, group: str, way: str) -> dict[str, NDArray[np.float64]]:
        rows = []
        for repeat in range(plan.repeats):
            results = [done[unit.key] for unit in self._units(plan, group, repeat)]
            strict, counted = ([result[name] for result in results] for name in (STRICT, way))
            paper, *more = (restored(PaperMetrics, one["paper"]) for one in counted)
            thesis, *others = (restored(ThesisMetrics, one["thesis"]) for one in counted)
            scores, fits = sum(more, start=paper), sum(others, start=thesis)
            aside = (
                100 * (1 - sum(one[kind] for one in counted) / max(sum(one[kind] for one in strict), 1))
                for kind in ("boxes", "people")
            )
            rows.append((*aside, *(getattr(scores, name.lower()) for name in PAPER), fits.cp))
        return dict(zip((BOXES, PEOPLE, *PAPER, "CP"), np.array(rows).T, strict=True))


def _plays(plan: Plan, suites: Sequence[str]) -> list[SuiteRun]:
    return [play for name in suites for play in plan.suites[name]]
