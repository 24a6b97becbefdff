"""How who makes way walks on, by the social force: what people and kernels share (numba kernels)."""

from __future__ import annotations

import math
from typing import Final

from numba import njit

from peopleboy.sim.people.walking.social_force import KEEP_RIGHT_RAD, Obstacles, social_force

HURRY: Final = 1.3  # who gives way may be this much faster than planned (Helbing and Molnar 1995, eq. 11)
TAKEN_WITHIN_M: Final = 1.0  # how near to a waypoint one looks whether somebody stands on it
TAKEN_BY_M: Final = 0.6  # how near to it somebody stands then
_SETTLES_M_S: Final = 0.4  # so slow one settles beside a place that is taken
_PASSED_M: Final = 0.35  # how near to a waypoint one goes on to the next
_PASSED_TAKEN_M: Final = 0.9  # the same where others stand on it
TURNS_M_S: Final = 0.15  # who is slower keeps facing where he does
_ARRIVED_M: Final = 0.02  # how near to where one stops one does
_STUCK_M: Final = 0.5  # the same of who gets no nearer, as a wall or others are too near
_STUCK_S: Final = 1.0
_MOST_M_S2: Final = 4.0
_TRY_SIDE_S: Final = 2.0  # how long one tries to pass on one side


@njit(cache=True, nogil=True)
def velocity_by_force(
    at: tuple[float, float],
    velocity: tuple[float, float],
    goal: tuple[float, float],
    wanted_m_s: float,
    obstacles: Obstacles,
    bend_rad: float,
    dt_s: float,
) -> tuple[float, float]:
    """Give the velocity [m/s] after a step of a person who wants to a goal [m], at a speed.

    Nobody's changes by more than 4 m/s2; for the rest see `social_force`.
    """
    gap_x, gap_y = goal[0] - at[0], goal[1] - at[1]
    pace = wanted_m_s / max(math.hypot(gap_x, gap_y), 1e-9)
    x, y = social_force(at, velocity, (gap_x * pace, gap_y * pace), obstacles, bend_rad)
    share = dt_s * min(_MOST_M_S2 / max(math.hypot(x, y), 1e-9), 1.0)
    return velocity[0] + share * x, velocity[1] + share * y


@njit(cache=True)
def bend_rad(blocked_s: float) -> float:
    """To which side to give way [rad]: to the right; if that does not help, left and right in turn."""
    side = 1.0 if int(blocked_s / _TRY_SIDE_S) % 2 == 0 else -1.0
    return side * KEEP_RIGHT_RAD * (1.0 + min(blocked_s / _TRY_SIDE_S, 4.0))


@njit(cache=True)
def blocked_s(blocked_s: float, speed_m_s: float, wanted_m_s: float, dt_s: float) -> float:
    """Give for how long one has been slower than half as fast as one wanted to be, a step later."""
    return blocked_s + dt_s if speed_m_s < 0.5 * wanted_m_s else max(blocked_s - dt_s, 0.0)


@njit(cache=True)
def has_arrived(distance_m: float, blocked_s: float, speed_m_s: float, is_occupied: bool) -> bool:
    """Whether one stops where one is, so far from where the script says."""
    if is_occupied and speed_m_s < _SETTLES_M_S:
        return True
    return distance_m < (_STUCK_M if blocked_s > _STUCK_S else _ARRIVED_M)


@njit(cache=True)
def has_passed(distance_m: float, is_occupied: bool) -> bool:
    """Whether one goes on to the next waypoint, so far from this one."""
    return distance_m < (_PASSED_TAKEN_M if is_occupied else _PASSED_M)


@njit(cache=True)
def is_taken(place: tuple[float, float], obstacles: Obstacles) -> bool:
    """Whether anybody else, or the robot, stands on a place [m]."""
    people, walker, robot, _ = obstacles
    nearest = math.inf
    if robot[4] >= 0.0:
        nearest = math.hypot(robot[0] - place[0], robot[1] - place[1])
    for k in range(len(people)):
        if k != walker:
            nearest = min(nearest, math.hypot(people[k, 0] - place[0], people[k, 1] - place[1]))
    return nearest < TAKEN_BY_M
