"""Where people were whom no camera sees any more: who turns up near there is one of them."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Final

import numpy as np

from peopleboy.tracker.frame import Frame
from peopleboy.tracker.panoramic.robot_pose import RobotPose
from peopleboy.tracker.track import Track

FORGET_S: Final = 3.0
REACH_M: Final = 1.2  # of errors of both places,
FASTEST_M_S: Final = 1.4  # and of the way since
DEPTH_SHARE: Final = 0.3  # by which errors in depth count, as the thermal image tells it badly at its border


class Departures:
    """The last places of people, in the room as the robot's odometry has it."""

    def __init__(self) -> None:
        self._pose = RobotPose()
        self._time_s = 0.0
        self._places: dict[int, tuple[tuple[float, float], float]] = {}

    def go_on(self, frame: Frame) -> None:
        """Move with the robot, and forget who has been away for too long."""
        if frame.odometry is not None:
            self._pose = self._pose.moved(frame.odometry)
        self._time_s = frame.time_s
        self._places = {
            number: known for number, known in self._places.items() if self._time_s - known[1] < FORGET_S
        }

    def note(self, tracks: Collection[Track]) -> None:
        """Remember where tracks that are seen are now."""
        for track in tracks:
            if track.place is not None:
                self._places[track.id] = (self._in_room(track), self._time_s)

    def who(self, track: Track, present: Collection[int]) -> int | None:
        """Tell whose number a new track should have: of who was near last, and is away; None for nobody's."""
        if track.place is None:
            return None
        ways = {
            number: self._apart(track.place.position_m, place) - FASTEST_M_S * (self._time_s - time_s)
            for number, (place, time_s) in self._places.items()
            if number not in present
        }
        nearest = min(ways, key=lambda number: ways[number], default=None)
        return nearest if nearest is not None and ways[nearest] < REACH_M else None

    def _apart(self, seen_m: tuple[float, float], room_m: tuple[float, float]) -> float:
        """Tell how far a place in the robot's frame is from one in the room [m], depth counting for less."""
        there = self._pose.locate(np.array(room_m))
        distance, known = math.hypot(*seen_m), math.hypot(*there)
        turn = math.remainder(math.atan2(seen_m[1], seen_m[0]) - math.atan2(there[1], there[0]), math.tau)
        return math.hypot(turn * min(distance, known), DEPTH_SHARE * (distance - known))

    def _in_room(self, track: Track) -> tuple[float, float]:
        assert track.place is not None
        ahead, aside = track.place.position_m
        x, y = self._pose.place(math.hypot(ahead, aside), math.atan2(aside, ahead)).tolist()
        return x, y
