"""Track-to-track association of two cameras, by position on the floor."""

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
"""Squared Mahalanobis distance exceeded by one person's two positions in 1 % of cases."""

FLOOR_M2: Final = (0.2**2, 0.0, 0.2**2)
"""Variance of positions beyond each tracker's own estimate [m2]."""

SAME_WAY_RAD: Final = math.radians(6.0)
"""Greatest difference of one person's bearings in two cameras."""


def pairs(ones: Sequence[Track], others: Sequence[Track]) -> list[tuple[Track, Track]]:
    """Pair tracks whose positions agree, each at most once, at least total cost.

    Tracks without a position stay alone.
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
    """Return the squared Mahalanobis distance between the positions of two tracks."""
    if one.place is None or other.place is None:
        return np.inf
    away = np.subtract(one.place.position_m, other.place.position_m)
    error = _matrix(one.place) + _matrix(other.place) + _spread(FLOOR_M2)
    return small_matrices.mahalanobis2(away, error)


def is_same_way(one: Track, other: Track) -> bool:
    """Return whether two tracks have the same bearing, at any range."""
    if one.place is None or other.place is None:
        return False
    (ahead, aside), (further, across) = one.place.position_m, other.place.position_m
    turn = math.remainder(math.atan2(aside, ahead) - math.atan2(across, further), math.tau)
    return abs(turn) < SAME_WAY_RAD


def is_seen(track: Track) -> bool:
    """Return whether a track is reliable."""
    return track.status is not Status.TOTALLY_OCCLUDED


def _matrix(place: FloorPlace) -> NDArray[np.float64]:
    return _spread(place.covariance_m2)


def _spread(covariance_m2: tuple[float, float, float]) -> NDArray[np.float64]:
    xx, xy, yy = covariance_m2
    return np.array([[xx, xy], [xy, yy]])


class LinkEvidence:
    """Counts in how many of the newest frames two tracks agreed; disagreement lowers the count.

    Attributes:
        linked: the id of the second camera's track of the same person, by the id of the first camera's track.
    """

    def __init__(self, needed: int, most: int) -> None:
        self._needed, self._most = needed, most
        self._counts: dict[tuple[int, int], int] = {}
        self.linked: dict[int, int] = {}

    def count(
        self, agreed: Sequence[tuple[int, int]], ones: Mapping[int, Track], others: Mapping[int, Track]
    ) -> None:
        """Add the pairs of one frame, and the existing tracks by id.

        The count of a pair decreases if both tracks exist and disagree, or if either agrees with another
        track. The count of a track that is gone is kept as long as the other one exists.
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


# Last positions of people by camera: a new track near one of them continues it.

FORGET_S: Final = 3.0
REACH_M: Final = 1.2  # error of both positions,
FASTEST_M_S: Final = 1.4  # and greatest speed since
DEPTH_SHARE: Final = 0.3  # weight of depth errors; the thermal image measures depth badly at its border


class Departures:
    """The last positions of people in either camera, in the odometry's room frame."""

    def __init__(self) -> None:
        self._pose = Pose2()
        self._time_s = 0.0
        self._places: dict[tuple[str, int], tuple[tuple[float, float], float]] = {}

    def go_on(self, frame: Frame) -> None:
        """Apply the robot's motion, and forget people who have been absent for too long."""
        if frame.odometry is not None:
            self._pose = self._pose.integrate(frame.odometry.motion)
        self._time_s = frame.time_s
        self._places = {
            key: known for key, known in self._places.items() if self._time_s - known[1] < FORGET_S
        }

    def note(self, camera: str, tracks: Mapping[int, Track]) -> None:
        """Store the current positions of people in a camera, by number."""
        for number, track in tracks.items():
            if track.place is not None and is_seen(track):
                self._places[camera, number] = (self._in_room(track.place.position_m), self._time_s)

    def who(
        self, track: Track, present: Collection[int], camera: str, others: Mapping[int, Track]
    ) -> int | None:
        """Return the number for a new track: that of the nearest absent person.

        Args:
            track: the new track.
            present: numbers that its camera already has.
            camera: camera of the new track.
            others: tracks of the other camera by number; people seen elsewhere by it are excluded.

        Returns:
            The number, or None if there is no match.
        """
        if track.place is None:
            return None
        elsewhere = {number for number, one in others.items() if is_seen(one) and not is_same_way(one, track)}
        away = {number for _, number in self._places} - elsewhere - set(present)
        ways = {number: max(self._ways(track.place.position_m, camera, number)) for number in away}
        nearest = min(ways, key=lambda number: ways[number], default=None)
        return nearest if nearest is not None and ways[nearest] < REACH_M else None

    def _ways(self, seen_m: tuple[float, float], camera: str, number: int) -> Iterator[float]:
        """Return for each camera the distance [m] of a position beyond a person's walking range since."""
        for (before, one), (place, time_s) in self._places.items():
            if one == number:
                share = 1.0 if camera == before == PANORAMA else DEPTH_SHARE
                yield self._apart(seen_m, place, share) - FASTEST_M_S * (self._time_s - time_s)

    def _apart(self, seen_m: tuple[float, float], room_m: tuple[float, float], depth_share: float) -> float:
        """Return the distance from a position in the robot frame to one in the room [m], less for depth."""
        there = self._pose.points_to_local(np.array(room_m))
        distance, known = math.hypot(*seen_m), math.hypot(*there)
        turn = math.remainder(math.atan2(seen_m[1], seen_m[0]) - math.atan2(there[1], there[0]), math.tau)
        return math.hypot(turn * min(distance, known), depth_share * (distance - known))

    def _in_room(self, seen_m: tuple[float, float]) -> tuple[float, float]:
        x, y = self._pose.transform_polar(math.hypot(*seen_m), math.atan2(seen_m[1], seen_m[0])).tolist()
        return x, y


# Shared numbers: one for each person, in whichever camera.

Key = tuple[str, int]
"""A camera, and the id of one of its tracks."""

YOUNG_S = 1.0
"""A number younger than this gives way to the person's previous number."""


@dataclass(slots=True)
class Identities:
    """The shared numbers of the tracks of two cameras.

    Attributes:
        number: of each track.
    """

    number: dict[Key, int] = field(default_factory=dict)
    _newest: int = 0

    def of(self, camera: str, tracks: Collection[Track]) -> dict[int, Track]:
        """Return the tracks of a camera that have a number, by number."""
        keys = {(camera, track.id): track for track in tracks}
        return {self.number[key]: track for key, track in keys.items() if key in self.number}

    def name(
        self,
        camera: str,
        tracks: Collection[Track],
        known: Mapping[int, Key],
        guess: Callable[[Track, Collection[int]], int | None],
    ) -> None:
        """Number the new tracks of a camera.

        Args:
            camera: name.
            tracks: all its tracks.
            known: the agreeing track of the other camera, by id.
            guess: returns the number for a track without an agreeing numbered track, other than the numbers
                in its camera; None for a new number.
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
        """Give two tracks of one person the same number.

        A young number gives way; otherwise the leader's number is kept. A third track with that number in the
        camera of the other track gets a new one.
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
        """Give a number to one track of a camera; return its former owner, which then has none."""
        had = [key for key, one in self.number.items() if one == number and key[0] == taker[0]]
        for key in had:
            del self.number[key]
        self.number[taker] = number
        return had
