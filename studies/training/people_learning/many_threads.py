"""Work on all cores of this process: what is called releases the lock most of the time."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from typing import Final, TypeVar

Given = TypeVar("Given")
Found = TypeVar("Found")

CORES: Final = os.cpu_count() or 1
_AT_ONCE: Final = 8 * CORES


def in_threads(work: Callable[[Given], Found], items: Iterable[Given]) -> Iterator[Found]:
    """Yield what is found for each item, in their order; little is begun that nobody may ask for."""
    waiting = iter(items)
    with ThreadPoolExecutor(CORES) as pool:
        while some := list(islice(waiting, _AT_ONCE)):
            yield from list(pool.map(work, some))
