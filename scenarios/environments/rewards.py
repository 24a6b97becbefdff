"""Compute the reward of a controller for one control step.

    reward = keep + face + progress + centre + approach + space + change + collision + lost + arrival

The unit is one second of perfect performance. With dt [s] the length of a step, d [m] the floor distance
to the person to follow, b [rad] the bearing of that person, v [m/s] the speed along the corridor, y [m] the
distance from the corridor's centre line, W [m] its width, r [m] the distance to the goal, g [m] the gap to
the nearest person, a [-1..1] the action:

    keep      = dt / 2 * max(0, 1 - |d - d_keep| / 3 m)      while the person is visible
    face      = dt / 2 * max(0, 1 - |b| / (pi / 3))          while the person is visible
    progress  = dt * |v| / v_max                             in a corridor
    centre    = -dt / 2 * min(1, |y| / (W / 2))              in a corridor
    approach  = (r_before - r) / v_max                       towards the goal
    space     = -dt / 2 * max(0, 1 - g / 1.2 m)
    change    = -dt / 20 * |a - a_before|^2
    collision = -10                                          once; the episode ends
    lost      = -10                                          once; the episode ends
    arrival   = 10                                           once, at 0.5 m from the goal; the episode ends

"follow" includes keep and face, "corridor" includes progress and centre, "patrol" includes keep and face
while the person is visible, and progress and centre otherwise, "go_to" includes approach and arrival; lost is
part of "follow" and "patrol", and the other terms of all four.
"""

import math
from typing import Any, Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.scenarios.scores.goal_metrics import REACHED_M
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.robot.robot_body import RADIUS_M
from peopleboy.sim.shapes.shape_table import Numbers
from peopleboy.sim.truth.scenes import SEEN, Records

# Pose of the robot relative to the person to follow and to the corridor, and what happens to it (kernels).

LOST_S: Final = 10.0
NO_PERSON_M: Final = 1000.0  # distance or gap to a person if there is no person
EPISODE: Final = np.dtype(
    [
        ("start", np.float64, 3),  # [m, m, rad] odometry at the start
        ("action", np.float64, 2),  # the last action
        ("frame", np.int64),  # steps so far
        ("frames", np.int64),  # steps after which the episode is truncated
        ("dt_s", np.float64),
        ("keep_m", np.float64),  # [m] distance to keep
        ("limits", np.float64, 2),  # [m/s, rad/s] of the drive
        ("goal", np.float64, 2),  # [m] in the world frame, NaN without a goal
        ("away_m", np.float64),  # [m] distance from the goal at the last instant
        ("unseen_s", np.float64),  # [s] since the person to follow was last visible
        ("has_seen", np.int64),  # number of the person to follow, once seen
        ("seen", np.uint64),  # one bit for each visible person; the lowest bit is the first person
        ("is_touching", np.bool_),
        ("is_over", np.bool_),
        ("holders", np.float64, 5),  # ids of the people in the rows of `tracks`, if normalised
    ]
)
"""State of the current or last episode."""

Array = NDArray[np.float64]
Record = Any  # a row of records


class Situation(NamedTuple):
    """Inputs of the reward.

    Attributes:
        sees_target: whether the target is visible to the thermal camera.
        distance_m: [m] floor distance to the target.
        bearing_rad: [rad] bearing of the target from the robot's heading.
        gap_m: [m] between the outlines of the robot, a circle, and the nearest person.
        along_m_s: [m/s] absolute speed along the corridor's axis.
        lateral_share: offset from the corridor's centre line in half widths, left positive.
        collided: whether the robot touches anything but the floor.
        is_lost: whether the target has been out of sight for 10 s after it was seen.
        away_m: [m] distance from the goal, NaN without a goal.
    """

    sees_target: bool
    distance_m: float
    bearing_rad: float
    gap_m: float
    along_m_s: float
    lateral_share: float
    collided: bool
    is_lost: bool
    away_m: float


@njit(cache=True)
def observe_situation(
    episode: Record, scene: Record, people: Records, areas: Array, may_lose: bool
) -> Situation:
    """Evaluate the next instant of an episode, and update its record.

    The person to follow is the first present person in the scenario's order.

    Args:
        episode: record EPISODE.
        scene: record SCENE.
        people: records BYSTANDER.
        areas: (A, 4) [m] areas of the place, from `areas_of`.
        may_lose: whether an episode ends when its target is lost.
    """
    is_there = scene.end > scene.first
    sees, distance_m, bearing_rad = False, NO_PERSON_M, 0.0
    if is_there:
        target = people[scene.first]
        sees, distance_m = target.free_ray_share > SEEN, target.distance_m
        bearing_rad = target.bearing_rad
        if sees or target.id != episode.has_seen:
            episode.unseen_s = 0.0
        else:
            episode.unseen_s += episode.dt_s
        if sees:
            episode.has_seen = target.id
    else:
        episode.unseen_s = 0.0
    gap_m, seen = NO_PERSON_M if not is_there else math.inf, np.uint64(0)
    for k in range(scene.first, scene.end):
        gap_m = min(gap_m, people[k].distance_m - people[k].radius_m - RADIUS_M)
        if people[k].free_ray_share > SEEN:
            seen |= np.uint64(1) << np.uint64(people[k].id - 1)
    episode.seen = seen
    along, lateral = _corridor_motion(scene, areas)
    is_lost = may_lose and episode.unseen_s >= LOST_S
    away_m = math.hypot(scene.robot[0] - episode.goal[0], scene.robot[1] - episode.goal[1])
    return Situation(
        sees, distance_m, bearing_rad, gap_m, along, lateral, scene.is_touching, is_lost, away_m
    )  # fmt: skip


@njit(cache=True)
def _corridor_motion(scene: Record, areas: Array) -> tuple[float, float]:
    """Return the speed [m/s] along the corridor's leg, and the offset from its middle in half widths.

    At a corner, the leg is the one whose direction is closer to the robot's heading.
    """
    x, y, heading = scene.robot[0], scene.robot[1], scene.robot[2]
    speed, cos, sin = scene.velocity[0], math.cos(heading), math.sin(heading)
    along, lateral, is_inside = 0.0, 0.0, False
    for k in range(len(areas)):
        min_x, min_y, max_x, max_y = areas[k, 0], areas[k, 1], areas[k, 2], areas[k, 3]
        if not (min_x <= x <= max_x and min_y <= y <= max_y):
            continue
        width, depth = max_x - min_x, max_y - min_y
        if width >= depth:
            own, aside = speed * cos, (y - (min_y + max_y) / 2.0) / (depth / 2.0)
        else:
            own, aside = speed * sin, -((x - (min_x + max_x) / 2.0) / (width / 2.0))
        if not is_inside or abs(own) > abs(along):
            along, lateral, is_inside = own, aside, True
    return along, lateral


def areas_of(plan: FloorPlan) -> Array:
    """Return the areas of a floor plan, (A, 4) [m] min_x, min_y, max_x, max_y."""
    rows = [(area.min_x, area.min_y, area.max_x, area.max_y) for _, area in plan.areas]
    return np.array(rows, np.float64).reshape(-1, 4)


TASKS: Final = ("follow", "corridor", "patrol", "go_to")
TERMS: Final = (
    "keep", "face", "progress", "centre", "approach", "space", "change", "collision", "lost", "arrival",
)  # fmt: skip
ENDS: Final = tuple(TERMS.index(name) for name in ("collision", "lost", "arrival"))  # that end an episode
COLLISION: Final = -10.0
LOST: Final = -10.0
ARRIVAL: Final = 10.0
PERSONAL_SPACE_M: Final = 1.2
_KEEP_WITHIN_M: Final = 3.0
_FACE_WITHIN_RAD: Final = math.pi / 3.0
_FOLLOW, _CORRIDOR, _PATROL, _GO_TO = range(len(TASKS))
_KEEP, _FACE, _PROGRESS, _CENTRE, _APPROACH, _SPACE, _CHANGE, _COLLISION, _LOST, _ARRIVAL = range(len(TERMS))


@njit(cache=True, nogil=True)
def compute_rewards(
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
    """Evaluate the next instant of some episodes, and compute the rewards.

    Args:
        task: index in `TASKS`.
        numbers: (G,) numbers of the episodes.
        episodes: records EPISODE of all episodes, updated in place.
        scenes: (G,) records SCENE.
        people: records BYSTANDER of the scenes.
        areas: (A, 4) areas of the places of all episodes, concatenated, as in `observe_situation`.
        first_area: (B + 1,) row at which the areas of each episode begin.
        actions: (G, 2) actions that led to this instant.
        two: 2, passed as an argument so that squares use the library's power function, as in Python.
        terms: (G, 10) output: terms of the reward in the order of `TERMS`; their sum is the reward.
    """
    for row in range(len(numbers)):
        number = numbers[row]
        own, episode = areas[first_area[number] : first_area[number + 1]], episodes[number]
        may_lose = task in (_FOLLOW, _PATROL)
        situation = observe_situation(episode, scenes[row], people, own, may_lose)
        _earn(task, situation, episode, actions[row], two, terms[row])
        episode.action[0], episode.action[1] = actions[row, 0], actions[row, 1]
        episode.away_m = situation.away_m
        ends = situation.collided or situation.is_lost or terms[row, _ARRIVAL] != 0.0
        episode.is_over = ends or episode.frame >= episode.frames


@njit(cache=True)
def _earn(task: int, situation: Situation, episode: Record, action: Array, two: float, terms: Array) -> None:
    dt_s = episode.dt_s
    follows = task == _FOLLOW or (task == _PATROL and situation.sees_target)
    terms[:] = 0.0
    if follows and situation.sees_target:
        terms[_KEEP] = dt_s / 2.0 * _near(situation.distance_m - episode.keep_m, _KEEP_WITHIN_M)
        terms[_FACE] = dt_s / 2.0 * _near(situation.bearing_rad, _FACE_WITHIN_RAD)
    if task == _GO_TO:
        terms[_APPROACH] = (episode.away_m - situation.away_m) / episode.limits[0]
        terms[_ARRIVAL] = ARRIVAL if situation.away_m < REACHED_M else 0.0
    elif not follows:
        terms[_PROGRESS] = dt_s * abs(situation.along_m_s) / episode.limits[0]
        terms[_CENTRE] = -dt_s / 2.0 * min(abs(situation.lateral_share), 1.0)
    terms[_SPACE] = -dt_s / 2.0 * _near(max(situation.gap_m, 0.0), PERSONAL_SPACE_M)
    change = (action[0] - episode.action[0]) ** two + (action[1] - episode.action[1]) ** two
    terms[_CHANGE] = -dt_s / 20.0 * change
    terms[_COLLISION] = COLLISION if situation.collided else 0.0
    terms[_LOST] = LOST if situation.is_lost else 0.0


@njit(cache=True)
def _near(error: float, within: float) -> float:
    """Return 1 for no error, falling linearly to 0 at `within`."""
    return max(0.0, 1.0 - abs(error) / within)
