"""Run a suite: every run that is not complete yet, then the scores of all."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path

from peopleboy.scenarios.files.suite import SuiteRun, load_suite, runs_of
from peopleboy.scenarios.progress_bar import progress_bar
from peopleboy.scenarios.running.finished import is_finished
from peopleboy.scenarios.running.frame_cache import Film, film
from peopleboy.scenarios.running.run import RunOptions, run

_RATE_HZ = 15


def run_suite(name: str, options: RunOptions) -> list[Path]:
    """Run a suite, with a bar on standard error; a suite that was killed goes on where it was.

    Complete runs stay; those that were cut off are done again.

    Args:
        name: of the suite.
        options: as for one run; `out` is the folder of the whole suite, and the suite has seeds of its own.

    Returns:
        The runs' folders, in the suite's order.

    Raises:
        BadInput: there is no such suite, or a complete run in its place is another one.
    """
    runs = list(runs_of(load_suite(name)))
    own = [replace(options, seed=one.seed, out=options.out / one.name, record=False) for one in runs]
    waiting = [pair for pair in zip(runs, own, strict=True) if not is_finished(pair[0].scenario, pair[1])]
    total, frame = sum(_frames(one) for one, _ in waiting), count(1)
    with progress_bar(name, unit="frames") as show:

        def run_one(one: SuiteRun, its: RunOptions) -> None:
            run(one.scenario, replace(its, overwrite=True), lambda *_: show(next(frame), total, one.name))

        for one, its in waiting:
            run_one(one, its)
    return [its.out for its in own]


def films_of(name: str, folder: Path) -> Iterator[Film]:
    """Yield the frames of every run of a suite; each is rendered once and then kept."""
    for one in runs_of(load_suite(name)):
        yield film(one.scenario, one.seed, folder)


def _frames(one: SuiteRun) -> int:
    return round(one.scenario.duration_s * _RATE_HZ)
