"""Walking by records and making way for others (numba kernels)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.people.scripted.script import Records, Scripts
from peopleboy.sim.people.scripted.walk_records import Record, arrive, braking_speed, turn_to
from peopleboy.sim.people.walking.giving_way import (
    HURRY,
    TAKEN_WITHIN_M,
    TURNS_M_S,
    bend_rad,
    blocked_s,
    has_arrived,
    has_passed,
    is_taken,
    velocity_by_force,
)
from peopleboy.sim.people.walking.social_force import Obstacles

Array = NDArray[np.float64]


@njit(cache=True)
def motion_of(first: int, end: int, walks: Records) -> Array:
    """Give (N, 4) x, y [m] and velocities [m/s] of those who are there, if anybody makes way."""
    yields, count = False, 0
    motion = np.empty((end - first, 4))
    for q in range(first, end):
        walk = walks[q]
        yields = yields or walk.yields
        if walk.is_present:
            motion[count, 0], motion[count, 1] = walk.position[0], walk.position[1]
            motion[count, 2], motion[count, 3] = walk.velocity[0], walk.velocity[1]
            count += 1
    return motion[: count if yields else 0]


@njit(cache=True)
def make_way(
    walk: Record,
    scripts: Scripts,
    q: int,
    dt_s: float,
    obstacles: Obstacles,
    two: float,
) -> None:
    """See `Walker._give_way`."""
    pieces, first = scripts.pieces, scripts.first_piece[q]
    goal = pieces[first + walk.piece].goal
    waypoint = scripts.waypoints[scripts.first_waypoint[q] + goal]
    target = (waypoint.at[0], waypoint.at[1])
    wanted, limit = waypoint.speed, HURRY * waypoint.speed
    is_last = goal == pieces[first + walk.end_piece - 1].goal
    if is_last:
        braking = braking_speed(_gap(walk, target), 0.0, dt_s, two)
        wanted, limit = min(wanted, braking), min(limit, braking)
    x, y = velocity_by_force(
        (walk.position[0], walk.position[1]), (walk.velocity[0], walk.velocity[1]), target, wanted,
        obstacles, bend_rad(walk.blocked_s), dt_s,
    )  # fmt: skip
    fast = math.sqrt(x * x + y * y)
    share = 1.0 if fast <= limit else limit / fast
    walk.speed = min(fast, limit)
    walk.velocity[0], walk.velocity[1] = x * share, y * share
    walk.position[0] += walk.velocity[0] * dt_s
    walk.position[1] += walk.velocity[1] * dt_s
    if walk.speed > TURNS_M_S:
        turn_to(walk, dt_s, math.atan2(y, x))
    walk.blocked_s = blocked_s(walk.blocked_s, walk.speed, wanted, dt_s)
    if _gap(walk, target) < TAKEN_WITHIN_M:
        _pass_waypoint(walk, scripts, q, goal, target, is_last, is_taken(target, obstacles))


@njit(cache=True)
def _pass_waypoint(
    walk: Record,
    scripts: Scripts,
    q: int,
    goal: int,
    target: tuple[float, float],
    is_last: bool,
    is_occupied: bool,
) -> None:
    """See `Walker._pass_waypoint`."""
    distance = _gap(walk, target)
    if is_last:
        if has_arrived(distance, walk.blocked_s, walk.speed, is_occupied):
            arrive(walk, scripts, q, goal)
    elif has_passed(distance, is_occupied):
        walk.reached = goal
        while scripts.pieces[scripts.first_piece[q] + walk.piece].goal <= goal:
            walk.piece += 1


@njit(cache=True)
def _gap(walk: Record, target: tuple[float, float]) -> float:
    x, y = target[0] - walk.position[0], target[1] - walk.position[1]
    return math.sqrt(x * x + y * y)
