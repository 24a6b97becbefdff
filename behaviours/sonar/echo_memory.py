"""Near echoes remembered for a while, because the sonars' cones leave gaps in which a door post vanishes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from peopleboy.behaviours.percept import Percept, Ranges
from peopleboy.behaviours.sonar.echo_points import Points, echoes


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
    points = np.concatenate([_moved(memory, percept), heard])
    heard_s = np.concatenate([memory.heard_s, np.full(len(heard), percept.time_s)])
    is_kept = (np.hypot(points[:, 0], points[:, 1]) < config.within_m) & (
        np.abs(percept.time_s - heard_s) < config.keep_s
    )
    return EchoMemory(time_s=percept.time_s, points=points[is_kept], heard_s=heard_s[is_kept])


def _moved(memory: EchoMemory, percept: Percept) -> Points:
    """Express the old echoes in the robot's new frame: (N, 2) [m]."""
    step_s = 0.0 if math.isnan(memory.time_s) else percept.time_s - memory.time_s
    turn, way = percept.angular_rad_s * step_s, percept.linear_m_s * step_s
    shift = way * np.array([math.cos(turn / 2.0), math.sin(turn / 2.0)])
    cosine, sine = math.cos(turn), math.sin(turn)
    old_from_new = np.array([[cosine, -sine], [sine, cosine]])
    moved: Points = (memory.points - shift) @ old_from_new
    return moved
