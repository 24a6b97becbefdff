"""What --out may name, and how all commands refuse what it must not."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from peopleboy.bad_input import BadInput


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
