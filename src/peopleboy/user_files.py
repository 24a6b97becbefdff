"""Text and JSON files of users, which are read within limits, and never from a pipe or a device."""

import json
from pathlib import Path
from typing import Any, Final

from peopleboy.bad_input import BadInput

MOST_BYTES: Final = 256_000_000
"""Largest text file that is read: about four million lines of boxes."""


_OF_KERNEL: Final = (Path("/proc"), Path("/sys"))


def is_stream(path: Path) -> bool:
    """Return whether a path is a pipe, a device or a file of the kernel, whose reading may never end."""
    if not path.exists():
        return False
    true_path = path.resolve()
    is_plain = path.is_file() or path.is_dir()
    return not is_plain or any(true_path.is_relative_to(folder) for folder in _OF_KERNEL)


def check_plain(path: Path) -> None:
    """Refuse a pipe and a device, as reading them may never end.

    Raises:
        BadInput: the path is one of these.
    """
    if is_stream(path):
        raise BadInput("is a pipe or a device; give a file", file=str(path))


def read_text(path: Path, encoding: str = "utf-8") -> str:
    """Read a text file.

    Raises:
        BadInput: the path is a pipe or a device, or the file is too large.
        OSError: the file cannot be read.
        UnicodeDecodeError: the file is not text.
    """
    check_plain(path)
    size = path.stat().st_size
    if size > MOST_BYTES:
        raise BadInput(f"has {size} bytes; at most {MOST_BYTES} are read", file=str(path))
    return path.read_text(encoding=encoding)


def read_json(path: Path) -> Any:
    """Read a JSON file.

    Raises:
        OSError: the file cannot be read.
        ValueError: the file is too large, not JSON, or nested too deeply.
    """
    return parse_json(read_text(path))


def parse_json(text: str) -> Any:
    """Parse JSON.

    Raises:
        ValueError: the text is not JSON, or nested too deeply.
    """
    try:
        return json.loads(text)
    except RecursionError as error:
        raise ValueError("nested too deeply") from error
