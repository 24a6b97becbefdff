"""Work that goes on behind a run, in a thread of its own, so that the run need not wait for files."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final

MOST: Final = 64
"""How much work may wait; whoever brings more waits until some is done."""


class Behind:
    """Does one piece of work after the other, in the order in which they came, and drops none.

    What a piece of work raises is raised by the next call of `add` or `flush` that finds it.
    """

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1)
        self._waiting: deque[Future[None]] = deque()

    def add(self, work: Callable[[], None]) -> None:
        """Let this be done after what was added before."""
        while self._waiting and (len(self._waiting) >= MOST or self._waiting[0].done()):
            self._waiting.popleft().result()
        self._waiting.append(self._thread.submit(work))

    def flush(self) -> None:
        """Wait until all is done."""
        while self._waiting:
            self._waiting.popleft().result()

    def close(self) -> None:
        """Do what is left, and end the thread; errors of it are told nobody, who has one already."""
        self._thread.shutdown()
