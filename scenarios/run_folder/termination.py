"""A process that is told to end cleans up first, as it does after Ctrl-C."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any, NoReturn

from peopleboy.own_code import Terminated


@contextmanager
def left_by_sigterm() -> Iterator[None]:
    """Let SIGTERM, as `timeout` and a shutdown send it, leave the block by way of all that cleans up.

    The process then ends with the code by which shells know that signal. A handler that somebody else has
    set stays, and so does everything outside the main thread, where none can be set.
    """
    is_main = threading.current_thread() is threading.main_thread()
    before: Any = signal.getsignal(signal.SIGTERM)
    if not is_main or before != signal.SIG_DFL:
        yield
        return
    signal.signal(signal.SIGTERM, _leave)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _leave(number: int, frame: FrameType | None) -> NoReturn:  # noqa: ARG001
    # A second one must not cut the clean-up short.
    signal.signal(number, signal.SIG_IGN)
    raise Terminated(128 + number)
