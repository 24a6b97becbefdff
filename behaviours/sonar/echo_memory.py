"""Near echoes remembered for a while, because the sonars' cones leave gaps in which a door post vanishes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from peopleboy.behaviours.dead_reckoning import Motion
from peopleboy.behaviours.percept import Percept, Points, Ranges
from peopleboy.behaviours.sonar.echo_points import echoes


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
    points = np.concatenate([Motion.of(percept, step_s).carry(memory.points), heard])
    heard_s = np.concatenate([memory.heard_s, np.full(len(heard), percept.time_s)])
    is_kept = (np.hypot(points[:, 0], points[:, 1]) < config.within_m) & (
        np.abs(percept.time_s - heard_s) < config.keep_s
    )
    return EchoMemory(time_s=percept.time_s, points=points[is_kept], heard_s=heard_s[is_kept])
