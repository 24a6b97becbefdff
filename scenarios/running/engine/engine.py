"""Work through tasks: what is finished is kept at once, whatever dies or fails afterwards."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from typing import Any, TypeVar

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.output import left_by_sigterm
from peopleboy.scenarios.running.engine.processes import in_processes
from peopleboy.scenarios.running.engine.tally import tally
from peopleboy.scenarios.running.engine.task import Failure, Task, TasksFailed, Tell, attempt
from peopleboy.scenarios.running.engine.workers import Workers

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
