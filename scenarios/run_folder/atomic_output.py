"""Write files and folders whole or not at all, and refuse to replace what must stay."""

import json
import os
import re
import shutil
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

from peopleboy.bad_input import BadInput
from peopleboy.own_code import Terminated


@contextmanager
def left_by_sigterm() -> Iterator[None]:
    """Let SIGTERM, as `timeout` and a shutdown send it, leave the block by way of all that cleans up.

    The process then ends with the code by which shells know that signal. A handler that another person has
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


@contextmanager
def atomic(path: Path, stays: Callable[[], bool] = lambda: False) -> Iterator[Path]:
    """Return a path beside the one asked for, at which to make a file or folder that then takes its place.

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
    """Return whether another process has this number."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return process != os.getpid()


def check_out(path: Path, kind: str, *, overwrite: bool) -> None:
    """Refuse a folder to write where something lies that must stay.

    Args:
        path: the folder to write.
        kind: what may lie there, such as "run": a folder with a file KIND.json.
        overwrite: whether such a one may be replaced.

    Raises:
        BadInput: there is something else, or it may not be replaced.
    """
    check_named(path)
    if not path.exists() or (path.is_dir() and not any(path.iterdir())):
        return
    if not (path / f"{kind}.json").is_file():
        raise BadInput(f"{path}: is no {kind} and will not be replaced; give another --out")
    if not overwrite:
        raise BadInput(f"{path}: exists already; give --overwrite to replace this {kind}, or another --out")


def check_named(path: Path) -> None:
    """Refuse a path without a name of its own.

    Raises:
        BadInput: it is empty, or the folder that the user is in.
    """
    if not path.name:
        raise BadInput("--out must name a folder, neither '' nor '.'")


@contextmanager
def writing_to(path: Path, option: str = "--out") -> Iterator[None]:
    """Turn what keeps the block from writing into one line about the path that the user gave.

    Args:
        path: given by the user.
        option: by which it was given.

    Raises:
        BadInput: it cannot be written to.
    """
    try:
        yield
    except OSError as error:
        raise BadInput(
            f"{path}: cannot write here: {error.strerror or error}; give another {option}"
        ) from error


@contextmanager
def atomic_folder(
    path: Path, about: dict[str, Any], *, overwrite: bool, kind: str = "export"
) -> Iterator[Path]:
    """Return a folder to write to, which takes its place when the block ends well, see `atomic`.

    A file KIND.json says what the folder is.

    Args:
        path: the folder asked for.
        about: what that file is to say; it may grow inside the block.
        overwrite: whether an earlier folder of this kind there may be replaced.
        kind: what the folder is, "export" or "run".

    Raises:
        BadInput: there is something at this path that must not be replaced, or it cannot be written to.
    """
    with writing_to(path):
        check_out(path, kind, overwrite=overwrite)
        with atomic(path) as part:
            part.mkdir(parents=True)
            yield part
            (part / f"{kind}.json").write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")
