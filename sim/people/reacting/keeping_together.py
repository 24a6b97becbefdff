"""Groups keep together: who is ahead slows for who is behind."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import accumulate, pairwise
from typing import Final

Point = tuple[float, float]

_EASY_M: Final = 0.4  # up to which nobody cares who is ahead
_WAITS_M: Final = 1.5  # ahead of the last of the group, where one waits


def pace_among(points: Sequence[Point], progress: float, company: Iterable[float]) -> float:
    """Tell what share of its planned speed a person walks at, so as not to leave its group behind.

    Args:
        points: [m] of the person's own path.
        progress: how far it has got: waypoints reached and the share of the way to the next one.
        company: the same of the others of the group, whose paths have as many points.

    Returns:
        1 up to 0.4 m ahead of the last of the group, 0 from 1.5 m on, linear between.
    """
    last = min(company, default=progress)
    ahead_m = _along(points, progress) - _along(points, last)
    return min(max((_WAITS_M - ahead_m) / (_WAITS_M - _EASY_M), 0.0), 1.0)


def _along(points: Sequence[Point], progress: float) -> float:
    """How far along a path [m] a progress is."""
    ways = [0.0, *accumulate(math.dist(a, b) for a, b in pairwise(points))]
    index = min(int(progress), len(ways) - 1)
    if index == len(ways) - 1:
        return ways[-1]
    return ways[index] + (progress - index) * (ways[index + 1] - ways[index])
