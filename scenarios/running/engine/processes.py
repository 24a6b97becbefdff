"""Run tasks in several processes by joblib; a killed process costs only its current task."""

from __future__ import annotations

import os
import signal
import threading
import time
import warnings
from collections import Counter
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from functools import cache
from multiprocessing import active_children
from types import FrameType
from typing import Any

import joblib
from joblib.externals.loky.process_executor import BrokenProcessPool

from peopleboy.scenarios.run_folder.atomic_output import left_by_sigterm
from peopleboy.scenarios.running.engine.task import Failure, Task, attempt

ATTEMPTS = 3  # how often a task's process may be killed
GRACE_S = 10.0  # [s] for processes to write down that their work was cut off

Outcomes = Generator[tuple[int, Any], None, None]


def in_processes(tasks: Sequence[Task[Any]], count: int) -> Outcomes:
    """Yield the number of each task with its result or failure, as they are finished."""
    waiting, deaths = dict(enumerate(tasks)), Counter[int]()
    while waiting:
        begun: list[int] = []
        try:
            with closing(_begin(_next_turn(waiting, deaths), count, begun)) as outcomes:
                for number, outcome in outcomes:
                    del waiting[number]
                    yield number, outcome
        except BrokenProcessPool:
            # One of these killed its process, nobody knows which: each is tried by itself from now on.
            for number in [number for number in begun if number in waiting]:
                task = waiting.pop(number)
                deaths[number] += 1
                if deaths[number] < ATTEMPTS:
                    waiting[number] = task
                else:
                    yield number, Failure(task.name, _KILLED)


def _next_turn(waiting: Mapping[int, Task[Any]], deaths: Counter[int]) -> Mapping[int, Task[Any]]:
    """Return what is done together next: all that was never cut off, then the others one by one."""
    never = {number: task for number, task in waiting.items() if not deaths[number]}
    return never or dict([next(iter(waiting.items()))])


_KILLED = f"its process was killed {ATTEMPTS} times, perhaps for want of memory; give fewer --workers"


def _begin(waiting: Mapping[int, Task[Any]], count: int, begun: list[int]) -> Outcomes:
    """Begin tasks as processes get free, and note their numbers."""

    def calls() -> Iterator[Any]:
        for number, task in list(waiting.items()):
            begun.append(number)
            yield joblib.delayed(_attempt_as_worker)(number, task, os.getpid())

    # A batch is one task, and none is sent early, so that it is known at once what is finished and what was
    # cut off. With a single process joblib would work in this one, which a task may kill.
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
    """At Ctrl-C and SIGTERM let the workers clean up before joblib kills them."""
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
    """Say nothing of a process that joblib replaces, since it holds 300 MB more than after its first task."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "A worker stopped while some jobs were given", UserWarning)
        yield


def _attempt_as_worker(number: int, task: Task[Any], parent: int) -> tuple[int, Any]:
    # Ctrl-C reaches all processes of a terminal; the parent decides for its workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _end_with(parent)
    try:
        with left_by_sigterm():
            return number, attempt(task, lambda _part: None)
    except SystemExit as leaving:
        # Joblib would go on with the next task.
        os._exit(leaving.code if isinstance(leaving.code, int) else 1)


@cache
def _end_with(parent: int) -> None:
    """Let this process end when its parent is no more, whose next call would write to the same folders."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=watch, daemon=True).start()
