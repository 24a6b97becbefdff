"""The command: which tables and figures there are, and to measure those that are named."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.scenarios.studies.reproduce.experiments.catalogue import choose
from peopleboy.scenarios.studies.reproduce.measuring.workload import full_plan, quick_plan
from peopleboy.scenarios.studies.reproduce.reproduce import Means, reproduce
from peopleboy.scenarios.studies.reproduce.showing.print_sections import print_sections
from peopleboy.scenarios.studies.reproduce.showing.source import source_tables


def list_experiments(names: Sequence[str], paper: str | None) -> None:
    """Print ids, where they are from, and what they are about."""
    table = Table("id", "source", "what", box=None, header_style="bold")
    for experiment in choose(names, paper):
        about = source_tables()[experiment.id]
        table.add_row(experiment.id, about.source, about.title)
    Console().print(table)


def reproduce_named(
    names: Sequence[str], paper: str | None, out: Path, films: Path, workers: Workers, *, quick: bool
) -> Path:
    """Reproduce what is called so in a source, or in all, print it, and return the page.

    Raises:
        BadInput: an unknown name, or a folder or cluster that cannot be used.
        TasksFailed: some of it failed, after all else was done.
    """
    experiments = choose(names, paper)
    # Workers may have another working directory.
    plan = quick_plan(films.resolve()) if quick else full_plan(films.resolve())
    means = Means(out=out, workers=workers, command=_command(names, paper, quick=quick))
    page, sections = reproduce(experiments, plan, means)
    print_sections(sections)
    return page


def _command(names: Sequence[str], paper: str | None, *, quick: bool) -> str:
    chosen = [] if paper is None else ["--paper", paper]
    return shlex.join(["peopleboy", "reproduce", *chosen, *(["--quick"] if quick else []), *names])
