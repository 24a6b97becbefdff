"""Where people were whom a camera sees no more: who turns up near there is one of them."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from typing import Final

import numpy as np

from peopleboy.tracker.frame import PANORAMA, Frame
from peopleboy.tracker.handover.links import is_same_way, is_seen
from peopleboy.tracker.panoramic.robot_pose import RobotPose
from peopleboy.tracker.track import Track

FORGET_S: Final = 3.0
REACH_M: Final = 1.2  # of errors of both places,
FASTEST_M_S: Final = 1.4  # and of the way since
DEPTH_SHARE: Final = 0.3  # by which errors in depth count, as the thermal image tells it badly at its border


class Departures:
    """The last places of people in either camera, in the room as the robot's odometry has it."""

    def __init__(self) -> None:
        self._pose = RobotPose()
        self._time_s = 0.0
        self._places: dict[tuple[str, int], tuple[tuple[float, float], float]] = {}

    def go_on(self, frame: Frame) -> None:
        """Move with the robot, and forget who has been away for too long."""
        if frame.odometry is not None:
            self._pose = self._pose.moved(frame.odometry)
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
        """Tell whose number a new track should have: that of who was near last, and is not there.

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
        """Tell of each camera how much farther away a place is than somebody can have gone since [m]."""
        for (before, one), (place, time_s) in self._places.items():
            if one == number:
                share = 1.0 if camera == before == PANORAMA else DEPTH_SHARE
                yield self._apart(seen_m, place, share) - FASTEST_M_S * (self._time_s - time_s)

    def _apart(self, seen_m: tuple[float, float], room_m: tuple[float, float], depth_share: float) -> float:
        """Tell how far a place in the robot's frame is from one in the room [m], depth counting for less."""
        there = self._pose.locate(np.array(room_m))
        distance, known = math.hypot(*seen_m), math.hypot(*there)
        turn = math.remainder(math.atan2(seen_m[1], seen_m[0]) - math.atan2(there[1], there[0]), math.tau)
        return math.hypot(turn * min(distance, known), depth_share * (distance - known))

    def _in_room(self, seen_m: tuple[float, float]) -> tuple[float, float]:
        x, y = self._pose.place(math.hypot(*seen_m), math.atan2(seen_m[1], seen_m[0])).tolist()
        return x, y
