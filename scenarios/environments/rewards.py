"""What a controller earns in one control step.

    reward = keep + face + progress + centre + space + change + collision + lost

Its unit is one second of the task done perfectly. With dt [s] the length of a step, d [m] the floor distance
to the person to follow, b [rad] the person's bearing, v [m/s] the speed along the corridor, y [m] the
distance from the corridor's centre line, W [m] its width, g [m] the gap to the nearest person, a [-1..1] the
action:

    keep      = dt / 2 * max(0, 1 - |d - d_keep| / 3 m)      while the person is seen
    face      = dt / 2 * max(0, 1 - |b| / (pi / 3))          while the person is seen
    progress  = dt * |v| / v_max                             in a corridor
    centre    = -dt / 2 * |y| / (W / 2)                      in a corridor
    space     = -dt / 2 * max(0, 1 - g / 1.2 m)
    change    = -dt / 20 * |a - a_before|^2
    collision = -10                                          once; the episode ends
    lost      = -10                                          once; the episode ends

"follow" earns keep and face, "corridor" progress and centre, "patrol" the former while the person is seen
and the latter otherwise; the rest counts in all three.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

from peopleboy.scenarios.environments.situation import Situation

TASKS: Final = ("follow", "corridor", "patrol")
TERMS: Final = ("keep", "face", "progress", "centre", "space", "change", "collision", "lost")
COLLISION: Final = -10.0
LOST: Final = -10.0
PERSONAL_SPACE_M: Final = 1.2
_KEEP_WITHIN_M: Final = 3.0
_FACE_WITHIN_RAD: Final = math.pi / 3.0

Action = Sequence[float]


def reward_terms(
    task: str,
    situation: Situation,
    *,
    dt_s: float,
    keep_m: float,
    max_linear_m_s: float,
    action: Action,
    before: Action,
) -> dict[str, float]:
    """Give every term of the reward by name; their sum is the reward."""
    terms = dict.fromkeys(TERMS, 0.0)
    follows = task == "follow" or (task == "patrol" and situation.sees_target)
    if follows and situation.sees_target:
        terms["keep"] = dt_s / 2.0 * _near(situation.distance_m - keep_m, _KEEP_WITHIN_M)
        terms["face"] = dt_s / 2.0 * _near(situation.bearing_rad, _FACE_WITHIN_RAD)
    if not follows:
        terms["progress"] = dt_s * abs(situation.along_m_s) / max_linear_m_s
        terms["centre"] = -dt_s / 2.0 * min(abs(situation.lateral_share), 1.0)
    terms["space"] = -dt_s / 2.0 * _near(max(situation.gap_m, 0.0), PERSONAL_SPACE_M)
    change = sum((new - old) ** 2 for new, old in zip(action, before, strict=True))
    terms["change"] = -dt_s / 20.0 * change
    terms["collision"] = COLLISION if situation.collided else 0.0
    terms["lost"] = LOST if situation.is_lost else 0.0
    return terms


def _near(error: float, within: float) -> float:
    """1 without error, falling to 0 at `within`."""
    return max(0.0, 1.0 - abs(error) / within)
