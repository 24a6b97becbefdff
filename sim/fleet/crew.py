"""Threads that work for a fleet while Python goes on."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor

Task = Callable[[], None]


class Crew:
    """A number of threads, of which the one that asks is the first; alone it does all itself.

    Args:
        threads: 1 or more; None for as many as there are processors that this process may run on.
    """

    def __init__(self, threads: int | None = None) -> None:
        self.threads = _processors() if threads is None else threads
        self._pool = ThreadPoolExecutor(self.threads - 1) if self.threads > 1 else None

    def start(self, tasks: Sequence[Task]) -> Work:
        """Begin with tasks that do not need each other; they are done when `Work.finish` returns."""
        return Work([(task, None if self._pool is None else self._pool.submit(task)) for task in tasks])

    def close(self) -> None:
        """Let the threads go."""
        if self._pool is not None:
            self._pool.shutdown()


class Work:
    """Tasks under way."""

    def __init__(self, tasks: Sequence[tuple[Task, Future[None] | None]]) -> None:
        self._tasks = list(tasks)

    def finish(self) -> None:
        """Do what nobody has begun with, the last first, and wait for the rest."""
        begun = []
        while self._tasks:
            task, future = self._tasks.pop()
            if future is None or future.cancel():
                task()
            else:
                begun.append(future)
        for future in begun:
            future.result()


def _processors() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
