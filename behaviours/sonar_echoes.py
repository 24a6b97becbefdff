"""Positions of the sonars' echoes around the robot."""

import math
from dataclasses import dataclass, field

import numpy as np

from peopleboy.behaviours.dead_reckoning import RobotMotion
from peopleboy.behaviours.percept import Percept, Points, Ranges

# The PeopleBot's ring: an ellipse within 3 cm of ARIA's peoplebot-sh.p, SonarUnit 0..15, except the four
# sideways units, which are 11 cm in front of and behind it.
RING_CENTRE_X_M = -0.044
RING_HALF_AXES_M = (0.21, 0.14)
BESIDE_RAD = math.radians(7.5)  # half a beam's opening


def echoes(percept: Percept, spread_rad: float = 0.0) -> Points:
    """Return the position of each sonar's echo: (N, 2) [m], x forward, y left, origin between the wheels.

    A range that is NaN or negative counts as an obstacle at the sonar itself.

    Args:
        percept: with the sonars' ranges.
        spread_rad: [rad] offset from the beam's axis, towards the robot's side: BESIDE_RAD is for a wall
            parallel to the path, whose echo comes from the edge of the beam.
    """
    ranges = np.where(np.isfinite(percept.sonar_m), np.maximum(percept.sonar_m, 0.0), 0.0)
    angle = percept.sonar_angle_rad + spread_rad * np.sign(np.round(np.sin(2.0 * percept.sonar_angle_rad), 6))
    axes = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points: Points = axes * (np.array(RING_HALF_AXES_M) + ranges[:, None])
    points[:, 0] += RING_CENTRE_X_M
    return points


def fill_drop_outs(ranges: list[Points]) -> Points:
    """Return the minimum of each sonar's last few ranges: (N,) [m].

    A lost echo reads as free space, so the nearest of a few readings is the most reliable. NaN stays NaN.

    Args:
        ranges: (N,) [m] each, newest last, at least one; arrays of another length are ignored.
    """
    nearest: Points = np.min([r for r in ranges if r.shape == ranges[-1].shape], axis=0)
    return nearest


# Near echoes are stored for a while, since a door post can vanish in the gaps between the sonars' cones.


@dataclass(frozen=True, slots=True, kw_only=True)
class EchoMemoryConfig:
    """Settings of the memory of echoes.

    Attributes:
        keep_s: [s] time after which an echo is deleted, since people move on.
        within_m: [m] echoes farther from the robot's origin are not stored.
    """

    keep_s: float = 12.0
    within_m: float = 0.45


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EchoMemory:
    """Echoes of the last seconds, in the moving robot's frame.

    Attributes:
        time_s: [s] time of the last percept.
        points: (N, 2) [m] positions in the robot frame at that time.
        heard_s: (N,) [s] time of each echo.
    """

    time_s: float = math.nan
    points: Points = field(default_factory=lambda: np.zeros((0, 2)))
    heard_s: Ranges = field(default_factory=lambda: np.zeros(0))


def remember(
    memory: EchoMemory, percept: Percept, config: EchoMemoryConfig, spread_rad: float = 0.0
) -> EchoMemory:
    """Move the echoes by wheel odometry, remove old and far ones, and add new ones.

    Invalid input leaves the memory unchanged. Echoes are placed spread_rad [rad] off the beams' axes.
    """
    if not percept.is_sound:
        return memory
    heard = echoes(percept, spread_rad)
    step_s = 0.0 if math.isnan(memory.time_s) else percept.time_s - memory.time_s
    points = np.concatenate([RobotMotion.of(percept, step_s).carry(memory.points), heard])
    heard_s = np.concatenate([memory.heard_s, np.full(len(heard), percept.time_s)])
    is_kept = (np.hypot(points[:, 0], points[:, 1]) < config.within_m) & (
        np.abs(percept.time_s - heard_s) < config.keep_s
    )
    return EchoMemory(time_s=percept.time_s, points=points[is_kept], heard_s=heard_s[is_kept])
