"""State of the followed person: bearing, drift and apparent height."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from peopleboy.behaviours.dead_reckoning import RobotMotion
from peopleboy.behaviours.percept import SeenPerson


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetConfig:
    """Smoothing of the measurements of the followed person.

    Attributes:
        half_view_rad: [rad] bearing of the image's left border, for the thermal camera at 44 degrees.
        bearing_gain: weight of the innovation in the bearing.
        drift_gain: [1/frame] weight of the innovation in the drift.
        height_s: [s] time constant over which the apparent height is averaged.
        drift_s: [s] time constant with which the drift of a person out of sight decays.
    """

    half_view_rad: float = math.atan(4.0 / 3.0 * math.tan(math.radians(22.0)))
    bearing_gain: float = 0.6
    drift_gain: float = 0.12
    height_s: float = 0.25
    drift_s: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """One person relative to the robot, without a metric position.

    Attributes:
        id: track id.
        seen_s: [s] time of the last image that showed the person.
        bearing_rad: [rad] direction relative to the robot's heading, positive to the left.
        drift_rad_s: [rad/s] rate of the bearing without rotation of the robot.
        height: [image heights] apparent height.
    """

    id: int
    seen_s: float
    bearing_rad: float
    drift_rad_s: float
    height: float


def bearing(x: float, config: TargetConfig) -> float:
    """Map an image column [half widths, positive right] to a bearing [rad, positive left]."""
    return -math.atan(x * math.tan(config.half_view_rad))


def first_sight(person: SeenPerson, time_s: float, config: TargetConfig) -> Target:
    """Start tracking a person."""
    return Target(
        id=person.id,
        seen_s=time_s,
        bearing_rad=bearing(person.x, config),
        drift_rad_s=0.0,
        height=person.height,
    )


def carry_on(target: Target, motion: RobotMotion) -> Target:
    """Predict the bearing after a motion of the robot; nothing else changes."""
    moved = target.bearing_rad + (target.drift_rad_s - motion.angular_rad_s) * motion.step_s
    return replace(target, bearing_rad=math.remainder(moved, math.tau))


def forget_drift(target: Target, step_s: float, config: TargetConfig) -> Target:
    """Decay the drift of a person out of sight."""
    return replace(target, drift_rad_s=target.drift_rad_s * math.exp(-step_s / config.drift_s))


def look_again(
    target: Target, person: SeenPerson, time_s: float, step_s: float, config: TargetConfig
) -> Target:
    """Update a predicted target with a new image: an alpha-beta filter on bearing, an average on height."""
    surprise = bearing(person.x, config) - target.bearing_rad
    share = 1.0 - math.exp(-step_s / config.height_s)
    return Target(
        id=person.id,
        seen_s=time_s,
        bearing_rad=target.bearing_rad + config.bearing_gain * surprise,
        drift_rad_s=target.drift_rad_s + config.drift_gain * surprise / step_s,
        height=target.height * (person.height / target.height) ** share,
    )


# Occlusion of the followed person by another one: the occluder, and the possible bearings meanwhile.


@dataclass(frozen=True, slots=True, kw_only=True)
class OccluderConfig:
    """Which people can occlude the followed one.

    Attributes:
        behind_rad: [rad] greatest angle between the person and an occluder.
        nearer: least ratio of the occluder's apparent height to the person's.
        half_width: [rad per image height] half the angle that a person covers, by the apparent height.
    """

    behind_rad: float = math.radians(9.0)
    nearer: float = 0.9
    half_width: float = 0.12


def hider(
    people: Iterable[SeenPerson], target: Target, config: OccluderConfig, view: TargetConfig
) -> SeenPerson | None:
    """Return a person who is nearer than the followed one and near its predicted bearing, or None."""
    in_front = [
        (abs(bearing(other.x, view) - target.bearing_rad), other)
        for other in people
        if other.is_sound
        and other.is_visible
        and other.id != target.id
        and other.height > config.nearer * target.height
    ]
    off_rad, other = min(in_front, key=lambda pair: pair[0], default=(math.inf, None))
    return other if off_rad < config.behind_rad else None


def keep_behind(
    target: Target, people: Iterable[SeenPerson], config: OccluderConfig, view: TargetConfig
) -> Target:
    """Move an occluded person along with the occluder, since a person who steps out would be visible."""
    other = hider(people, target, config, view)
    if other is None:
        return target
    middle, half = bearing(other.x, view), config.half_width * other.height
    return replace(target, bearing_rad=min(max(target.bearing_rad, middle - half), middle + half))
