"""Where a person was seen last, carried along by the wheels while the robot goes there."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.behaviours.dead_reckoning import RobotMotion
from peopleboy.behaviours.following.target import Target
from peopleboy.behaviours.percept import Percept, Points


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaceConfig:
    """How a place is made of an image, and when the robot has got there.

    Attributes:
        whole_m: [m] distance from the camera at which a person is as tall as the image: 1.75 m at 44 degrees.
        camera_m: [m] the camera is this far before the robot's origin.
        arrive_m: [m] as near as this, the robot is there.
        blocked_s: [s] a robot that has not got on for this long goes no farther.
        longest_s: [s] nor one that has been on its way for this long.
        narrow_m: [m] nor does it enter a passage narrower than this, as a door is: it could not turn there.
        narrow_from_m, narrow_to_m: [m] how far ahead the passage is looked for.
        lane_m: [m] half of the lane ahead that is free if a way leads on.
    """

    whole_m: float = 1.75 / (2.0 * math.tan(math.radians(22.0)))
    camera_m: float = 0.14
    arrive_m: float = 0.6
    blocked_s: float = 4.0
    longest_s: float = 14.0
    narrow_m: float = 1.28
    narrow_from_m: float = 0.3
    narrow_to_m: float = 0.9
    lane_m: float = 0.27


@dataclass(frozen=True, slots=True, kw_only=True)
class LastPlace:
    """A place on the floor in the robot's frame, x forward, y left.

    Attributes:
        x_m, y_m: [m].
        driven_s: [s] for how long the robot has been on its way.
        blocked_s: [s] for how long it has not got on.
    """

    x_m: float
    y_m: float
    driven_s: float = 0.0
    blocked_s: float = 0.0

    @property
    def distance_m(self) -> float:
        """How far it is [m]."""
        return math.hypot(self.x_m, self.y_m)

    @property
    def bearing_rad(self) -> float:
        """Direction from the robot's nose [rad, positive left]."""
        return math.atan2(self.y_m, self.x_m)


def place_of(target: Target, config: PlaceConfig) -> LastPlace:
    """Guess where a person of usual height stands from its height in the image."""
    far = config.camera_m + config.whole_m / target.height
    return LastPlace(x_m=far * math.cos(target.bearing_rad), y_m=far * math.sin(target.bearing_rad))


def carry_place(place: LastPlace, motion: RobotMotion) -> LastPlace:
    """Express a place in the robot's frame after it has moved."""
    ((x, y),) = motion.carry(np.array([[place.x_m, place.y_m]])).tolist()
    return replace(place, x_m=x, y_m=y)


def on_the_way(place: LastPlace, percept: Percept, step_s: float) -> LastPlace:
    """Count the time on the way, and that without getting on."""
    stands = abs(percept.linear_m_s) < 0.03
    return replace(
        place,
        driven_s=place.driven_s + step_s,
        blocked_s=place.blocked_s + step_s if stands else 0.0,
    )


def end_of_way(place: LastPlace, around: Points, config: PlaceConfig) -> str:
    """Return why the robot goes no farther; empty while it does.

    Args:
        place: where it goes.
        around: (N, 2) [m] what the sonars hear, robot frame.
        config: when it has got there.
    """
    if place.distance_m < config.arrive_m:
        return "nobody where the person was seen last"
    if _is_narrow(around, config):
        return "the way to where the person was seen last is too narrow to turn in"
    if place.blocked_s > config.blocked_s:
        return "the way to where the person was seen last is blocked"
    return (
        "the way to where the person was seen last is too long" if place.driven_s > config.longest_s else ""
    )


def _is_narrow(around: Points, config: PlaceConfig) -> bool:
    """Return whether a way leads on ahead, and is narrow."""
    x, y = around[(around[:, 0] > 0.0) & (around[:, 0] < config.narrow_to_m)].T
    if np.any(np.abs(y) < config.lane_m):
        return False
    y = y[x > config.narrow_from_m]
    left, right = np.min(y[y > 0.0], initial=math.inf), np.min(-y[y < 0.0], initial=math.inf)
    return bool(left + right < config.narrow_m)
