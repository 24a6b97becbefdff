"""A suite: all its runs, each in a folder of its own."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.suite import load_suite, runs_of
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.scenarios.running.frame_cache import Film, film
from peopleboy.scenarios.running.run import RunOptions
from peopleboy.scenarios.running.run_task import RunTask, play, unfinished


def run_suite(name: str, options: RunOptions, workers: Workers, physics: str | None = None) -> list[Path]:
    """Run a suite, with a bar on standard error; a suite that was killed goes on where it was.

    Complete runs stay; those that were cut off are done again.

    Args:
        name: of the suite.
        options: as for one run; `out` is the folder of the whole suite, and the suite has seeds of its own.
        workers: who does it.
        physics: what moves the robots; None for what the scenarios say.

    Returns:
        The runs' folders, in the suite's order.

    Raises:
        BadInput: there is no such suite, or a complete run in its place is another one.
        TasksFailed: some runs failed.
    """
    tasks = [
        RunTask(
            _moved(one.scenario, physics),
            replace(options, seed=one.seed, out=options.out / one.name, record=False),
        )
        for one in runs_of(load_suite(name))
    ]
    play(unfinished(tasks), workers, name)
    return [task.options.out for task in tasks]


def _moved(scenario: Scenario, physics: str | None) -> Scenario:
    return scenario if physics is None else scenario.moved_by(physics)


def films_of(name: str, folder: Path) -> Iterator[Film]:
    """Yield the frames of every run of a suite; each is rendered once and then kept."""
    for one in runs_of(load_suite(name)):
        yield film(one.scenario, one.seed, folder)
