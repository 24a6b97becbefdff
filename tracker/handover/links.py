"""Which track of one camera is which of the other: by where both say that people stand."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from peopleboy.tracker.track import FloorPlace, Status, Track

GATE: Final = 9.21
"""Squared Mahalanobis distance that one person's two places exceed in one case of a hundred."""

FLOOR_M2: Final = (0.2**2, 0.0, 0.2**2)
"""What either camera may be off in earnest beyond what it believes [m2]."""

SAME_WAY_RAD: Final = math.radians(6.0)
"""By how much the bearings of one person may differ in two cameras."""


def pairs(ones: Sequence[Track], others: Sequence[Track]) -> list[tuple[Track, Track]]:
    """Pair tracks whose places agree, each at most once, so that all pairs together agree best.

    Tracks without a place stay alone.
    """
    ones = [track for track in ones if track.place is not None]
    others = [track for track in others if track.place is not None]
    if not ones or not others:
        return []
    apart = np.array([[apartness(one, other) for other in others] for one in ones])
    rows, columns = linear_sum_assignment(np.minimum(apart, 2.0 * GATE))
    chosen = zip(rows.tolist(), columns.tolist(), strict=True)
    return [(ones[row], others[column]) for row, column in chosen if apart[row, column] < GATE]


def apartness(one: Track, other: Track) -> float:
    """Tell by how much the places of two tracks differ: squared, in standard deviations."""
    if one.place is None or other.place is None:
        return np.inf
    away = np.subtract(one.place.position_m, other.place.position_m)
    error = _matrix(one.place) + _matrix(other.place) + _spread(FLOOR_M2)
    return float(away @ np.linalg.solve(error, away))


def is_same_way(one: Track, other: Track) -> bool:
    """Tell whether two tracks are in the same direction, however far away."""
    if one.place is None or other.place is None:
        return False
    (ahead, aside), (further, across) = one.place.position_m, other.place.position_m
    turn = math.remainder(math.atan2(aside, ahead) - math.atan2(across, further), math.tau)
    return abs(turn) < SAME_WAY_RAD


def is_seen(track: Track) -> bool:
    """Tell whether a track is more than a guess."""
    return track.status is not Status.TOTALLY_OCCLUDED


def _matrix(place: FloorPlace) -> NDArray[np.float64]:
    return _spread(place.covariance_m2)


def _spread(covariance_m2: tuple[float, float, float]) -> NDArray[np.float64]:
    xx, xy, yy = covariance_m2
    return np.array([[xx, xy], [xy, yy]])


class Votes:
    """Counts in how many of the newest frames two tracks agreed; who disagrees loses what was counted.

    Attributes:
        linked: of each track of the first camera, the id of the second one's track that is the same person.
    """

    def __init__(self, needed: int, most: int) -> None:
        self._needed, self._most = needed, most
        self._counts: dict[tuple[int, int], int] = {}
        self.linked: dict[int, int] = {}

    def count(
        self, agreed: Sequence[tuple[int, int]], ones: Mapping[int, Track], others: Mapping[int, Track]
    ) -> None:
        """Take in the pairs of one frame, and the tracks that there are, by id.

        Two that are there and do not agree come apart, and so does who agrees with another; what is known of
        a track that is gone is kept as long as the other one lives.
        """
        fresh = set(agreed)
        left, right = {one for one, _ in fresh}, {other for _, other in fresh}
        for pair in self._counts.keys() - fresh:
            is_apart = pair[0] in ones and pair[1] in others
            if is_apart or pair[0] in left or pair[1] in right:
                self._counts[pair] -= 1
        for pair in fresh:
            self._counts[pair] = min(self._counts.get(pair, 0) + 1, self._most)
        self._counts = {
            pair: count
            for pair, count in self._counts.items()
            if count > 0 and (pair[0] in ones or pair[1] in others)
        }
        self.linked = self._best()

    def _best(self) -> dict[int, int]:
        linked: dict[int, int] = {}
        for one, other in sorted(self._counts, key=lambda pair: (-self._counts[pair], pair)):
            if (
                self._counts[one, other] >= self._needed
                and one not in linked
                and other not in linked.values()
            ):
                linked[one] = other
        return linked
