"""Announce that numba compiles kernels, which happens once per machine."""

from collections.abc import Iterator
from contextlib import contextmanager

from numba.core import event
from rich.console import Console


class _FirstOne(event.Listener):
    """Print a line when the first kernel is compiled, and nothing for the others."""

    def __init__(self, console: Console) -> None:
        self._console = console
        self._has_announced = False

    def on_start(self, event: event.Event) -> None:
        if not self._has_announced:
            self._has_announced = True
            room = event.data["dispatcher"].__module__.removeprefix("peopleboy.")
            self._console.print(
                f"compiling kernels of {room} and others for this processor, once; it takes one to three "
                "minutes"
            )

    def on_end(self, event: event.Event) -> None:
        pass


@contextmanager
def announced_compiling(console: Console) -> Iterator[None]:
    """Print a line if a kernel is compiled inside the block."""
    with event.install_listener("numba:compile", _FirstOne(console)):
        yield
