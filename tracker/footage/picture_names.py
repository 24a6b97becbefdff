"""Order of the pictures in a folder by their names, with checks for missing and foreign ones."""

import re
from collections import Counter, defaultdict
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Final

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage.time_stamps import time_stamps

SUFFIXES: Final = (".png", ".tif", ".tiff", ".jpg", ".jpeg", ".bmp")


def natural_order(name: str) -> list[tuple[int, str]]:
    """Return a sort key by which frame 2 comes before frame 10."""
    return [(int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", name)]


def pictures_in(folder: Path) -> list[Path]:
    """List the pictures of a folder in natural order.

    Raises:
        BadInput: the folder cannot be read, or a picture exists as two kinds of file.
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
    """Return the numbers of pictures whose names differ only in consecutive numbers, or None."""
    numbers = numbers_of(paths)
    if numbers is None:
        return None
    row = range(numbers[0], numbers[0] + len(numbers))
    return row if numbers == list(row) else None


def jumps(paths: Sequence[Path]) -> list[tuple[int, int]]:
    """Return the gaps in a sequence of numbers: the numbers before and after.

    Names must differ in one number alone, which mostly grows by the same step; others, such as times, have no
    gaps.
    """
    numbers, step = numbers_of(paths), step_of(paths)
    if numbers is None or step is None:
        return []
    return [(before, after) for before, after in pairwise(numbers) if after - before > step]


def step_of(paths: Sequence[Path]) -> int | None:
    """Return by how much the numbers in names mostly grow; None if there are none, or no usual step."""
    numbers = numbers_of(paths)
    if numbers is None or len(numbers) < 2 or time_stamps(paths) is not None:
        return None
    neighbours = list(pairwise(numbers))
    step, count = Counter(after - before for before, after in neighbours).most_common(1)[0]
    return step if step > 0 and 2 * count > len(neighbours) else None


def offsets_of(paths: Sequence[Path]) -> list[float] | None:
    """Return when pictures were taken by their numbers, in usual steps since the first; None without gaps."""
    numbers, step = numbers_of(paths), step_of(paths)
    if numbers is None or step is None or not jumps(paths):
        return None
    return [(number - numbers[0]) / step for number in numbers]


def numbers_of(paths: Sequence[Path]) -> list[int] | None:
    """Return the one number in which names differ; None if they differ otherwise, or not at all."""
    parts = [re.split(r"(\d+)", path.stem) for path in paths]
    if len({len(each) for each in parts}) != 1:
        return None
    differing = [column for column in zip(*parts, strict=True) if len(set(column)) > 1]
    if len(differing) != 1 or not differing[0][0].isdecimal():
        return None
    return [int(number) for number in differing[0]]


# A folder may hold a few images besides those of its sequence: masks, covers, images of another camera.

Pattern = tuple[str, ...]
"""The parts of a name around its numbers."""

_LEAST_SEQUENCE: Final = 3  # pictures, and three times the others: fewer names show no pattern
_MOST_OTHERS: Final = 10  # one of this many pictures may be another one, or one in all


def split_sequence(paths: Sequence[Path]) -> tuple[list[Path], list[Path]]:
    """Separate the pictures of the sequence in a folder from a few others.

    If nearly all names have one pattern with numbers, such as frame1.png, the rest are others.

    Args:
        paths: the pictures, in order.

    Raises:
        BadInput: two patterns have the same numbers, as those of two cameras do.
    """
    groups: dict[Pattern, list[Path]] = defaultdict(list)
    for path in paths:
        groups[_pattern(path)].append(path)
    largest, *smaller = sorted(groups.values(), key=len, reverse=True) or [[]]
    others = len(paths) - len(largest)
    if not others or len(_pattern(largest[0])) < 2:
        return list(paths), []
    if len(largest) >= _LEAST_SEQUENCE * others and others <= max(1, len(paths) // _MOST_OTHERS):
        return largest, [path for path in paths if path not in set(largest)]
    _check_one_sequence(largest, smaller[0])
    return list(paths), []


def describe_left_out(film: Sequence[Path], others: Sequence[Path]) -> str:
    """Return a note on the pictures left out."""
    more = f" and {len(others) - 1} more" if len(others) > 1 else ""
    return f"{others[0]}{more}: left out, as not called like the others, such as {film[0].name}"


def _check_one_sequence(one: Sequence[Path], other: Sequence[Path]) -> None:
    common = set(map(_numbers_in, one)) & set(map(_numbers_in, other))
    if len(other) >= _LEAST_SEQUENCE and 2 * len(common) >= len(other):
        raise BadInput(
            f"{one[0].parent}: has pictures of two kinds, such as {one[0].name} and {other[0].name}; "
            "give each kind a folder of its own"
        )


def _pattern(path: Path) -> Pattern:
    return tuple(re.split(r"\d+", path.stem))


def _numbers_in(path: Path) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", path.stem))
