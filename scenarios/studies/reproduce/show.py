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
from peopleboy.scenarios.studies.reproduce.showing.source import source_tables


def list_experiments(names: Sequence[str]) -> None:
    """Print ids, where they are from, and what they are about."""
    table = Table("id", "source", "what", box=None, header_style="bold")
    for experiment in choose(names):
        about = source_tables()[experiment.id]
        table.add_row(experiment.id, about.source, about.title)
    Console().print(table)


def reproduce_named(names: Sequence[str], out: Path, films: Path, workers: Workers, *, quick: bool) -> Path:
    """Reproduce what is called so, and return the page.

    Raises:
        BadInput: an unknown name, or a folder or cluster that cannot be used.
        TasksFailed: some of it failed, after all else was done.
    """
    experiments = choose(names)
    # Workers may have another working directory.
    plan = quick_plan(films.resolve()) if quick else full_plan(films.resolve())
    return reproduce(experiments, plan, Means(out=out, workers=workers, command=_command(names, quick=quick)))


def _command(names: Sequence[str], *, quick: bool) -> str:
    return shlex.join(["peopleboy", "reproduce", *(["--quick"] if quick else []), *names])
