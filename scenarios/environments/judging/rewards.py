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
from typing import Final

from numba import njit

from peopleboy.scenarios.environments.judging.situation import Array, Record, Situation, judge
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.truth.scenes import Records

TASKS: Final = ("follow", "corridor", "patrol")
TERMS: Final = ("keep", "face", "progress", "centre", "space", "change", "collision", "lost")
ENDS: Final = tuple(TERMS.index(name) for name in ("collision", "lost"))  # terms with which an episode ends
COLLISION: Final = -10.0
LOST: Final = -10.0
PERSONAL_SPACE_M: Final = 1.2
_KEEP_WITHIN_M: Final = 3.0
_FACE_WITHIN_RAD: Final = math.pi / 3.0
_FOLLOW, _CORRIDOR, _PATROL = range(len(TASKS))
_KEEP, _FACE, _PROGRESS, _CENTRE, _SPACE, _CHANGE, _COLLISION, _LOST = range(len(TERMS))


@njit(cache=True, nogil=True)
def reward_worlds(
    task: int,
    numbers: Numbers,
    episodes: Records,
    scenes: Records,
    people: Records,
    areas: Array,
    first_area: Numbers,
    actions: Array,
    two: float,
    terms: Array,
) -> None:
    """Judge the next instant of some episodes, and what their controllers earn by it.

    Args:
        task: number in `TASKS`.
        numbers: (G,) of the episodes.
        episodes: records EPISODE of all, kept up to date.
        scenes: (G,) records SCENE.
        people: records BYSTANDER of those.
        areas: (A, 4) of the places of all episodes, one after the other, as in `judge`.
        first_area: (B + 1,) where those of each begin.
        actions: (G, 2) that led here.
        two: 2, told so late that squares are made by the library's power, as Python makes them.
        terms: (G, 8) get those of the reward in the order of `TERMS`; their sum is the reward.
    """
    for row in range(len(numbers)):
        number = numbers[row]
        own, episode = areas[first_area[number] : first_area[number + 1]], episodes[number]
        situation = judge(episode, scenes[row], people, own, task != _CORRIDOR)
        _earn(task, situation, episode, actions[row], two, terms[row])
        episode.action[0], episode.action[1] = actions[row, 0], actions[row, 1]
        ends = situation.collided or situation.is_lost
        episode.is_over = ends or episode.frame >= episode.frames


@njit(cache=True)
def _earn(task: int, situation: Situation, episode: Record, action: Array, two: float, terms: Array) -> None:
    dt_s = episode.dt_s
    follows = task == _FOLLOW or (task == _PATROL and situation.sees_target)
    terms[:] = 0.0
    if follows and situation.sees_target:
        terms[_KEEP] = dt_s / 2.0 * _near(situation.distance_m - episode.keep_m, _KEEP_WITHIN_M)
        terms[_FACE] = dt_s / 2.0 * _near(situation.bearing_rad, _FACE_WITHIN_RAD)
    if not follows:
        terms[_PROGRESS] = dt_s * abs(situation.along_m_s) / episode.limits[0]
        terms[_CENTRE] = -dt_s / 2.0 * min(abs(situation.lateral_share), 1.0)
    terms[_SPACE] = -dt_s / 2.0 * _near(max(situation.gap_m, 0.0), PERSONAL_SPACE_M)
    change = (action[0] - episode.action[0]) ** two + (action[1] - episode.action[1]) ** two
    terms[_CHANGE] = -dt_s / 20.0 * change
    terms[_COLLISION] = COLLISION if situation.collided else 0.0
    terms[_LOST] = LOST if situation.is_lost else 0.0


@njit(cache=True)
def _near(error: float, within: float) -> float:
    """1 without error, falling to 0 at `within`."""
    return max(0.0, 1.0 - abs(error) / within)
