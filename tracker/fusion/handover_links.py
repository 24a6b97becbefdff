"""Which track of one camera is which of the other: by where both say that people stand."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from peopleboy.geometry import small_matrices
from peopleboy.geometry.pose2 import Pose2
from peopleboy.tracker.frame import PANORAMA, Frame
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
    distance2 = np.array([[mahalanobis2(one, other) for other in others] for one in ones])
    rows, columns = linear_sum_assignment(np.minimum(distance2, 2.0 * GATE))
    chosen = zip(rows.tolist(), columns.tolist(), strict=True)
    return [(ones[row], others[column]) for row, column in chosen if distance2[row, column] < GATE]


def mahalanobis2(one: Track, other: Track) -> float:
    """Return by how much the places of two tracks differ: squared, in standard deviations."""
    if one.place is None or other.place is None:
        return np.inf
    away = np.subtract(one.place.position_m, other.place.position_m)
    error = _matrix(one.place) + _matrix(other.place) + _spread(FLOOR_M2)
    return small_matrices.mahalanobis2(away, error)


def is_same_way(one: Track, other: Track) -> bool:
    """Return whether two tracks are in the same direction, however far away."""
    if one.place is None or other.place is None:
        return False
    (ahead, aside), (further, across) = one.place.position_m, other.place.position_m
    turn = math.remainder(math.atan2(aside, ahead) - math.atan2(across, further), math.tau)
    return abs(turn) < SAME_WAY_RAD


def is_seen(track: Track) -> bool:
    """Return whether a track is more than a guess."""
    return track.status is not Status.TOTALLY_OCCLUDED


def _matrix(place: FloorPlace) -> NDArray[np.float64]:
    return _spread(place.covariance_m2)


def _spread(covariance_m2: tuple[float, float, float]) -> NDArray[np.float64]:
    xx, xy, yy = covariance_m2
    return np.array([[xx, xy], [xy, yy]])


class LinkEvidence:
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


# Where people were last seen by a camera: a new track near there is one of them.

FORGET_S: Final = 3.0
REACH_M: Final = 1.2  # of errors of both places,
FASTEST_M_S: Final = 1.4  # and of the way since
DEPTH_SHARE: Final = 0.3  # weight of errors in depth, which the thermal image measures badly at its border


class Departures:
    """The last places of people in either camera, in the room as the robot's odometry has it."""

    def __init__(self) -> None:
        self._pose = Pose2()
        self._time_s = 0.0
        self._places: dict[tuple[str, int], tuple[tuple[float, float], float]] = {}

    def go_on(self, frame: Frame) -> None:
        """Move with the robot, and forget who has been away for too long."""
        if frame.odometry is not None:
            self._pose = self._pose.integrate(frame.odometry.motion)
        self._time_s = frame.time_s
        self._places = {
            key: known for key, known in self._places.items() if self._time_s - known[1] < FORGET_S
        }

    def note(self, camera: str, tracks: Mapping[int, Track]) -> None:
        """Remember where people, by their numbers, are seen now in a camera."""
        for number, track in tracks.items():
            if track.place is not None and is_seen(track):
                self._places[camera, number] = (self._in_room(track.place.position_m), self._time_s)

    def who(
        self, track: Track, present: Collection[int], camera: str, others: Mapping[int, Track]
    ) -> int | None:
        """Return whose number a new track should have: that of who was near last, and is not there.

        Args:
            track: the new one.
            present: numbers that its camera has already.
            camera: its own.
            others: tracks of the other camera, by their numbers; who is seen elsewhere by it is not meant.

        Returns:
            the number; None for nobody's.
        """
        if track.place is None:
            return None
        elsewhere = {number for number, one in others.items() if is_seen(one) and not is_same_way(one, track)}
        away = {number for _, number in self._places} - elsewhere - set(present)
        ways = {number: max(self._ways(track.place.position_m, camera, number)) for number in away}
        nearest = min(ways, key=lambda number: ways[number], default=None)
        return nearest if nearest is not None and ways[nearest] < REACH_M else None

    def _ways(self, seen_m: tuple[float, float], camera: str, number: int) -> Iterator[float]:
        """Return for each camera how much farther away a place is than a person can have gone since [m]."""
        for (before, one), (place, time_s) in self._places.items():
            if one == number:
                share = 1.0 if camera == before == PANORAMA else DEPTH_SHARE
                yield self._apart(seen_m, place, share) - FASTEST_M_S * (self._time_s - time_s)

    def _apart(self, seen_m: tuple[float, float], room_m: tuple[float, float], depth_share: float) -> float:
        """Tell how far a place in the robot's frame is from one in the room [m], depth counting for less."""
        there = self._pose.points_to_local(np.array(room_m))
        distance, known = math.hypot(*seen_m), math.hypot(*there)
        turn = math.remainder(math.atan2(seen_m[1], seen_m[0]) - math.atan2(there[1], there[0]), math.tau)
        return math.hypot(turn * min(distance, known), depth_share * (distance - known))

    def _in_room(self, seen_m: tuple[float, float]) -> tuple[float, float]:
        x, y = self._pose.transform_polar(math.hypot(*seen_m), math.atan2(seen_m[1], seen_m[0])).tolist()
        return x, y


# Whose track is whose: one number for each person, whatever camera sees it.

Key = tuple[str, int]
"""A camera, and the id of a track in it."""

YOUNG_S = 1.0
"""A number that is younger than this gives way to the one that the person had before."""


@dataclass(slots=True)
class Identities:
    """The numbers of the tracks of two cameras.

    Attributes:
        number: of each track.
    """

    number: dict[Key, int] = field(default_factory=dict)
    _newest: int = 0

    def of(self, camera: str, tracks: Collection[Track]) -> dict[int, Track]:
        """List the tracks of a camera that have a number by it."""
        keys = {(camera, track.id): track for track in tracks}
        return {self.number[key]: track for key, track in keys.items() if key in self.number}

    def name(
        self,
        camera: str,
        tracks: Collection[Track],
        known: Mapping[int, Key],
        guess: Callable[[Track, Collection[int]], int | None],
    ) -> None:
        """Number the tracks of a camera that have none yet.

        Args:
            camera: its name.
            tracks: all of them.
            known: for ids of tracks that agree with one of the other camera, that one.
            guess: returns the id of a track that agrees with none that has one, and none of these that
                its camera has; None for a new one.
        """
        for track in tracks:
            if (camera, track.id) not in self.number:
                present = self.of(camera, tracks).keys()
                number = self.number.get(known[track.id]) if track.id in known else None
                if number is None:
                    number = guess(track, present)
                if number is None or number in present:
                    number = self._new()
                self._take((camera, track.id), number)

    def agree(self, follower: tuple[Key, Track], leader: tuple[Key, Track], present: Collection[Key]) -> None:
        """Return two tracks that are one person the same number.

        A number that is young gives way; otherwise the leader's stays. Whoever else has the number in the
        camera of the one that gives way gets a new one.
        """
        (yields, one), (stays, other) = follower, leader
        if self.number[yields] == self.number[stays]:
            return
        if other.age_s < YOUNG_S <= one.age_s:
            yields, stays = stays, yields
        for key in self._take(yields, self.number[stays]):
            if key in present:
                self.number[key] = self._new()

    def _new(self) -> int:
        self._newest += 1
        return self._newest

    def _take(self, taker: Key, number: int) -> list[Key]:
        """Give a number to one track of a camera alone; return its former owner, which has none any more."""
        had = [key for key, one in self.number.items() if one == number and key[0] == taker[0]]
        for key in had:
            del self.number[key]
        self.number[taker] = number
        return had
