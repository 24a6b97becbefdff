"""Last position of a person, updated by wheel odometry while the robot drives there."""

import math
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.behaviours.dead_reckoning import RobotMotion
from peopleboy.behaviours.following.target import Target
from peopleboy.behaviours.percept import Percept, Points


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaceConfig:
    """Conversion of an image to a position, and conditions of arrival.

    Attributes:
        whole_m: [m] distance at which a person is as tall as the image: 1.75 m at 44 degrees.
        camera_m: [m] distance of the camera in front of the robot's origin.
        arrive_m: [m] distance at which the robot has arrived.
        blocked_s: [s] without progress after which the robot stops trying.
        longest_s: [s] longest duration of the drive.
        narrow_m: [m] least width of a passage that the robot enters, since it cannot turn in a narrower one.
        narrow_from_m, narrow_to_m: [m] range ahead in which passages are detected.
        lane_m: [m] half width of the lane ahead that must be free.
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
    """A position on the floor in the robot frame, x forward, y left.

    Attributes:
        x_m, y_m: [m].
        driven_s: [s] duration of the drive.
        blocked_s: [s] time without progress.
    """

    x_m: float
    y_m: float
    driven_s: float = 0.0
    blocked_s: float = 0.0

    @property
    def distance_m(self) -> float:
        """Distance [m]."""
        return math.hypot(self.x_m, self.y_m)

    @property
    def bearing_rad(self) -> float:
        """Bearing from the robot's heading [rad, positive left]."""
        return math.atan2(self.y_m, self.x_m)


def place_of(target: Target, config: PlaceConfig) -> LastPlace:
    """Estimate the position of a person from the height in the image, for average body height."""
    far = config.camera_m + config.whole_m / target.height
    return LastPlace(x_m=far * math.cos(target.bearing_rad), y_m=far * math.sin(target.bearing_rad))


def carry_place(place: LastPlace, motion: RobotMotion) -> LastPlace:
    """Transform a position to the robot frame after a motion."""
    ((x, y),) = motion.carry(np.array([[place.x_m, place.y_m]])).tolist()
    return replace(place, x_m=x, y_m=y)


def on_the_way(place: LastPlace, percept: Percept, step_s: float) -> LastPlace:
    """Update the duration of the drive, and the time without progress."""
    stands = abs(percept.linear_m_s) < 0.03
    return replace(
        place,
        driven_s=place.driven_s + step_s,
        blocked_s=place.blocked_s + step_s if stands else 0.0,
    )


def end_of_way(place: LastPlace, around: Points, config: PlaceConfig) -> str:
    """Return why the robot stops the drive; empty while it continues.

    Args:
        place: the goal.
        around: (N, 2) [m] echoes, robot frame.
        config: conditions.
    """
    if place.distance_m < config.arrive_m:
        return "no person at the last position"
    if _is_narrow(around, config):
        return "the passage to the last position is too narrow to turn"
    if place.blocked_s > config.blocked_s:
        return "the path to the last position is blocked"
    return "the drive to the last position takes too long" if place.driven_s > config.longest_s else ""


def _is_narrow(around: Points, config: PlaceConfig) -> bool:
    """Return whether there is a narrow passage ahead."""
    x, y = around[(around[:, 0] > 0.0) & (around[:, 0] < config.narrow_to_m)].T
    if np.any(np.abs(y) < config.lane_m):
        return False
    y = y[x > config.narrow_from_m]
    left, right = np.min(y[y > 0.0], initial=math.inf), np.min(-y[y < 0.0], initial=math.inf)
    return bool(left + right < config.narrow_m)
