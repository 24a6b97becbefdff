"""Work through tasks, keep each result at once, and show progress."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, contextmanager
from typing import Any, TypeVar

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.progress_bar import Show, progress_bar
from peopleboy.scenarios.run_folder.atomic_output import left_by_sigterm
from peopleboy.scenarios.running.engine.processes import in_processes
from peopleboy.scenarios.running.engine.task import Failure, Task, TasksFailed, Tell, Workers, attempt


class Tally:
    """Counts tasks, and moves a bar by their sizes."""

    def __init__(self, tasks: Sequence[Task[Any]], show: Show) -> None:
        self._show = show
        self._total = sum(task.size for task in tasks)
        self._left, self._moved = len(tasks), 0
        self._done = self._failed = 0

    def tell(self, part: int) -> None:
        """Show that so much of the task that is going on is done."""
        failed = f", {self._failed} failed" if self._failed else ""
        self._show(self._moved + part, self._total, f"{self._done} done, {self._left} left{failed}")

    def count(self, task: Task[Any], *, is_failed: bool) -> None:
        """Show that a task has come to its end."""
        self._moved += task.size
        self._left -= 1
        self._done += not is_failed
        self._failed += is_failed
        self.tell(0)


@contextmanager
def tally(title: str, tasks: Sequence[Task[Any]], unit: str | None) -> Iterator[Tally]:
    """Have such a bar on a terminal."""
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
    """Do all tasks, with a bar on standard error.

    One that fails stops no other. One whose worker is killed is done again, and none that is finished. Ctrl-C
    and SIGTERM end the workers first, and leave what is finished.

    Args:
        tasks: in any order, since they are finished in any.
        workers: who does them.
        title: stands before the bar.
        keep: called in this process with each task and its result, as soon as it is finished.
        unit: in which the tasks' sizes are counted, if the bar is to tell how many a second.

    Raises:
        BadInput: the cluster cannot be used, or every single task was refused as bad input.
        TasksFailed: some failed, after all others were done.
    """
    failures: list[Failure] = []
    with (
        left_by_sigterm(),
        tally(title, tasks, unit) as shown,
        closing(_outcomes(tasks, workers, shown.tell)) as outcomes,
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
    tasks: Sequence[Task[Result]], workers: Workers, tell: Tell
) -> Generator[tuple[int, Any], None, None]:
    """Yield the number of each task with its result or failure, as they are finished."""
    if not tasks:
        return
    if workers.scheduler is not None:
        from peopleboy.scenarios.running.engine.cluster import on_cluster  # here, as Dask is an extra

        yield from on_cluster(tasks, workers.scheduler)
    elif min(workers.count, len(tasks)) > 1:
        yield from in_processes(tasks, workers.count)
    else:
        yield from ((number, attempt(task, tell)) for number, task in enumerate(tasks))
