"""The command: which tables and figures there are, and to measure those that are named."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.studies.reproductions.experiments.catalogue import choose
from peopleboy.studies.reproductions.measuring.workload import REPEATS, full_plan, quick_plan
from peopleboy.studies.reproductions.reproduce import Means, reproduce, show_so_far
from peopleboy.studies.reproductions.showing.print_sections import print_sections
from peopleboy.studies.reproductions.showing.source import source_tables


def list_experiments(names: Sequence[str], paper: str | None) -> None:
    """Print ids, where they are from, and what they are about."""
    table = Table("id", "source", "what", box=None, header_style="bold")
    for experiment in choose(names, paper):
        about = source_tables()[experiment.id]
        table.add_row(experiment.id, about.source, about.title)
    Console().print(table)


def reproduce_named(
    names: Sequence[str],
    paper: str | None,
    out: Path,
    films: Path,
    workers: Workers,
    *,
    repeats: int | None,
    works: bool = True,
) -> Path:
    """Reproduce what is called so in a source, or in all, print it, and return the page.

    Args:
        names: ids or numbers; all there are if left out.
        paper: the source to which they are limited.
        out: folder of the page and the results.
        films: folder of rendered frames.
        workers: who does the work.
        repeats: of everything; None for a quick run.
        works: whether what is missing is done; otherwise what is there is shown.

    Raises:
        BadInput: an unknown name, or a folder or cluster that cannot be used.
        TasksFailed: some of it failed, after all else was done.
    """
    experiments = choose(names, paper)
    # Workers may have another working directory.
    cache = films.resolve()
    plan = quick_plan(cache) if repeats is None else full_plan(cache, repeats)
    means = Means(out=out, workers=workers, command=_command(names, paper, repeats))
    page, sections = (reproduce if works else show_so_far)(experiments, plan, means)
    print_sections(sections)
    return page


def _command(names: Sequence[str], paper: str | None, repeats: int | None) -> str:
    chosen = [] if paper is None else ["--paper", paper]
    fewer = [] if repeats == REPEATS else ["--quick"] if repeats is None else ["--repeats", str(repeats)]
    return shlex.join(["peopleboy", "reproduce", *chosen, *fewer, *names])
