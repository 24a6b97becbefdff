"""Reading archives of learned arrays, which hold no pickles."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import numpy as np

from peopleboy.bad_input import BadInput

# An encrypted member, or one that is compressed in an unknown way, makes zipfile raise RuntimeError.
NO_ARCHIVE: Final = (
    ValueError, KeyError, TypeError, EOFError, RuntimeError, SyntaxError, zipfile.BadZipFile, zlib.error
)  # fmt: skip
"""What is raised by reading a file that is no archive of arrays, or not the one that is looked for."""


@contextmanager
def opened_archive(path: Path, command: str) -> Iterator[Mapping[str, Any]]:
    """Open a NumPy archive, which the command of that name makes, for what is read within.

    Raises:
        BadInput: a file that is missing or is none, or holds not what is read.
    """
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
            yield archive
    except OSError as error:
        why = error.strerror or str(error)
        raise BadInput(f"cannot be read: {why}; `{command}` makes one", file=str(path)) from None
    except NO_ARCHIVE:
        raise BadInput(f"is no file of weights; `{command}` makes one", file=str(path)) from None
