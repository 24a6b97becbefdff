"""Pictures that lie beside those of a film, told by their names: masks, covers, another camera's."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from peopleboy.bad_input import BadInput

Pattern = tuple[str, ...]
"""What stands round the numbers of a name."""

_LEAST_FILM: Final = 3  # pictures, and thrice the others: fewer names tell no pattern
_MOST_OTHERS: Final = 10  # of as many pictures, one may be another, or one in all


def film_of(paths: Sequence[Path]) -> tuple[list[Path], list[Path]]:
    """Divide the pictures of a folder into those of the film and a few others.

    If nearly all have names of one pattern with numbers, such as frame1.png, the rest are others.

    Args:
        paths: the pictures, in order.

    Raises:
        BadInput: two patterns have the same numbers, as those of two cameras have.
    """
    groups: dict[Pattern, list[Path]] = defaultdict(list)
    for path in paths:
        groups[_pattern(path)].append(path)
    largest, *smaller = sorted(groups.values(), key=len, reverse=True) or [[]]
    others = len(paths) - len(largest)
    if not others or len(_pattern(largest[0])) < 2:
        return list(paths), []
    if len(largest) >= _LEAST_FILM * others and others <= max(1, len(paths) // _MOST_OTHERS):
        return largest, [path for path in paths if path not in set(largest)]
    _check_one_film(largest, smaller[0])
    return list(paths), []


def told_left_out(film: Sequence[Path], others: Sequence[Path]) -> str:
    """Say which pictures are left out, and why."""
    more = f" and {len(others) - 1} more" if len(others) > 1 else ""
    return f"{others[0]}{more}: left out, as not called like the others, such as {film[0].name}"


def _check_one_film(one: Sequence[Path], other: Sequence[Path]) -> None:
    common = set(map(_numbers, one)) & set(map(_numbers, other))
    if len(other) >= _LEAST_FILM and 2 * len(common) >= len(other):
        raise BadInput(
            f"{one[0].parent}: has pictures of two kinds, such as {one[0].name} and {other[0].name}; "
            "give each kind a folder of its own"
        )


def _pattern(path: Path) -> Pattern:
    return tuple(re.split(r"\d+", path.stem))


def _numbers(path: Path) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", path.stem))
