"""Runs as resumable tasks: suites, and sweeps over seeds or random worlds."""

import logging
import shutil
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.suite import load_suite, runs_of
from peopleboy.scenarios.loop.tracker_by_name import tracker_cameras
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.scenarios.run_folder.atomic_output import check_out
from peopleboy.scenarios.running.engine.task import Task, Tell, Workers
from peopleboy.scenarios.running.engine.work_through import work_through
from peopleboy.scenarios.running.frame_cache import Film, film
from peopleboy.scenarios.running.run import is_finished, run, tracker_name
from peopleboy.scenarios.running.run_options import RunOptions

_RATE_HZ = 15
_ARRIVAL_S = 30.0  # [s] for a run of another machine to be seen in a folder that both share


@dataclass(frozen=True, slots=True, eq=False)
class RunTask:
    """A scenario, and how to run it."""

    scenario: Scenario
    options: RunOptions

    @property
    def name(self) -> str:
        """That of the run's folder."""
        return self.options.out.name

    @property
    def size(self) -> int:
        """Frames."""
        return round(self.scenario.duration_s * _RATE_HZ)

    def __call__(self, tell: Tell) -> None:
        """Run it, unless it is there; what was cut off is replaced."""
        if not is_finished(self.scenario, self.options):
            options = replace(self.options, overwrite=True)
            run(self.scenario, options, lambda tick, _frames: tell(tick.frame))


_LOG = logging.getLogger(__name__)


def unfinished(tasks: Sequence[RunTask]) -> list[RunTask]:
    """Leave out the runs that are there already, so that a killed call goes on.

    Raises:
        BadInput: a run cannot be done, or something else is in its place.
    """
    for task in tasks:
        tracker_cameras(tracker_name(task.scenario, task.options))  # refuses an unknown name
    waiting = [task for task in tasks if not is_finished(task.scenario, task.options)]
    _LOG.info("%d of %d runs are complete already", len(tasks) - len(waiting), len(tasks))
    for task in waiting:
        check_out(task.options.out, "run", overwrite=True)
    return waiting


def play(tasks: Sequence[RunTask], workers: Workers, title: str) -> None:
    """Do all runs, with a bar on standard error.

    Raises:
        BadInput: as for a single run, or the cluster cannot be used.
        TasksFailed: some runs failed, after all others were done.
    """

    def keep(task: Task[None], _result: None) -> None:
        if workers.scheduler is not None and isinstance(task, RunTask):
            _see(task.options.out)

    claimed = [_from_anywhere(_claimed(task)) for task in tasks]
    work_through(claimed, workers, title, keep, unit="frames")


def _claimed(task: RunTask) -> RunTask:
    """Remove an earlier run that is to be replaced, so that one in its place is always the new one."""
    if task.options.overwrite and task.options.out.exists():
        shutil.rmtree(task.options.out)
    return replace(task, options=replace(task.options, overwrite=False))


def _from_anywhere(task: RunTask) -> RunTask:
    """Make it independent of the working directory, which workers keep from when they were started."""
    return replace(task, options=replace(task.options, out=task.options.out.resolve()))


def _see(folder: Path) -> None:
    """Wait until a worker's run can be seen here.

    Raises:
        BadInput: it cannot.
    """
    until = time.monotonic() + _ARRIVAL_S
    while not (folder / "run.json").is_file():
        if time.monotonic() > until:
            raise BadInput(
                f"{folder}: is not where the cluster's workers write; give an --out that all share"
            )
        time.sleep(0.2)


def run_suite(name: str, options: RunOptions, workers: Workers) -> list[Path]:
    """Run a suite, with a bar on standard error; a suite that was killed goes on where it was.

    Complete runs stay; those that were cut off are done again.

    Args:
        name: of the suite.
        options: as for one run; `out` is the folder of the whole suite, and the suite has seeds of its own.
        workers: who does it.

    Returns:
        The runs' folders, in the suite's order.

    Raises:
        BadInput: there is no such suite, or a complete run in its place is another one.
        TasksFailed: some runs failed.
    """
    runs = runs_of(load_suite(name))
    return _run_all([(one.scenario, one.seed, one.name) for one in runs], options, workers, name)


def _run_all(
    runs: Iterable[tuple[Scenario, int, str]], options: RunOptions, workers: Workers, title: str
) -> list[Path]:
    """Run scenarios, each with a seed and in a folder of a name, without recordings; return the folders."""
    tasks = [
        RunTask(
            options.applied_to(scenario), replace(options, seed=seed, out=options.out / name, record=False)
        )
        for scenario, seed, name in runs
    ]
    play(unfinished(tasks), workers, title)
    return [task.options.out for task in tasks]


def films_of(name: str, folder: Path) -> Iterator[Film]:
    """Yield the frames of every run of a suite; each is rendered once and then kept."""
    for one in runs_of(load_suite(name)):
        yield film(one.scenario, one.seed, folder)


def sweep(scenario: str, seeds: Iterable[int], options: RunOptions, workers: Workers) -> list[Path]:
    """Run a scenario once per seed, without recordings; a sweep that was killed goes on where it was.

    Args:
        scenario: name or path.
        seeds: one for each run.
        options: as for one run; `out` is the folder of the whole sweep, and `seed` is not used.
        workers: who does it.

    Returns:
        The folders out/SCENARIO-SEED, in the order of the seeds.

    Raises:
        BadInput: as for a single run, or a complete run in its place is another one.
        TasksFailed: some runs failed.
    """
    loaded = load_scenario(scenario)
    runs = ((loaded, seed, f"{loaded.name}-{seed}") for seed in seeds)
    return _run_all(runs, options, workers, loaded.name)


def sweep_worlds(seeds: Iterable[int], options: RunOptions, workers: Workers) -> list[Path]:
    """Run worlds drawn at random, one for each seed, otherwise as `sweep`.

    Returns:
        The folders out/world_SEED, in the order of the seeds.
    """
    worlds = ((random_scenario(seed), seed) for seed in seeds)
    runs = ((world, seed, world.name) for world, seed in worlds)
    return _run_all(runs, options, workers, "random worlds")
