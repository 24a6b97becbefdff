"""Times of pictures, from their names or from a file of time stamps."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput

Floats = NDArray[np.float64]

_STAMP: Final = re.compile(r"(?<![\d.])(\d+\.\d+|\d{13}|\d{16}|\d{19})(?![\d.])")
"""Seconds with decimals, as in the TUM RGB-D benchmark, or milli-, micro- or nanoseconds since 1970."""
_NUMBER: Final = re.compile(r"-?\d+(\.\d+)?([eE][+-]?\d+)?")
_UNITS_S: Final = {13: 1e-3, 16: 1e-6, 19: 1e-9}  # of whole numbers since 1970, by their digits


def time_stamps(paths: Sequence[Path]) -> Floats | None:
    """Return the times in names [s] (N,); None if one of them has none, or if all are equal."""
    found = [_STAMP.findall(path.stem) for path in paths]
    if not found or any(len(each) != 1 for each in found):
        return None
    texts = [each[0] for each in found]
    return None if len(texts) > 1 and len(set(texts)) == 1 else seconds_of(texts)


def seconds_of(texts: Sequence[str]) -> Floats:
    """Return times [s] (N,): numbers in seconds, or whole ones of 13, 16 or 19 digits since 1970."""
    return np.array(
        [float(text) * (_UNITS_S.get(len(text), 1.0) if text.isdecimal() else 1.0) for text in texts]
    )


def check_rising(paths: Sequence[Path], times: Floats) -> None:
    """Refuse sorted times (N,) of which two are equal.

    Raises:
        BadInput: two are.
    """
    steps = np.diff(times)
    if not (steps > 0.0).all():
        twice = paths[int(np.argmin(steps)) + 1]
        raise BadInput(f"{twice}: another picture has the same time; keep one")


def read_time_stamps(path: Path, names: Sequence[str]) -> Floats:
    """Read the time [s] of each picture, (N,), from a text file; lines that begin with # are comments.

    A line is a time, or a time and the name or number of a picture, in either order, separated by white space
    or commas. Whole numbers of 13, 16 or 19 digits are milli-, micro- or nanoseconds.

    Args:
        path: the file.
        names: names of the pictures' files, or their numbers.

    Raises:
        BadInput: the file cannot be read, lacks a picture, or times do not rise.
    """
    rows = _read_cells(path)
    if all(len(row) == 1 for _, row in rows):
        texts = [row[0] for _, row in rows]
        if len(texts) != len(names):
            raise BadInput(
                f"{path}: must have a time for each of the {len(names)} pictures, got {len(texts)}"
            )
    else:
        by_name = dict(_named_time(path, number, row, set(names)) for number, row in rows)
        lacking = [name for name in names if name not in by_name]
        if lacking:
            raise BadInput(
                f"{path}: has no time of picture {lacking[0]}; lacking: {len(lacking)} of {len(names)}"
            )
        texts = [by_name[name] for name in names]
    times = seconds_of(texts)
    if not (np.diff(times) > 0.0).all():
        late = int(np.argmin(np.diff(times))) + 1
        raise BadInput(f"{path}: times must rise from picture to picture, but {names[late]} is not later")
    return times


def _read_cells(path: Path) -> list[tuple[int, list[str]]]:
    """Return the number and the cells of each line, without comments and a heading."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"{path}: cannot be read as time stamps; give a text file") from error
    rows = [(number, re.findall(r"[^,;\s]+", line)) for number, line in enumerate(lines, start=1)]
    rows = [(number, row) for number, row in rows if row and not row[0].startswith("#")]
    if rows and not any(_NUMBER.fullmatch(cell) for cell in rows[0][1]):
        rows = rows[1:]
    for number, row in rows:
        if len(row) > 2 or not any(_NUMBER.fullmatch(cell) for cell in row):
            raise BadInput(
                f"{path}:{number}: must be a time, or a time and a picture, got {' '.join(row)[:60]!r}"
            )
    return rows


def _named_time(path: Path, number: int, row: Sequence[str], names: set[str]) -> tuple[str, str]:
    """Return the name and the time on a line."""
    if len(row) == 2:
        for name, time in ((row[0], row[1]), (row[1], row[0])):
            short = re.split(r"[/\\]", name)[-1]
            known = next((each for each in (short, Path(short).stem) if each in names), None)
            if known is None and not _NUMBER.fullmatch(short):
                known = short
            if known is not None and _NUMBER.fullmatch(time):
                return known, time
        return row[0], row[1]
    raise BadInput(f"{path}:{number}: must be a time and a picture, as on other lines, got {row[0][:60]!r}")
