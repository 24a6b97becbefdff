"""Matrix products by one thread: with several, their last digits hang on how many there are."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from functools import cache

from threadpoolctl import ThreadpoolController


def one_thread() -> AbstractContextManager[object]:
    """Let NumPy multiply matrices by one thread for a while; small ones take no longer."""
    if all(library.num_threads == 1 for library in _controller().lib_controllers):
        return nullcontext()
    limited: AbstractContextManager[object] = _controller().limit(limits=1)
    return limited


@cache
def _controller() -> ThreadpoolController:
    return ThreadpoolController().select(user_api="blas")
