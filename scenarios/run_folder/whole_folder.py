"""A folder that is there whole or not at all."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from peopleboy.scenarios.run_folder.out_folder import check_out, writing_to
from peopleboy.scenarios.run_folder.termination import left_by_sigterm


@contextmanager
def whole_folder(
    path: Path, about: dict[str, Any], *, overwrite: bool, kind: str = "export"
) -> Iterator[Path]:
    """Give a folder to write to, beside the one asked for, whose place it takes when the block ends well.

    Nothing of it is left if the block ends otherwise, by a signal too, and what a process that was killed has
    left is removed by the next one. A file KIND.json says what the folder is.

    Args:
        path: the folder asked for.
        about: what that file is to say; it may grow inside the block.
        overwrite: whether an earlier folder of this kind there may be replaced.
        kind: what the folder is, "export" or "run".

    Raises:
        BadInput: there is something at this path that must not be replaced, or it cannot be written to.
    """
    part, old = (path.parent / f".{path.name}.{os.getpid()}.{state}" for state in ("new", "old"))
    with left_by_sigterm(), writing_to(path):
        check_out(path, kind, overwrite=overwrite)
        _sweep(path)
        try:
            part.mkdir(parents=True)
            yield part
            (part / f"{kind}.json").write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")
            if path.exists():
                path.rename(old)
            part.rename(path)
        finally:
            if old.exists() and not path.exists():
                old.rename(path)
            for rest in (part, old):
                shutil.rmtree(rest, ignore_errors=True)


def _sweep(path: Path) -> None:
    """Remove what processes that are no more have left beside a folder."""
    of_a_process = re.compile(rf"\.{re.escape(path.name)}\.(\d+)\.(new|old)")
    for left in path.parent.iterdir() if path.parent.is_dir() else ():
        found = of_a_process.fullmatch(left.name)
        # An earlier folder that was to be replaced is all there is until the new one has its place.
        if found and not _is_running(int(found[1])) and (found[2] == "new" or path.exists()):
            shutil.rmtree(left, ignore_errors=True)


def _is_running(process: int) -> bool:
    """Tell whether another process has this number."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return process != os.getpid()
