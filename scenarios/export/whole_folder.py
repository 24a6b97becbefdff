"""A folder that is there whole or not at all."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from bad_input import BadInput


@contextmanager
def whole_folder(
    path: Path, about: dict[str, Any], *, overwrite: bool, kind: str = "export"
) -> Iterator[Path]:
    """Give a folder to write to, beside the one asked for, whose place it takes when the block ends well.

    Nothing of it is left if the block ends otherwise. A file KIND.json says what the folder is.

    Args:
        path: the folder asked for.
        about: what that file is to say; it may grow inside the block.
        overwrite: whether an earlier folder of this kind there may be replaced.
        kind: what the folder is, "export" or "run".

    Raises:
        BadInput: there is something at this path that must not be replaced, or it cannot be written to.
    """
    _check(path, overwrite, kind)
    part, old = (path.parent / f".{path.name}.{os.getpid()}.{state}" for state in ("new", "old"))
    try:
        part.mkdir(parents=True)
        yield part
        (part / f"{kind}.json").write_text(json.dumps(about, indent=2) + "\n", encoding="utf-8")
        if path.exists():
            path.rename(old)
        part.rename(path)
        shutil.rmtree(old, ignore_errors=True)
    except OSError as error:
        raise BadInput(f"{path}: cannot write this {kind}: {error}") from error
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _check(path: Path, overwrite: bool, kind: str) -> None:
    if not path.exists() or (path.is_dir() and not any(path.iterdir())):
        return
    if not overwrite:
        raise BadInput(f"{path}: exists already; give --overwrite to replace this {kind}, or another --out")
    if not (path / f"{kind}.json").is_file():
        raise BadInput(f"{path}: is no {kind} and will not be replaced; give another --out")
