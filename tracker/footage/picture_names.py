"""The pictures of a folder by their names: their order, and what the names say is amiss."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Final

from peopleboy.bad_input import BadInput

SUFFIXES: Final = (".png", ".tif", ".tiff", ".jpg", ".jpeg", ".bmp")


def natural_order(name: str) -> list[tuple[int, str]]:
    """Give a key by which frame 2 comes before frame 10."""
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", name)]


def pictures_in(folder: Path) -> list[Path]:
    """List the pictures of a folder in natural order.

    Raises:
        BadInput: the folder cannot be read, or a picture is there twice, as two kinds of file.
    """
    try:
        found = [path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES and path.is_file()]
    except OSError as error:
        raise BadInput(f"{folder}: cannot be read: {error.strerror}") from error
    paths = sorted(found, key=lambda path: natural_order(path.name))
    for one, other in pairwise(sorted(paths, key=lambda path: path.stem)):
        if one.stem == other.stem:
            raise BadInput(f"{folder}: {one.stem} is there as {one.suffix} and {other.suffix}; keep one")
    return paths


def numbers_in_a_row(paths: Sequence[Path]) -> range | None:
    """Give the numbers of pictures whose names have consecutive ones and differ in nothing else, or None."""
    numbers = _numbers(paths)
    if numbers is None:
        return None
    row = range(numbers[0], numbers[0] + len(numbers))
    return row if numbers == list(row) else None


def jumps(paths: Sequence[Path]) -> list[tuple[int, int]]:
    """Find where numbers are missing in a row: the numbers before and after.

    Names have to differ in one number alone, which mostly grows by the same step; others, such as times, are
    in no row.
    """
    numbers = _numbers(paths)
    if numbers is None:
        return []
    neighbours = list(pairwise(numbers))
    step, count = Counter(after - before for before, after in neighbours).most_common(1)[0]
    if 2 * count <= len(neighbours):
        return []
    return [(before, after) for before, after in neighbours if after - before > step]


def _numbers(paths: Sequence[Path]) -> list[int] | None:
    """Read the one number in which names differ; None if they differ otherwise, or not."""
    parts = [re.split(r"(\d+)", path.stem) for path in paths]
    if len({len(each) for each in parts}) != 1:
        return None
    differing = [column for column in zip(*parts, strict=True) if len(set(column)) > 1]
    if len(differing) != 1 or not differing[0][0].isdecimal():
        return None
    return [int(number) for number in differing[0]]
