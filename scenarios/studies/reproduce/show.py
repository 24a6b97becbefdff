"""The command: which tables and figures there are, and a bar while they are measured."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from peopleboy.scenarios.progress_bar import progress_bar
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


def reproduce_with_progress(
    names: Sequence[str], out: Path, films: Path, jobs: int | None, scheduler: str | None, *, quick: bool
) -> Path:
    """Reproduce with a progress bar on standard error, and return the page.

    Raises:
        BadInput: an unknown name, or a folder or scheduler that cannot be used.
    """
    experiments = choose(names)
    # Workers may have another working directory.
    plan = quick_plan(films.resolve()) if quick else full_plan(films.resolve())
    means = Means(
        out=out, jobs=-1 if jobs is None else jobs, scheduler=scheduler, command=_command(names, quick=quick)
    )
    with progress_bar("reproduce") as show:

        def report(finished: int, total: int, last: str) -> None:
            show(finished, total, last.split(" ")[0])

        return reproduce(experiments, plan, means, report)


def _command(names: Sequence[str], *, quick: bool) -> str:
    return shlex.join(["peopleboy", "reproduce", *(["--quick"] if quick else []), *names])
