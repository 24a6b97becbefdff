"""Measure the tables and figures of the sources again, and write the page."""

from __future__ import annotations

import json
import math
import os
import platform
import time
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.folder import versions
from peopleboy.scenarios.running.engine.store import Store
from peopleboy.scenarios.running.engine.task import Failure, TasksFailed
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.scenarios.studies.reproduce.experiments.catalogue import paper_of
from peopleboy.scenarios.studies.reproduce.experiments.experiment import Experiment, Outcome
from peopleboy.scenarios.studies.reproduce.measuring.run_units import open_store, run_units
from peopleboy.scenarios.studies.reproduce.measuring.units import Unit
from peopleboy.scenarios.studies.reproduce.measuring.workload import QUICK_S, Plan, full_plan
from peopleboy.scenarios.studies.reproduce.showing.against_source import mean_and_spread
from peopleboy.scenarios.studies.reproduce.showing.source_page import PageHead, Section, section, write_page

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
    start = time.monotonic()
    store = open_store(means.out / RESULTS)
    failures = work_off(experiments, plan, store, means.workers)
    shown = _write(experiments, plan, means, store, time.monotonic() - start)
    if failures:
        raise TasksFailed("reproduce", failures, len(store) + len(failures))
    return shown


def show_so_far(experiments: Sequence[Experiment], plan: Plan, means: Means) -> tuple[Path, list[Section]]:
    """Write the page of what the folder has, each part with as many repeats as it has, and do no work.

    Raises:
        BadInput: nothing is finished there.
    """
    return _write(experiments, plan, means, open_store(means.out / RESULTS), 0.0)


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


def _write(
    experiments: Sequence[Experiment], plan: Plan, means: Means, store: Store, seconds: float
) -> tuple[Path, list[Section]]:
    found = [Outcome.so_far(one, plan, store) for one in experiments]
    outcomes = [one for one in found if one is not None]
    if not outcomes:
        raise BadInput(f"{means.out / RESULTS}: no table or figure is finished there; leave out --so-far")
    (means.out / MEANS).write_text(json.dumps(_means(outcomes), indent=1) + "\n", encoding="utf-8")
    sections, page = [section(one) for one in outcomes], means.out / PAGE
    missing = [one.id for one, outcome in zip(experiments, found, strict=True) if outcome is None]
    facts = {"Not finished": ", ".join(missing)} if missing else {}
    head = _about(plan, outcomes, means, store, seconds)
    write_page(page, sections, replace(head, facts={**facts, **head.facts}))
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


def _about(plan: Plan, outcomes: Sequence[Outcome], means: Means, store: Store, seconds: float) -> PageHead:
    papers = {paper_of(one.experiment.id) for one in outcomes}
    repeats = {one.repeats for one in outcomes if one.repeats is not None}
    spent = sum(store.spent_s(key) for key in store)
    facts: Mapping[str, str] = {
        "Versions": ", ".join(f"{name} {number}" for name, number in versions().items()),
        "Python": platform.python_version(),
        "Seeds": f"random streams of the trackers, and webcams, 0 to {plan.repeats - 1}; people before a "
        f"panoramic camera 0 to {plan.walks - 1}; drives with a depth camera 0 to {plan.drives - 1}; "
        "data sets as in their files",
        "Machine": f"{os.cpu_count()} cores, {platform.machine()}, {platform.system()}",
        "Time": f"{seconds / 60:.1f} min for this call; {spent / 3600:.2f} core-hours for all results, "
        "those of earlier calls included",
        "Results": f"{len(store)} units of work in {RESULTS}, beside this page",
    }
    return PageHead(
        command=means.command, is_quick=plan.is_quick, amount=_amount(plan, papers, repeats), facts=facts
    )


def _share(plan: Plan) -> str:
    """Say how much of the data sets a quick run sees."""
    seen, there = (
        sum(play.scenario.duration_s for plays in suites.values() for play in plays)
        for suites in (plan.suites, full_plan(plan.cache).suites)
    )
    return f"{seen:.0f} of {there:.0f} s"


def _amount(plan: Plan, papers: Set[str], repeats: Set[int]) -> str:
    runs = {name: len(plays) for name, plays in plan.suites.items()}
    if plan.is_quick:
        return (
            f"One run per data set and of it {QUICK_S:g} s at most ({_share(plan)}), {plan.repeats} repeats "
            "instead of 10, fewer values of each parameter (each section says which are left out), "
            "figure 6.6 with 200 samples instead of 1000, pairs of people "
            f"from one run per scenario, no weighted triplets, {plan.walks} panoramic films of each room, "
            f"{plan.drive_s:g} s of {len(plan.sets)} of the 12 drives with a depth camera, "
            f"{len(plan.scenes)} of the 17 films of things that are moved."
        )
    if papers == {"panoramic"}:
        return f"{plan.walks} films of each room, and {plan.repeats} by webcams."
    if papers == {"situation"}:
        return (
            f"{plan.drives} runs of each of {len(plan.sets)} drives, {plan.ablated} where trackers differ in "
            f"one thing or the noise is varied, {2 * plan.drives} where odometry is left out; "
            f"{plan.scene_seeds} of each of {len(plan.scenes)} films of moved things, by {len(plan.presets)} "
            f"depth cameras. {plan.drives} runs of each film of attention, {plan.absences} of each absence, "
            f"{plan.follows} of followers."
        )
    total = ", ".join(f"{name}: {count} runs" for name, count in runs.items())
    count = f"{min(repeats)} to {max(repeats)}, as each part says," if len(repeats) > 1 else f"{plan.repeats}"
    return f"{count} repeats of everything with other random numbers in the trackers. {total}."
