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
    """Function that moves a progress bar."""

    def __call__(self, finished: int, total: int, note: str = "") -> None:
        """Show that `finished` of `total` units are done, with a note on the current state."""
        ...


@contextmanager
def no_progress() -> Iterator[None]:
    """Hide progress bars inside the block."""
    before = _IS_HIDDEN.set(True)
    try:
        yield
    finally:
        _IS_HIDDEN.reset(before)


def progress_console() -> Console:
    """Return the console that shows progress; it is quiet inside `no_progress`."""
    return _console(_IS_HIDDEN.get())


@cache
def _console(is_hidden: bool) -> Console:
    # All progress shares one console: lines printed by a second one would break into the moving bar.
    return Console(stderr=True, quiet=is_hidden)


@contextmanager
def progress_bar(title: str, unit: str | None = None) -> Iterator[Show]:
    """Yield a function that moves a progress bar on a terminal.

    The bar appears when it is first moved, so that an error raised before that stands on a clean line.

    Args:
        title: label of the bar.
        unit: unit of the count, to show a rate per second; None shows no rate.
    """
    from peopleboy.scenarios.compiling import announced_compiling  # here, as importing numba is slow

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
