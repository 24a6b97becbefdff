"""Where the sonars' echoes lie around the robot."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from peopleboy.behaviours.dead_reckoning import RobotMotion
from peopleboy.behaviours.percept import Percept, Points, Ranges

# The PeopleBot's ring: an ellipse within 3 cm of ARIA's peoplebot-sh.p, SonarUnit 0..15, except the four
# units that look sideways, which sit 11 cm fore and aft of it.
RING_CENTRE_X_M = -0.044
RING_HALF_AXES_M = (0.21, 0.14)
BESIDE_RAD = math.radians(7.5)  # half a beam's opening


def echoes(percept: Percept, spread_rad: float = 0.0) -> Points:
    """Place each sonar's echo in its beam: (N, 2) [m], x forward, y left, origin between the wheels.

    A range that is no number, or negative, counts as an obstacle at the sonar itself.

    Args:
        percept: with the sonars' ranges.
        spread_rad: [rad] how far off the beam's axis, towards the robot's side: BESIDE_RAD places a wall
            beside the way, whose echo comes from the edge of the beam.
    """
    ranges = np.where(np.isfinite(percept.sonar_m), np.maximum(percept.sonar_m, 0.0), 0.0)
    angle = percept.sonar_angle_rad + spread_rad * np.sign(np.round(np.sin(2.0 * percept.sonar_angle_rad), 6))
    axes = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points: Points = axes * (np.array(RING_HALF_AXES_M) + ranges[:, None])
    points[:, 0] += RING_CENTRE_X_M
    return points


def fill_drop_outs(ranges: list[Points]) -> Points:
    """Take each sonar's nearest range of the last few readings: (N,) [m].

    A lost echo reads as free space, so the nearest of a few readings is the one to trust. No number stays
    no number.

    Args:
        ranges: (N,) [m] each, newest last, at least one; those of another length are left out.
    """
    nearest: Points = np.min([r for r in ranges if r.shape == ranges[-1].shape], axis=0)
    return nearest


# Near echoes remembered for a while, because the sonars' cones leave gaps in which a door post vanishes.


@dataclass(frozen=True, slots=True, kw_only=True)
class EchoMemoryConfig:
    """What is remembered.

    Attributes:
        keep_s: [s] time after which an echo is forgotten; people move on, posts do not.
        within_m: [m] echoes farther from the robot's origin are not remembered.
    """

    keep_s: float = 12.0
    within_m: float = 0.45


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EchoMemory:
    """Echoes of the last seconds, moved along with the robot.

    Attributes:
        time_s: [s] of the last sight.
        points: (N, 2) [m] robot frame at that time.
        heard_s: (N,) [s] when each was heard.
    """

    time_s: float = math.nan
    points: Points = field(default_factory=lambda: np.zeros((0, 2)))
    heard_s: Ranges = field(default_factory=lambda: np.zeros(0))


def remember(
    memory: EchoMemory, percept: Percept, config: EchoMemoryConfig, spread_rad: float = 0.0
) -> EchoMemory:
    """Move the echoes by the wheels' motion, forget the old and the far, take in the new.

    Senseless input leaves the memory as it is. Echoes are placed spread_rad [rad] off the beams' axes.
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
