"""What all who walk by records do: turn, stop at the end of a way, brake in time (numba kernels)."""

from __future__ import annotations

import math
from typing import Any

from numba import njit

from peopleboy.sim.geometry.angles import remainder
from peopleboy.sim.people.scripted.script import Scripts
from peopleboy.sim.people.walking.walk import ACCELERATION_M_S2, STEER_GAIN, TURN_RATE_RAD_S

Record = Any  # a row of records


@njit(cache=True)
def arrive(walk: Record, scripts: Scripts, q: int, goal: int) -> None:
    """See `Walker._arrive`."""
    waypoint = scripts.waypoints[scripts.first_waypoint[q] + goal]
    walk.velocity[0] = walk.velocity[1] = walk.speed = 0.0
    walk.pause_left, walk.reached, walk.piece = waypoint.pause_s, goal, -1
    if waypoint.has_pause:
        walk.posture = waypoint.posture


@njit(cache=True)
def braking_speed(distance: float, final_squared: float, dt_s: float, two: float) -> float:
    """Give the highest speed [m/s] from which the final one is reached within a distance [m]."""
    lost = ACCELERATION_M_S2 * dt_s / 2.0
    return math.sqrt(lost**two + 2.0 * ACCELERATION_M_S2 * max(distance, 0.0) + final_squared) - lost


@njit(cache=True)
def turn_to(walk: Record, dt_s: float, wanted: float) -> None:
    """See `Walker._turn`."""
    turn = remainder(wanted - walk.heading) * min(STEER_GAIN * dt_s, 1.0)
    turn = min(max(turn, -TURN_RATE_RAD_S * dt_s), TURN_RATE_RAD_S * dt_s)
    walk.turn_rate = turn / dt_s
    walk.heading = remainder(walk.heading + turn)
