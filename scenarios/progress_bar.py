"""The bar that tells on standard error how far a command is."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn


class Show(Protocol):
    """Moves a bar."""

    def __call__(self, finished: int, total: int, note: str = "") -> None:
        """Tell how much is finished, of how much, and what is going on."""
        ...


@contextmanager
def progress_bar(title: str, unit: str | None = None) -> Iterator[Show]:
    """Have a bar on a terminal; it appears when first moved, so that a mistake found before is told alone.

    Args:
        title: stands before the bar.
        unit: what is counted, if the bar is to tell how many a second.
    """
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TextColumn("{task.fields[note]}"),
        TimeRemainingColumn(),
    )
    progress = Progress(*columns, console=console, refresh_per_second=5, disable=not console.is_terminal)
    task = progress.add_task(title, total=None, rate="", note="")
    with ExitStack() as running:

        def show(finished: int, total: int, note: str = "") -> None:
            speed = progress.tasks[0].speed if unit else None
            rate = "" if speed is None else f"{speed:.0f} {unit}/s"
            progress.update(task, completed=finished, total=total, rate=rate, note=note)
            if not progress.live.is_started:
                running.enter_context(progress)

        yield show
