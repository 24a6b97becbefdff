"""Progress bar on standard error."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from contextvars import ContextVar
from functools import cache
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

_IS_HIDDEN: ContextVar[bool] = ContextVar("is_hidden", default=False)


class Show(Protocol):
    """Moves a bar."""

    def __call__(self, finished: int, total: int, note: str = "") -> None:
        """Return how much is finished, of how much, and what is going on."""
        ...


@contextmanager
def no_progress() -> Iterator[None]:
    """Show no bar in the block."""
    before = _IS_HIDDEN.set(True)
    try:
        yield
    finally:
        _IS_HIDDEN.reset(before)


def progress_console() -> Console:
    """Return the console on which progress is shown; it is silent where nobody reads it."""
    return _console(_IS_HIDDEN.get())


@cache
def _console(is_hidden: bool) -> Console:
    # One for all, as lines of another one would run into what moves on this.
    return Console(stderr=True, quiet=is_hidden)


@contextmanager
def progress_bar(title: str, unit: str | None = None) -> Iterator[Show]:
    """Have a bar on a terminal; it appears when first moved, so that a mistake found before stands alone.

    Args:
        title: stands before the bar.
        unit: what is counted, if the bar is to tell how many a second.
    """
    from peopleboy.scenarios.compiling import announced_compiling  # numba takes a while

    console = progress_console()
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TextColumn("{task.fields[note]}"),
        TimeRemainingColumn(),
    )
    progress = Progress(
        *columns, console=console, refresh_per_second=5, disable=console.quiet or not console.is_terminal
    )
    task = progress.add_task(title, total=None, rate="", note="")
    with ExitStack() as running:
        running.enter_context(announced_compiling(console))

        def show(finished: int, total: int, note: str = "") -> None:
            speed = progress.tasks[0].speed if unit else None
            rate = "" if speed is None else f"{speed:.0f} {unit}/s"
            progress.update(task, completed=finished, total=total, rate=rate, note=note)
            if not progress.live.is_started:
                running.enter_context(progress)

        yield show
