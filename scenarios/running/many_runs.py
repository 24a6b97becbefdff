"""Runs as resumable tasks: suites, and sweeps over seeds or random worlds."""

import logging
import shutil
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.suite import load_suite, runs_of, scenarios_of
from peopleboy.scenarios.loop.tracker_by_name import tracker_cameras
from peopleboy.scenarios.random_worlds.distribution import Distribution
from peopleboy.scenarios.random_worlds.random_world import LASTS_S, random_scenario, world_name
from peopleboy.scenarios.run_folder.atomic_output import check_out
from peopleboy.scenarios.running.engine.task import ReportProgress, Task, Workers
from peopleboy.scenarios.running.engine.work_through import work_through
from peopleboy.scenarios.running.frame_cache import Film, film
from peopleboy.scenarios.running.run import is_finished, run, tracker_name
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.running.sample_run import sample_run
from peopleboy.tracker.tracker_names import is_detection_file, split_name
from peopleboy.wording import counted

_RATE_HZ = 15
_ARRIVAL_S = 30.0  # [s] timeout for a run of another machine to appear in a shared folder


@dataclass(frozen=True, slots=True, eq=False)
class RunTask:
    """A scenario with the options to run it with.

    Attributes:
        scenario: the scenario; None for the random world of the run's seed, which is sampled when it is
            needed, as there may be 100 000 of them.
        options: options of the run.
        distribution: distribution of the random world; None for the default one.
    """

    scenario: Scenario | None
    options: RunOptions
    distribution: Distribution | None = None

    @property
    def played(self) -> Scenario:
        """The scenario of the run."""
        if self.scenario is not None:
            return self.scenario
        return random_scenario(self.options.seed, distribution=self.distribution)

    @property
    def name(self) -> str:
        """Name of the run's folder."""
        return self.options.out.name

    @property
    def size(self) -> int:
        """Frames."""
        return round((LASTS_S if self.scenario is None else self.scenario.duration_s) * _RATE_HZ)

    @property
    def is_finished(self) -> bool:
        """Whether the run is complete.

        Raises:
            BadInput: the folder holds another complete run, or a damaged one.
        """
        is_there = (self.options.out / "run.json").exists()
        return is_there and is_finished(self.played, self.options)

    def __call__(self, report_progress: ReportProgress) -> None:
        """Run the scenario unless the run is complete; an unfinished run is replaced."""
        if not self.is_finished:
            options = replace(self.options, overwrite=True)
            if options.choice is None:
                run(self.played, options, lambda tick, _frames: report_progress(tick.frame))
            else:
                sample_run(self.played, options, report_progress)


_LOG = logging.getLogger(__name__)


def unfinished(tasks: Sequence[RunTask]) -> list[RunTask]:
    """Return the runs that are not complete, so that a killed command resumes.

    Raises:
        BadInput: a run is invalid, its folder contains something else, or several runs would use one file of
            detections.
    """
    for task in tasks:
        if task.scenario is not None or task is tasks[0]:  # random worlds are refused alike
            scenario = task.options.applied_to(task.played)
            name = tracker_name(scenario, task.options)
            detector = split_name(name)[1]
            if len(tasks) > 1 and is_detection_file(detector):
                raise BadInput(
                    f"{detector}: holds the detections of one run; give --detector to a single run"
                )
            tracker_cameras(name)
    waiting = [task for task in tasks if not task.is_finished]
    _LOG.info("%d of %d runs are complete already", len(tasks) - len(waiting), len(tasks))
    for task in waiting:
        check_out(task.options.out, "run", overwrite=True)
    return waiting


def play(tasks: Sequence[RunTask], workers: Workers, title: str) -> None:
    """Execute all runs, with a progress bar on standard error.

    Raises:
        BadInput: a run is invalid, or the cluster cannot be used.
        TasksFailed: some runs failed, after all others were completed.
    """

    def keep(task: Task[None], _result: None) -> None:
        if workers.scheduler is not None and isinstance(task, RunTask):
            _see(task.options.out)

    claimed = [_from_anywhere(_claimed(task)) for task in tasks]
    work_through(claimed, workers, title, keep, unit="frames")


def _claimed(task: RunTask) -> RunTask:
    """Remove an earlier run that is to be replaced, so that a run in its folder is always the new one."""
    if task.options.overwrite and task.options.out.exists():
        shutil.rmtree(task.options.out)
    return replace(task, options=replace(task.options, overwrite=False))


def _from_anywhere(task: RunTask) -> RunTask:
    """Make a task's paths absolute, because workers keep the working directory they were started in."""
    return replace(task, options=replace(task.options, out=task.options.out.resolve()))


def _see(folder: Path) -> None:
    """Wait until a worker's run is visible on this machine.

    Raises:
        BadInput: the run does not appear in time.
    """
    until = time.monotonic() + _ARRIVAL_S
    while not (folder / "run.json").is_file():
        if time.monotonic() > until:
            raise BadInput(
                f"{folder}: is not where the cluster's workers write; give an --out that all machines share"
            )
        time.sleep(0.2)


def run_suite(name: str, options: RunOptions, workers: Workers) -> list[Path]:
    """Run a suite, with a progress bar on standard error; a killed suite resumes when it is called again.

    Complete runs stay; unfinished runs are repeated.

    Args:
        name: name of the suite.
        options: options of a run; `out` is the folder of the suite, and the suite has its own seeds.
        workers: workers that execute the runs.

    Returns:
        The runs' folders, in the suite's order.

    Raises:
        BadInput: the suite is unknown, or the folder of a run holds another complete run.
        TasksFailed: some runs failed.
    """
    runs = runs_of(load_suite(name))
    return _run_all(((one.scenario, one.seed, one.name) for one in runs), options, workers, name)


def _run_all(
    runs: Iterable[tuple[Scenario | None, int, str]], options: RunOptions, workers: Workers, title: str
) -> list[Path]:
    """Run scenarios with seeds into named folders, without recordings; return the folders."""
    tasks = [
        RunTask(scenario, replace(options, seed=seed, out=options.out / name, record=False))
        for scenario, seed, name in runs
    ]
    play(unfinished(tasks), workers, title)
    return [task.options.out for task in tasks]


def films_of(name: str, folder: Path) -> Iterator[Film]:
    """Yield the cached frames of every run of a suite; each run is rendered only once."""
    for one in runs_of(load_suite(name)):
        yield film(one.scenario, one.seed, folder)


def sweep(
    scenarios: Sequence[str], seeds: Sequence[int], options: RunOptions, workers: Workers
) -> list[Path]:
    """Run scenarios once per seed, without recordings; a killed sweep resumes when it is called again.

    Args:
        scenarios: names or paths of scenarios, or names of suites, which stand for their scenarios.
        seeds: seeds, one per run.
        options: options of a run; `out` is the folder of the sweep, and `seed` is not used.
        workers: workers that execute the runs.

    Returns:
        The folders out/SCENARIO-SEED, in the order of the scenarios, then of the seeds.

    Raises:
        BadInput: a run is invalid, or the folder of a run holds another complete run.
        TasksFailed: some runs failed.
    """
    loaded = scenarios_of(scenarios)
    runs = ((scenario, seed, f"{scenario.name}-{seed}") for scenario in loaded for seed in seeds)
    title = loaded[0].name if len(loaded) == 1 else counted(len(loaded), "scenario")
    return _run_all(runs, options, workers, title)


def sweep_worlds(seeds: Iterable[int], options: RunOptions, workers: Workers) -> list[Path]:
    """Run one random world per seed, otherwise like `sweep`.

    Returns:
        The folders out/world_SEED, in the order of the seeds.
    """
    return _run_all(((None, seed, world_name(seed)) for seed in seeds), options, workers, "random worlds")
