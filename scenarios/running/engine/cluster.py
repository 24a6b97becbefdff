"""Run tasks on the workers of a Dask scheduler."""

import re
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.running.engine.task import Failure, Source, Task, attempt, running_source

try:
    from distributed import Client, KilledWorker, as_completed
except ImportError:
    raise BadInput("--scheduler: needs Dask: pip install dask distributed") from None

ADDRESS = r"(tcp|tls|ucx|ws|wss|inproc)://\S+"  # protocols that Dask supports
CONNECT_S = 10.0  # [s] timeout for connecting to the scheduler
WORKERS_S = 30.0  # [s] timeout for the first worker


def on_cluster(tasks: Sequence[Task[Any]], scheduler: str) -> Generator[tuple[int, Any], None, None]:
    """Yield the number of each task with its result or failure, in the order of completion.

    Raises:
        BadInput: the scheduler cannot be reached, or its workers would give different results.
    """
    with _client(scheduler) as client:
        _check_workers(client, scheduler)
        futures = client.map(_attempt_there, tasks, ours=running_source(), pure=False)
        numbers = {future.key: number for number, future in enumerate(futures)}
        done = as_completed(futures)  # type: ignore[no-untyped-call]
        del futures  # releases the results on the cluster
        for future in done:
            number = numbers[future.key]
            yield number, _outcome(tasks[number], future)


def _attempt_there(task: Task[Any], ours: Source) -> Any:
    """Execute a task, unless this worker, which may have joined later, would give a different result."""
    fault = _difference(ours, running_source())
    return Failure(task.name, f"its worker {fault}") if fault else attempt(task, lambda _part: None)


def _outcome(task: Task[Any], future: Any) -> Any:
    try:
        return future.result()
    except KilledWorker:
        return Failure(task.name, "its workers were killed repeatedly, possibly for lack of memory")
    except Exception as error:
        return Failure(task.name, f"was lost by the cluster: {type(error).__name__}")


@contextmanager
def _client(scheduler: str) -> Iterator[Any]:
    if re.fullmatch(ADDRESS, scheduler) is None:
        raise BadInput(f"--scheduler {scheduler}: must be an address such as tcp://10.0.0.1:8786")
    try:
        client = Client(scheduler, timeout=CONNECT_S)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise BadInput(f"--scheduler {scheduler}: cannot be reached: {error}") from None
    with client:
        yield client


def _check_workers(client: Any, scheduler: str) -> None:
    """Refuse a cluster that would give different results from this process.

    Raises:
        BadInput: there is no worker, or one has another version of PeopleBoy or several threads.
    """
    try:
        client.wait_for_workers(1, timeout=WORKERS_S)
    except TimeoutError:
        raise BadInput(f"--scheduler {scheduler}: has no workers; start some with dask worker") from None
    for address, threads in client.nthreads().items():
        if threads > 1:
            raise BadInput(
                f"--scheduler {scheduler}: worker {address} has {threads} threads, but a run needs its own "
                "process; start it with --nthreads 1"
            )
    ours = running_source()
    for address, theirs in client.run(running_source, on_error="return").items():
        fault = "lacks this peopleboy" if isinstance(theirs, Exception) else _difference(ours, theirs)
        if fault:
            raise BadInput(f"--scheduler {scheduler}: worker {address} {fault}; give it the same environment")


def _difference(ours: Source, theirs: Source) -> str:
    """Describe how a worker's source differs; empty if it is the same."""
    for name in ours:
        if ours[name] != theirs.get(name):
            if name == "source":
                return "has a different source of peopleboy"
            return f"has {name} {theirs.get(name, 'missing')} instead of {ours[name]}"
    return ""
