"""Runs of scenarios as tasks: those that are there already are not done again."""

from __future__ import annotations

import shutil
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.tracker_by_name import camera_names
from peopleboy.scenarios.run_folder.output import check_out
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.task import Task, Tell
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.scenarios.running.finished import is_finished
from peopleboy.scenarios.running.run import RunOptions, run, tracker_name

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


def unfinished(tasks: Sequence[RunTask]) -> list[RunTask]:
    """Leave out the runs that are there already, so that a killed call goes on.

    Raises:
        BadInput: a run cannot be done, or something else is in its place.
    """
    for task in tasks:
        camera_names(tracker_name(task.scenario, task.options))  # refuses an unknown name
    waiting = [task for task in tasks if not is_finished(task.scenario, task.options)]
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
