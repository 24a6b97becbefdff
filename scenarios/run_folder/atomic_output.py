"""Write files and folders atomically, and refuse to replace what must be kept."""

import fcntl
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
from typing import IO, Any, Final, NoReturn

from peopleboy.bad_input import BadInput
from peopleboy.own_code import Terminated

_SIGNALS: Final = (signal.SIGTERM, signal.SIGHUP)
PART: Final = ".part"
"""Suffix of a file that is being written; remains of a killed process may be removed."""


@contextmanager
def left_by_signals() -> Iterator[None]:
    """Make SIGTERM and SIGHUP leave the block with all clean-up.

    They are sent for example by `timeout`, at shutdown, and when a terminal is closed. The process then ends
    with the exit code that shells use for the signal. An existing handler stays (`nohup` ignores SIGHUP), and
    outside the main thread, where no handler can be set, nothing changes.
    """
    is_main = threading.current_thread() is threading.main_thread()
    ours = [one for one in _SIGNALS if is_main and signal.getsignal(one) == signal.SIG_DFL]
    for number in ours:
        signal.signal(number, _leave)
    try:
        yield
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)


def _leave(number: int, frame: FrameType | None) -> NoReturn:  # noqa: ARG001
    # A second signal must not interrupt the clean-up; a closed terminal sends both.
    for one in _SIGNALS:
        signal.signal(one, signal.SIG_IGN)
    raise Terminated(128 + number)


def write_aside(path: Path, content: bytes) -> None:
    """Write a file beside `path` and rename it, so that `path` is never incomplete.

    Raises:
        OSError: it cannot be written; nothing is left of it.
    """
    part = path.with_name(path.name + PART)
    try:
        part.write_bytes(content)
        part.replace(path)
    except OSError:
        with suppress(OSError):
            part.unlink()
        raise


def hold(file: IO[Any]) -> None:
    """Lock an open file until it is closed, or until the process ends, however it ends."""
    with suppress(OSError):  # some network drives have no locks
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


def is_held(path: Path) -> bool:
    """Return whether a running process holds this file."""
    try:
        with path.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False


@contextmanager
def atomic(path: Path, stays: Callable[[], bool] = lambda: False) -> Iterator[Path]:
    """Yield a temporary path beside `path`; the file or folder made there then replaces `path`.

    It does so if the block ends without an error and has made something. After an error or a signal, nothing
    is left; remains of killed processes are removed by the next call.

    Args:
        path: the final file or folder; an existing one is replaced.
        stays: called at the end; returns whether to keep what is at `path` by then.
    """
    part, old = (path.parent / f".{path.name}.{os.getpid()}.{state}" for state in ("new", "old"))
    with left_by_signals():
        _sweep(path)
        try:
            yield part
            if part.exists() and not stays():
                if path.is_dir():  # a folder cannot be replaced atomically
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
    """Remove what processes that no longer run have left beside a file or folder."""
    of_a_process = re.compile(rf"\.{re.escape(path.name)}\.(\d+)\.(new|old)")
    for left in path.parent.iterdir() if path.parent.is_dir() else ():
        found = of_a_process.fullmatch(left.name)
        # An old folder that was being replaced is the only copy until the new one is in place.
        if found and not _is_running(int(found[1])) and (found[2] == "new" or path.exists()):
            _remove(left)


def _is_running(process: int) -> bool:
    """Return whether another process with this number is running."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return process != os.getpid()


def check_out(path: Path, kind: str, *, overwrite: bool) -> None:
    """Refuse an output folder that exists and must not be replaced.

    Args:
        path: the output folder.
        kind: kind of folder that may be replaced, such as "run": a folder with a file KIND.json.
        overwrite: whether such a folder may be replaced.

    Raises:
        BadInput: the folder is of another kind, or may not be replaced.
    """
    check_named(path)
    if not path.exists() or (path.is_dir() and not any(path.iterdir())):
        return
    if not (path / f"{kind}.json").is_file():
        raise BadInput(f"{path}: has no {kind}.json, so it will not be replaced; give another --out")
    if not overwrite:
        raise BadInput(f"{path}: exists already; give --overwrite to replace this {kind}, or another --out")


def check_named(path: Path) -> None:
    """Refuse a path without a name.

    Raises:
        BadInput: the path is empty, or the current folder.
    """
    if not path.name:
        raise BadInput("--out must name a folder, neither '' nor '.'")


@contextmanager
def writing_to(path: Path, option: str = "--out") -> Iterator[None]:
    """Turn an OSError raised inside the block into one line about the path that the user gave.

    Args:
        path: path given by the user.
        option: command-line option of the path.

    Raises:
        BadInput: the path cannot be written to.
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
    """Yield a folder to write to; it takes its final place if the block ends without an error, see `atomic`.

    A file KIND.json describes the folder.

    Args:
        path: the final folder.
        about: contents of that file; may be extended inside the block.
        overwrite: whether an existing folder of this kind may be replaced.
        kind: kind of folder, "export" or "run".

    Raises:
        BadInput: the path exists and must not be replaced, or cannot be written to.
    """
    with writing_to(path):
        check_out(path, kind, overwrite=overwrite)
        with atomic(path) as part:
            part.mkdir(parents=True)
            yield part
            (part / f"{kind}.json").write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")
