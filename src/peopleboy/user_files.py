"""Text and JSON files of users, which are read within limits, and never from a pipe or a device."""

import json
from pathlib import Path
from typing import Any, Final

from peopleboy.bad_input import BadInput

MOST_BYTES: Final = 256_000_000
"""Largest text file that is read: about four million lines of boxes."""


def check_readable(path: Path, most_bytes: int = MOST_BYTES) -> None:
    """Refuse a pipe, a device and a file that is too large, as reading them may never end.

    Raises:
        BadInput: the path is one of these.
        OSError: the path cannot be examined.
    """
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise BadInput("is a pipe or a device; give a file", file=str(path))
    size = path.stat().st_size
    if size > most_bytes:
        raise BadInput(f"has {size} bytes; at most {most_bytes} are read", file=str(path))


def read_text(path: Path, encoding: str = "utf-8") -> str:
    """Read a text file.

    Raises:
        BadInput: the path is a pipe or a device, or the file is too large.
        OSError: the file cannot be read.
        UnicodeDecodeError: the file is not text.
    """
    check_readable(path)
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
