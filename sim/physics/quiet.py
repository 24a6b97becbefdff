"""Keeps the noise that C libraries write straight to file descriptors away from the user."""

from __future__ import annotations

import contextlib
import ctypes
import os
import sys
from collections.abc import Iterator

_LIBC = ctypes.CDLL(None)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Send everything written to file descriptors 1 and 2 inside the block to the null device.

    Descriptors that are closed stay closed; what was buffered before the block still appears.
    """
    _flush()
    with contextlib.ExitStack() as stack:
        for descriptor in (1, 2):
            stack.enter_context(_muted(descriptor))
        yield
        # C's buffers would otherwise be written out after the descriptors are back.
        _flush()


@contextlib.contextmanager
def _muted(descriptor: int) -> Iterator[None]:
    try:
        saved = os.dup(descriptor)
    except OSError:
        yield
        return
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, descriptor)
    os.close(null)
    try:
        yield
    finally:
        os.dup2(saved, descriptor)
        os.close(saved)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            with contextlib.suppress(OSError, ValueError):
                stream.flush()
    _LIBC.fflush(None)
