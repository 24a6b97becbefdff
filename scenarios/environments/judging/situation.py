"""How the robot stands to the person to follow and to the corridor, and what happens to it (kernels)."""

from __future__ import annotations

import math
from typing import Any, Final, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.robot.robot_body import RADIUS_M
from peopleboy.sim.truth.scenes import SEEN, Records

LOST_S: Final = 10.0
NOBODY_M: Final = 1000.0  # stands for a distance or gap where there is nobody
EPISODE: Final = np.dtype(
    [
        ("start", np.float64, 3),  # [m, m, rad] odometry at the beginning
        ("action", np.float64, 2),  # the last one
        ("frame", np.int64),  # steps so far
        ("frames", np.int64),  # when time is over
        ("dt_s", np.float64),
        ("keep_m", np.float64),  # distance to keep
        ("limits", np.float64, 2),  # [m/s, rad/s] of the drive
        ("unseen_s", np.float64),  # for which the person to follow has been out of sight
        ("has_seen", np.int64),  # number of the person to follow, once seen
        ("seen", np.uint64),  # a bit for each person who is seen, the first one's is the lowest
        ("is_touching", np.bool_),
        ("is_over", np.bool_),
        ("holders", np.float64, 5),  # numbers of the people who have the rows of `tracks`, if normalised
    ]
)
"""What is known of an episode under way."""

Array = NDArray[np.float64]
Record = Any  # a row of records


class Situation(NamedTuple):
    """What the reward is about.

    Attributes:
        sees_target: whether the thermal camera could see the target now.
        distance_m: [m] on the floor to the target.
        bearing_rad: [rad] of the target from the robot's nose.
        gap_m: [m] between the outlines of the robot, a circle, and the nearest person.
        along_m_s: [m/s] speed along the corridor's axis, either way.
        lateral_share: offset from the corridor's centre line in half widths, left positive.
        collided: whether the robot touches anything but the floor.
        is_lost: whether the target was out of sight for 10 s after it had been seen.
    """

    sees_target: bool
    distance_m: float
    bearing_rad: float
    gap_m: float
    along_m_s: float
    lateral_share: float
    collided: bool
    is_lost: bool


@njit(cache=True)
def judge(episode: Record, scene: Record, people: Records, areas: Array, may_lose: bool) -> Situation:
    """Look at the next instant of an episode, whose record is kept up to date.

    The person to follow is the first in the scenario's order who is present.

    Args:
        episode: record EPISODE.
        scene: record SCENE.
        people: records BYSTANDER.
        areas: (A, 4) [m] of the place, as `areas_of` gives them.
        may_lose: whether an episode ends when its target is lost.
    """
    is_there = scene.end > scene.first
    sees, distance_m, bearing_rad = False, NOBODY_M, 0.0
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
    gap_m, seen = NOBODY_M if not is_there else math.inf, np.uint64(0)
    for k in range(scene.first, scene.end):
        gap_m = min(gap_m, people[k].distance_m - people[k].radius_m - RADIUS_M)
        if people[k].free_ray_share > SEEN:
            seen |= np.uint64(1) << np.uint64(people[k].id - 1)
    episode.seen = seen
    along, lateral = _corridor_motion(scene, areas)
    is_lost = may_lose and episode.unseen_s >= LOST_S
    return Situation(
        sees, distance_m, bearing_rad, gap_m, along, lateral, scene.is_touching, is_lost
    )  # fmt: skip


@njit(cache=True)
def _corridor_motion(scene: Record, areas: Array) -> tuple[float, float]:
    """Speed [m/s] along the axis of the corridor's leg, and the offset from its middle in half widths.

    At a corner the leg is the one along which the robot rather looks.
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
    """(A, 4) [m] min_x, min_y, max_x, max_y of the areas of a floor plan."""
    rows = [(area.min_x, area.min_y, area.max_x, area.max_y) for _, area in plan.areas]
    return np.array(rows, np.float64).reshape(-1, 4)
