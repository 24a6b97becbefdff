"""The bar over many tasks: how many are done, left and failed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from peopleboy.scenarios.progress_bar import Show, progress_bar
from peopleboy.scenarios.running.engine.task import Task


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
