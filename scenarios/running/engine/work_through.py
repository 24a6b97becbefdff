"""Execute tasks in one or several processes, store each result at once, and show progress.

joblib provides the processes; if one is killed, only its current task is lost.
"""

import os
import signal
import threading
import time
import warnings
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from functools import cache
from multiprocessing import active_children
from types import FrameType
from typing import Any, TypeVar

import joblib
from joblib.externals.loky.process_executor import BrokenProcessPool

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.progress_bar import Show, progress_bar
from peopleboy.scenarios.run_folder.atomic_output import left_by_signals
from peopleboy.scenarios.running.engine.task import (
    Failure,
    ReportProgress,
    Task,
    TasksFailed,
    Workers,
    attempt,
)

ATTEMPTS = 3  # how often a task's process may be killed
GRACE_S = 10.0  # [s] for processes to mark their work as cut off

Outcomes = Generator[tuple[int, Any], None, None]


def in_processes(tasks: Sequence[Task[Any]], count: int) -> Outcomes:
    """Yield the number of each task with its result or failure, in the order of completion."""
    waiting, deaths = dict(enumerate(tasks)), Counter[int]()
    while waiting:
        begun: list[int] = []
        try:
            with closing(_begin(_next_turn(waiting, deaths), count, begun)) as outcomes:
                for number, outcome in outcomes:
                    del waiting[number]
                    yield number, outcome
        except BrokenProcessPool:
            # One of these tasks killed its process; to find out which, each is now tried alone.
            for number in [number for number in begun if number in waiting]:
                task = waiting.pop(number)
                deaths[number] += 1
                if deaths[number] < ATTEMPTS:
                    waiting[number] = task
                else:
                    yield number, Failure(task.name, _KILLED)


def _next_turn(waiting: Mapping[int, Task[Any]], deaths: Counter[int]) -> Mapping[int, Task[Any]]:
    """Return the next tasks to execute together: all that were never cut off, then the others one by one."""
    never = {number: task for number, task in waiting.items() if not deaths[number]}
    return never or dict([next(iter(waiting.items()))])


_KILLED = f"its process was killed {ATTEMPTS} times, possibly for lack of memory; give fewer --workers"


def _begin(waiting: Mapping[int, Task[Any]], count: int, begun: list[int]) -> Outcomes:
    """Start tasks as processes become free, and append their numbers to `begun`."""

    def calls() -> Iterator[Any]:
        for number, task in list(waiting.items()):
            begun.append(number)
            yield joblib.delayed(_attempt_as_worker)(number, task, os.getpid())

    # One task per batch and no pre-dispatch, so that it is always known which tasks are finished and which
    # were cut off. With n_jobs=1, joblib would execute tasks in this process, which a task may kill.
    parallel = joblib.Parallel(
        n_jobs=max(2, min(count, len(waiting))),
        backend="loky",
        return_as="generator_unordered",
        pre_dispatch="n_jobs",
        batch_size=1,
        max_nbytes=None,
    )
    with _workers_end_first(), _renewed_in_silence(), closing(parallel(calls())) as outcomes:
        yield from outcomes


@contextmanager
def _workers_end_first() -> Iterator[None]:
    """On Ctrl-C and SIGTERM, let the workers clean up before joblib kills them."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before: dict[int, Any] = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}

    def end(number: int, frame: FrameType | None) -> None:
        children = active_children()
        for child in children:
            child.terminate()
        until = time.monotonic() + GRACE_S
        for child in children:
            child.join(max(0.0, until - time.monotonic()))
        before[number](number, frame)

    for number, handler in before.items():
        if callable(handler):
            signal.signal(number, end)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _renewed_in_silence() -> Iterator[None]:
    """Hide the warning when joblib replaces a process that uses 300 MB more than after its first task."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "A worker stopped while some jobs were given", UserWarning)
        yield


def _attempt_as_worker(number: int, task: Task[Any], parent: int) -> tuple[int, Any]:
    # Ctrl-C reaches all processes of a terminal; the parent decides when its workers end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _end_with(parent)
    try:
        with left_by_signals():
            return number, attempt(task, lambda _part: None)
    except SystemExit as leaving:
        # Otherwise joblib would continue with the next task.
        os._exit(leaving.code if isinstance(leaving.code, int) else 1)


@cache
def _end_with(parent: int) -> None:
    """End this process with its parent; a repeated call of the parent writes to the same folders."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=watch, daemon=True).start()


class Tally:
    """Count tasks, and move a progress bar by their sizes."""

    def __init__(self, tasks: Sequence[Task[Any]], show: Show) -> None:
        self._show = show
        self._total = sum(task.size for task in tasks)
        self._left, self._moved = len(tasks), 0
        self._done = self._failed = 0

    def report_progress(self, part: int) -> None:
        """Show that `part` units of the current task are done."""
        failed = f", {self._failed} failed" if self._failed else ""
        self._show(self._moved + part, self._total, f"{self._done} done, {self._left} left{failed}")

    def count(self, task: Task[Any], *, is_failed: bool) -> None:
        """Show that a task has ended."""
        self._moved += task.size
        self._left -= 1
        self._done += not is_failed
        self._failed += is_failed
        self.report_progress(0)


@contextmanager
def tally(title: str, tasks: Sequence[Task[Any]], unit: str | None) -> Iterator[Tally]:
    """Yield a tally with a progress bar on a terminal."""
    with progress_bar(title, unit) as show:
        yield Tally(tasks, show)


Result = TypeVar("Result")


def work_through(
    tasks: Sequence[Task[Result]],
    workers: Workers,
    title: str,
    keep: Callable[[Task[Result], Result], None] = lambda _task, _result: None,
    *,
    unit: str | None = None,
) -> None:
    """Execute all tasks, with a progress bar on standard error.

    A failed task does not stop the others. A task whose worker is killed is repeated, finished tasks are not.
    Ctrl-C and SIGTERM end the workers first, and keep what is finished.

    Args:
        tasks: the tasks; they may finish in any order.
        workers: workers that execute them.
        title: label of the progress bar.
        keep: called in this process with each task and its result, as soon as it is finished.
        unit: unit of the tasks' sizes, to show a rate per second; None shows no rate.

    Raises:
        BadInput: the cluster cannot be used, or every task was refused as bad input.
        TasksFailed: some tasks failed, after all others were completed.
    """
    failures: list[Failure] = []
    with (
        left_by_signals(),
        tally(title, tasks, unit) as shown,
        closing(_outcomes(tasks, workers, shown.report_progress)) as outcomes,
    ):
        for number, outcome in outcomes:
            if isinstance(outcome, Failure):
                failures.append(outcome)
            else:
                keep(tasks[number], outcome)
            shown.count(tasks[number], is_failed=isinstance(outcome, Failure))
    if failures and len(failures) == len(tasks) and all(one.is_refused for one in failures):
        raise BadInput(failures[0].why)
    if failures:
        raise TasksFailed(title, failures, len(tasks))


def _outcomes(
    tasks: Sequence[Task[Result]], workers: Workers, report_progress: ReportProgress
) -> Generator[tuple[int, Any], None, None]:
    """Yield the number of each task with its result or failure, in the order of completion."""
    if not tasks:
        return
    if workers.scheduler is not None:
        from peopleboy.scenarios.running.engine.cluster import on_cluster  # here, as Dask is optional

        yield from on_cluster(tasks, workers.scheduler)
        return
    processes = joblib.cpu_count() if workers.count is None else workers.count
    if min(processes, len(tasks)) > 1:
        yield from in_processes(tasks, processes)
    else:
        yield from ((number, attempt(task, report_progress)) for number, task in enumerate(tasks))
