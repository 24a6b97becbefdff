"""Measure the tables and figures of the sources again, and write the page."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.running.engine.store import Store
from peopleboy.scenarios.running.engine.task import Failure, TasksFailed
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.studies.reproductions.experiments.experiment import Experiment, Outcome
from peopleboy.studies.reproductions.measuring.run_units import open_store, run_units
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.studies.reproductions.showing.against_source import mean_and_spread
from peopleboy.studies.reproductions.showing.page_head import head_of
from peopleboy.studies.reproductions.showing.source_page import Section, section, write_page

PAGE = "index.html"
RESULTS = "units.jsonl"
MEANS = "figures.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class Means:
    """With what the work is done.

    Attributes:
        out: folder of the page and the results.
        workers: who does it.
        command: by which the user began it.
    """

    out: Path
    workers: Workers = field(default_factory=Workers)
    command: str = "peopleboy reproduce"


def reproduce(experiments: Sequence[Experiment], plan: Plan, means: Means) -> tuple[Path, list[Section]]:
    """Do what is missing, and write the page, and the means of all figures beside it.

    Whoever is killed begins again with the same folder: results that are there are taken from there. What
    cannot be finished, since work failed, is left off the page.

    Returns:
        The page, and what is on it.

    Raises:
        BadInput: the folder or the cluster cannot be used.
        TasksFailed: some of it failed, after all else was done.
    """
    store = open_store(means.out / RESULTS)
    failures = work_off(experiments, plan, store, means.workers)
    shown = _write(experiments, plan, means, store)
    if failures:
        raise TasksFailed("reproduce", failures, len(store) + len(failures))
    return shown


def show_so_far(experiments: Sequence[Experiment], plan: Plan, means: Means) -> tuple[Path, list[Section]]:
    """Write the page of what the folder has, each part with as many repeats as it has, and do no work.

    Raises:
        BadInput: nothing is finished there.
    """
    return _write(experiments, plan, means, open_store(means.out / RESULTS))


def work_off(experiments: Sequence[Experiment], plan: Plan, store: Store, workers: Workers) -> list[Failure]:
    """Do what is missing, and what that makes possible; what fails stops nothing that does without it.

    Raises:
        BadInput: the cluster cannot be used.
    """
    failures: dict[str, Failure] = {}
    while wanted := [unit for unit in unique_units(experiments, plan, store) if unit.key not in failures]:
        try:
            run_units(wanted, store, workers)
        except TasksFailed as failed:
            failures |= {one.name: one for one in failed.failures}
    return list(failures.values())


def finished(experiments: Sequence[Experiment], plan: Plan, store: Store) -> tuple[list[Outcome], list[str]]:
    """Give what has come out, each part with as many repeats as it has, and the ids of what is not finished.

    Raises:
        BadInput: nothing is finished.
    """
    found = {one.id: Outcome.so_far(one, plan, store) for one in experiments}
    outcomes = [one for one in found.values() if one is not None]
    if not outcomes:
        raise BadInput(f"{store.path}: no table or figure is finished there")
    return outcomes, [number for number, one in found.items() if one is None]


def _write(
    experiments: Sequence[Experiment], plan: Plan, means: Means, store: Store
) -> tuple[Path, list[Section]]:
    outcomes, missing = finished(experiments, plan, store)
    (means.out / MEANS).write_text(json.dumps(_means(outcomes), indent=1) + "\n", encoding="utf-8")
    sections, page = [section(one) for one in outcomes], means.out / PAGE
    write_page(page, sections, head_of(plan, outcomes, store, command=means.command, missing=missing))
    return page, sections


def _means(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """Give the mean of every figure by experiment, group, whose it is, and column; None for NaN."""
    tables: dict[str, Any] = {}
    for outcome in outcomes:
        table = tables.setdefault(outcome.experiment.id, {})
        for line, figures in outcome.samples.items():
            row = {name: mean_and_spread(values)[0] for name, values in figures.items()}
            plain = {name: None if math.isnan(mean) else mean for name, mean in row.items()}
            table.setdefault(line.group, {})[line.who] = plain
    return tables


def unique_units(experiments: Sequence[Experiment], plan: Plan, store: Store) -> list[Unit]:
    """List the work that can be begun now; what several experiments need is done once."""
    units = {unit.key: unit for one in experiments for unit in one.wants(plan, store)}
    return list(units.values())
