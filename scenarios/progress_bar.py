"""Progress on standard error: a moving bar on a terminal, lines elsewhere."""

import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from contextvars import ContextVar
from enum import StrEnum
from functools import cache
from typing import Final, Protocol

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

EVERY_S: Final = 30.0  # [s] time between two lines; a shorter command prints none unless asked for lines


class ProgressStyle(StrEnum):
    """How progress is shown."""

    AUTO = "auto"  # a bar on a terminal, lines elsewhere
    PLAIN = "plain"  # lines everywhere
    HIDDEN = "hidden"


_STYLE: ContextVar[ProgressStyle] = ContextVar("style", default=ProgressStyle.AUTO)


class Show(Protocol):
    """Function that shows progress."""

    def __call__(self, finished: int, total: int, note: str = "") -> None:
        """Show that `finished` of `total` units are done, with a note on the current state."""
        ...


@contextmanager
def progress_as(style: ProgressStyle) -> Iterator[None]:
    """Show progress in this style inside the block."""
    before = _STYLE.set(style)
    try:
        yield
    finally:
        _STYLE.reset(before)


def progress_console() -> Console:
    """Return the console that shows progress; it is quiet if progress is hidden."""
    return _console(_STYLE.get() is ProgressStyle.HIDDEN)


@cache
def _console(is_hidden: bool) -> Console:
    # All progress shares one console: lines printed by a second one would break into the moving bar.
    return Console(stderr=True, quiet=is_hidden)


@contextmanager
def progress_bar(title: str, unit: str | None = None) -> Iterator[Show]:
    """Yield a function that moves a progress bar on a terminal, or prints lines from time to time.

    The bar appears when it is first moved, so that an error raised before that stands on a clean line.

    Args:
        title: label of the bar.
        unit: unit of the count, to show a rate per second; None shows no rate.
    """
    from peopleboy.scenarios.compiling import announced_compiling  # here, as importing numba is slow

    console, style = progress_console(), _STYLE.get()
    with ExitStack() as running:
        if console.is_terminal or style is ProgressStyle.PLAIN:
            running.enter_context(announced_compiling(console))
        if style is ProgressStyle.AUTO and console.is_terminal:
            yield _bar(title, unit, console, running)
        elif style is ProgressStyle.HIDDEN:
            yield _hide
        else:
            lines = ProgressLines(title, unit, is_short_shown=style is ProgressStyle.PLAIN)
            yield lines.show
            lines.finish()


def _hide(finished: int, total: int, note: str = "") -> None:
    """Show nothing."""


def _bar(title: str, unit: str | None, console: Console, running: ExitStack) -> Show:
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[rate]}"),
        TextColumn("{task.fields[note]}"),
        TimeRemainingColumn(),
    )
    progress = Progress(*columns, console=console, refresh_per_second=5)
    task = progress.add_task(title, total=None, rate="", note="")

    def show(finished: int, total: int, note: str = "") -> None:
        speed = progress.tasks[0].speed if unit else None
        rate = "" if speed is None else f"{speed:.0f} {unit}/s"
        progress.update(task, completed=finished, total=total, rate=rate, note=note)
        if not progress.live.is_started:
            running.enter_context(progress)

    return show


class ProgressLines:
    """Print progress as one line every `EVERY_S` seconds, for logs.

    Args:
        title: label of the lines.
        unit: unit of the count, to show a rate per second; None shows no rate.
        is_short_shown: whether work that ends before the first line is due gets a line as well.
    """

    def __init__(self, title: str, unit: str | None, *, is_short_shown: bool) -> None:
        self._title, self._unit = title, unit
        self._is_due_at_end = is_short_shown
        self._last_s = time.monotonic()
        self._first: tuple[int, float] | None = None  # units, time; before, kernels may have been compiled
        self._state: tuple[int, int, str] | None = None

    def show(self, finished: int, total: int, note: str = "") -> None:
        """Take the state, and print it if a line is due."""
        self._state = finished, total, note
        self._first = self._first or (finished, time.monotonic())
        if time.monotonic() - self._last_s >= EVERY_S:
            self._print()
            self._is_due_at_end = True

    def finish(self) -> None:
        """Print the last state, unless the work was short."""
        if self._is_due_at_end and self._state is not None:
            self._print()

    def _print(self) -> None:
        if self._state is None or self._first is None:
            return
        (finished, total, note), (first, first_s) = self._state, self._first
        self._state, self._last_s = None, time.monotonic()
        rate = (finished - first) / max(self._last_s - first_s, 1e-3)
        parts = [f"{finished} of {total} {self._unit or ''}".rstrip()]
        if self._unit and rate > 0.0:
            parts.append(f"{rate:.0f} {self._unit}/s")
        parts += [note] if note else []
        if rate > 0.0 and finished < total:
            parts.append(f"{_duration((total - finished) / rate)} left")
        click.echo(f"{self._title}: {', '.join(parts)}", err=True)


def _duration(seconds: float) -> str:
    """Format a duration: 40 s, 12 min, 3.5 h."""
    if seconds < 60.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 3600.0 else f"{seconds / 3600.0:.1f} h"
