"""A file or folder that is there whole or not at all."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from peopleboy.scenarios.run_folder.termination import left_by_sigterm


@contextmanager
def whole(path: Path, stays: Callable[[], bool] = lambda: False) -> Iterator[Path]:
    """Give a path beside the one asked for, at which to make a file or folder that then takes its place.

    It does so when the block ends well and has made something. Nothing of it is left if the block ends
    otherwise, by a signal too, and what a process that was killed has left is removed by the next one.

    Args:
        path: the file or folder asked for; what lies there is replaced.
        stays: asked at the end whether what lies there by then stays after all.
    """
    part, old = (path.parent / f".{path.name}.{os.getpid()}.{state}" for state in ("new", "old"))
    with left_by_sigterm():
        _sweep(path)
        try:
            yield part
            if part.exists() and not stays():
                if path.is_dir():  # which cannot be replaced at one stroke
                    path.rename(old)
                part.replace(path)
        finally:
            if old.exists() and not path.exists():
                old.rename(path)
            for rest in (part, old):
                _remove(rest)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink()


def _sweep(path: Path) -> None:
    """Remove what processes that are no more have left beside a file or folder."""
    of_a_process = re.compile(rf"\.{re.escape(path.name)}\.(\d+)\.(new|old)")
    for left in path.parent.iterdir() if path.parent.is_dir() else ():
        found = of_a_process.fullmatch(left.name)
        # An earlier folder that was to be replaced is all there is until the new one has its place.
        if found and not _is_running(int(found[1])) and (found[2] == "new" or path.exists()):
            _remove(left)


def _is_running(process: int) -> bool:
    """Tell whether another process has this number."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return process != os.getpid()
