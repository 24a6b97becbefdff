"""Experiments in which trackers see films: each line is a tracker on some data sets."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from peopleboy.studies.reproductions.experiments.experiment import (
    Chart,
    Done,
    Figures,
    FilmFigure,
    Line,
    Samples,
    missing,
)
from peopleboy.studies.reproductions.measuring.tracker_settings import Changes, Setting
from peopleboy.studies.reproductions.measuring.units import (
    RECORDS,
    Count,
    FilmUnit,
    TrackUnit,
    Unit,
    restored,
)
from peopleboy.studies.reproductions.measuring.workload import Plan

THESIS = ("CR", "CP", "CA", "AR", "AP", "AA")
PAPER = ("OC", "DC", "OCR", "OCP", "OCA", "OAR", "BAP", "ADC")


@dataclass(frozen=True, slots=True)
class TrackerTrial:
    """A tracker on some data sets.

    Attributes:
        line: where its figures go.
        setting: the tracker.
        suites: names of the data sets, taken together.
        rule: for people who are not counted.
        is_quick: whether it is tried as well when time is short.
        quick_changes: further changes of the tracker when time is short.
    """

    line: Line
    setting: Setting
    suites: tuple[str, ...]
    rule: Count = "ignore"
    is_quick: bool = True
    quick_changes: Changes = ()

    def setting_in(self, plan: Plan) -> Setting:
        """Give the tracker as the plan wants it."""
        changes = self.quick_changes if plan.is_quick else ()
        return replace(self.setting, changes=self.setting.changes + changes)


@dataclass(frozen=True, slots=True)
class Tracking:
    """Trackers on data sets, repeated with other random numbers.

    Attributes:
        id: as `experiment.Experiment` says, like `chart` and `plotted`.
        metrics: names of the columns.
        trials: one a line.
    """

    id: str
    metrics: tuple[str, ...]
    trials: tuple[TrackerTrial, ...]
    chart: Chart = "bars"
    plotted: tuple[str, ...] = ()

    @property
    def groups(self) -> list[str]:
        """What is varied, whether or not a quick run has it."""
        return [trial.line.group for trial in self.trials]

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Films first, then who sees them."""
        films = [
            FilmUnit(play, plan.cache)
            for trial in self._trials(plan)
            for name in trial.suites
            for play in plan.plays(name)
        ]
        return missing(films, done) or missing(self._units(plan), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Add up the runs of each repeat, and take the metrics of the sums."""
        return {trial.line: self._figures(trial, plan, done) for trial in self._trials(plan)}

    def _trials(self, plan: Plan) -> list[TrackerTrial]:
        return [trial for trial in self.trials if trial.is_quick or not plan.is_quick]

    def _units(self, plan: Plan) -> Iterator[TrackUnit]:
        for repeat in range(plan.repeats):
            for trial in self._trials(plan):
                yield from units_of(trial, plan, repeat)

    def _figures(self, trial: TrackerTrial, plan: Plan, done: Done) -> dict[str, Figures]:
        first, *others = (
            [done[unit.key][trial.rule] for unit in units_of(trial, plan, repeat)]
            for repeat in range(plan.repeats)
        )
        if not others and len(first) > 1:
            return self._by_films(first, trial.suites)
        rows = np.array([self._row(films) for films in (first, *others)])
        return dict(zip(self.metrics, rows.T, strict=True))

    def _by_films(self, films: list[dict[str, Any]], names: tuple[str, ...]) -> dict[str, Figures]:
        without = np.array([self._row(films[:film] + films[film + 1 :]) for film in range(len(films))])
        return {
            metric: FilmFigure(whole, rest, names)
            for metric, whole, rest in zip(self.metrics, self._row(films), without.T, strict=True)
        }

    def _row(self, films: list[dict[str, Any]]) -> list[float]:
        sums = add_up(films)
        return [metric(sums, name) for name in self.metrics]


def units_of(trial: TrackerTrial, plan: Plan, repeat: int) -> list[TrackUnit]:
    """List the work of one repeat of a trial."""
    return [
        TrackUnit(play, plan.cache, trial.setting_in(plan), repeat)
        for name in trial.suites
        for play in plan.plays(name)
    ]


def add_up(results: list[dict[str, Any]]) -> dict[str, Any]:
    """Take the runs' sums of numerators and denominators together, record by record."""
    totals: dict[str, Any] = {}
    for name, kind in RECORDS.items():
        first, *others = [restored(kind, result[name]) for result in results]
        totals[name] = sum(others, start=first)
    return totals


def metric(sums: dict[str, Any], name: str) -> float:
    """Read a metric off the sums [%]."""
    return float(getattr(sums["thesis" if name in THESIS else "paper"], name.lower()))
