"""The followed person as the robot remembers it between images: bearing, drift and apparent height."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from peopleboy.behaviours.dead_reckoning import Motion
from peopleboy.behaviours.percept import SeenPerson


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetConfig:
    """Smoothing of what the image says about the followed person.

    Attributes:
        half_view_rad: [rad] bearing of the image's left border; the thermal camera's 320 x 240 at 44 degrees.
        bearing_gain: share of a bearing's surprise that is believed at once.
        drift_gain: [1/frame] share of it that is put down to the person's movement.
        height_s: [s] time constant over which the apparent height is averaged.
        drift_s: [s] time constant at which the drift of a person out of sight is forgotten.
    """

    half_view_rad: float = math.atan(4.0 / 3.0 * math.tan(math.radians(22.0)))
    bearing_gain: float = 0.6
    drift_gain: float = 0.12
    height_s: float = 0.25
    drift_s: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Target:
    """One person as seen from the robot; no metric position.

    Attributes:
        id: the track's number.
        seen_s: [s] time of the last image that showed the person.
        bearing_rad: [rad] direction from the robot's nose, positive to the left.
        drift_rad_s: [rad/s] rate at which the bearing would change if the robot did not turn.
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
    """Start to remember a person."""
    return Target(
        id=person.id,
        seen_s=time_s,
        bearing_rad=bearing(person.x, config),
        drift_rad_s=0.0,
        height=person.height,
    )


def carry_on(target: Target, motion: Motion) -> Target:
    """Predict the bearing after the robot has moved; nothing else changes."""
    moved = target.bearing_rad + (target.drift_rad_s - motion.angular_rad_s) * motion.step_s
    return replace(target, bearing_rad=math.remainder(moved, math.tau))


def forget_drift(target: Target, step_s: float, config: TargetConfig) -> Target:
    """Trust the drift of a person out of sight less and less."""
    return replace(target, drift_rad_s=target.drift_rad_s * math.exp(-step_s / config.drift_s))


def look_again(
    target: Target, person: SeenPerson, time_s: float, step_s: float, config: TargetConfig
) -> Target:
    """Correct a predicted target by a new image: an alpha-beta filter on bearing, an average on height."""
    surprise = bearing(person.x, config) - target.bearing_rad
    share = 1.0 - math.exp(-step_s / config.height_s)
    return Target(
        id=person.id,
        seen_s=time_s,
        bearing_rad=target.bearing_rad + config.bearing_gain * surprise,
        drift_rad_s=target.drift_rad_s + config.drift_gain * surprise / step_s,
        height=target.height * (person.height / target.height) ** share,
    )
