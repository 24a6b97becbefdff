"""One control step of people whom nothing guides but their scripts and who is in their way (numba kernels).

Does to the last bit what `Walker` does, of which it is the part without errands and wishes.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.angles import remainder
from peopleboy.sim.people.body.postures import RISE_S, Posture
from peopleboy.sim.people.body.stance import POSTURES
from peopleboy.sim.people.walking.script import NOTHING, POINT, Records, Scripts
from peopleboy.sim.people.walking.social_force import (
    HURRY,
    TAKEN_WITHIN_M,
    TURNS_M_S,
    Obstacles,
    RobotMotion,
    bend_rad,
    blocked_s,
    has_arrived,
    has_passed,
    is_taken,
    velocity_by_force,
)
from peopleboy.sim.people.walking.walker import (
    ACCELERATION_M_S2,
    BRAKE_M_S2,
    KEEP_CLEAR_M,
    LONGEST_STEP_S,
    START_WITHIN_RAD,
    STEER_GAIN,
    TURN_RATE_RAD_S,
)

# Walking by records and making way for others (numba kernels).


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


# What all who walk by records do: turn, stop at the end of a way, brake in time (numba kernels).

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


Array = NDArray[np.float64]

STANDING = POSTURES[Posture.STANDING]


@njit(cache=True, nogil=True)
def walk_on(
    first: int,
    end: int,
    walks: Records,
    scripts: Scripts,
    time_s: float,
    dt_s: float,
    robot: RobotMotion,
    walls: Array,
    two: float,
) -> None:
    """Let the people of a world walk on, come and go.

    Args:
        first: number of the first of them.
        end: and after the last.
        walks: (Q,) records WALK of all people, changed in place.
        scripts: of all people.
        time_s: [s] at the start of the step.
        dt_s: [s] length of the step.
        robot: where it is now, and how it moves.
        walls: (K, 4) [m] rectangles min_x, min_y, max_x, max_y, for those who make way.
        two: 2, told so late that squares are made by the library's power, as Python makes them.
    """
    now_s = time_s + dt_s
    count = max(math.ceil(dt_s / LONGEST_STEP_S - 1e-9), 1)
    people, row = motion_of(first, end, walks), -1
    for q in range(first, end):
        walk = walks[q]
        was_present = walk.is_present
        row += was_present
        walk.has_moved = False
        walk.is_present = walk.enter_s <= now_s + 1e-9 and not now_s > walk.leave_s - 1e-9
        if not walk.is_present:
            continue
        if was_present:
            walk.has_moved = True
            for _ in range(count):
                if walk.piece >= 0 and walk.yields:
                    make_way(walk, scripts, q, dt_s / count, Obstacles(people, row, robot, walls), two)
                elif walk.piece >= 0:
                    _follow(walk, scripts, q, dt_s / count, robot, two)
                else:
                    _pause(walk, scripts, q, dt_s / count, robot)
        else:
            waypoint = scripts.waypoints[scripts.first_waypoint[q]]
            if waypoint.has_pause and waypoint.faces != NOTHING:
                walk.heading = _faced(walk, waypoint, robot)


@njit(cache=True)
def _pause(walk: Record, scripts: Scripts, q: int, dt_s: float, robot: RobotMotion) -> None:
    """See `Walker._pause`."""
    walk.velocity[0] = walk.velocity[1] = walk.speed = 0.0
    walk.pause_left -= dt_s
    waypoint = scripts.waypoints[scripts.first_waypoint[q] + walk.reached]
    if walk.pause_left > 1e-9:
        turn_to(walk, dt_s, walk.heading if waypoint.faces == NOTHING else _faced(walk, waypoint, robot))
        return
    if walk.posture != STANDING:
        walk.posture = STANDING
        walk.on_feet_in = RISE_S
    walk.on_feet_in -= dt_s
    following = scripts.waypoints[scripts.first_waypoint[q] + walk.reached + 1]
    bearing = _bearing(walk, following.at[0], following.at[1])
    turn_to(walk, dt_s, bearing)
    if walk.on_feet_in <= 0.0 and abs(remainder(bearing - walk.heading)) < START_WITHIN_RAD:
        walk.piece, walk.end_piece = waypoint.first_piece, waypoint.end_piece
        walk.along = walk.pause_left = 0.0


@njit(cache=True)
def _follow(walk: Record, scripts: Scripts, q: int, dt_s: float, robot: RobotMotion, two: float) -> None:
    """See `Walker._follow`."""
    pieces, first = scripts.pieces, scripts.first_piece[q]
    piece = pieces[first + walk.piece]
    ahead = piece.heading + piece.curvature * walk.along
    limit = min(_speed_limit(walk, scripts, q, dt_s, two), _limit_by_robot(walk, robot, ahead, two))
    rise = ACCELERATION_M_S2 * dt_s
    walk.speed = max(min(limit, walk.speed + rise), walk.speed - 2.0 * BRAKE_M_S2 * dt_s, 0.0)
    walk.along += walk.speed * dt_s
    while walk.along >= pieces[first + walk.piece].length - 1e-4:
        walk.along -= pieces[first + walk.piece].length
        if walk.piece + 1 == walk.end_piece:
            goal = pieces[first + walk.piece].goal
            end = scripts.waypoints[scripts.first_waypoint[q] + goal]
            walk.position[0], walk.position[1] = end.at[0], end.at[1]
            arrive(walk, scripts, q, goal)
            return
        walk.piece += 1
        walk.reached = pieces[first + walk.piece].goal - 1
    direction = _put(walk, pieces[first + walk.piece])
    walk.velocity[0] = walk.speed * math.cos(direction)
    walk.velocity[1] = walk.speed * math.sin(direction)
    turn_to(walk, dt_s, direction)


@njit(cache=True)
def _put(walk: Record, piece: Record) -> float:
    """Put somebody where they have got to on a piece, and tell its direction there; see `PathPiece.at`."""
    heading: float = piece.heading + piece.curvature * walk.along
    if piece.curvature == 0.0:
        walk.position[0] = piece.start[0] + walk.along * math.cos(heading)
        walk.position[1] = piece.start[1] + walk.along * math.sin(heading)
    else:
        chord_x = math.sin(heading) - math.sin(piece.heading)
        chord_y = math.cos(piece.heading) - math.cos(heading)
        walk.position[0] = piece.start[0] + chord_x / piece.curvature
        walk.position[1] = piece.start[1] + chord_y / piece.curvature
    return heading


@njit(cache=True)
def _speed_limit(walk: Record, scripts: Scripts, q: int, dt_s: float, two: float) -> float:
    """See `Walker._speed_limit`."""
    first = scripts.first_piece[q]
    piece = scripts.pieces[first + walk.piece]
    limit: float = piece.speed
    ahead = piece.length - walk.along
    for k in range(first + walk.piece + 1, first + walk.end_piece):
        piece = scripts.pieces[k]
        limit = min(limit, braking_speed(ahead, piece.speed_squared, dt_s, two))
        ahead += piece.length
    return min(limit, braking_speed(ahead, 0.0, dt_s, two))


@njit(cache=True)
def _limit_by_robot(walk: Record, robot: RobotMotion, direction: float, two: float) -> float:
    """See `Walker._limit_by_robot`."""
    x, y = robot[0] - walk.position[0], robot[1] - walk.position[1]
    ahead = x * math.cos(direction) + y * math.sin(direction)
    aside = abs(y * math.cos(direction) - x * math.sin(direction))
    reach = walk.radius_m + robot[4]
    if ahead < 0.0 or aside > reach:
        return math.inf
    clear = ahead - math.sqrt(max(reach**two - aside**two, 0.0)) - KEEP_CLEAR_M
    return math.sqrt(2.0 * BRAKE_M_S2 * max(clear, 0.0))


@njit(cache=True)
def _faced(walk: Record, waypoint: Record, robot: RobotMotion) -> float:
    """Direction [rad] of what a waypoint says is to be faced."""
    if waypoint.faces == POINT:
        return _bearing(walk, waypoint.face[0], waypoint.face[1])
    return _bearing(walk, robot[0], robot[1])


@njit(cache=True)
def _bearing(walk: Record, x: float, y: float) -> float:
    """See `Walker._bearing`."""
    dx, dy = x - walk.position[0], y - walk.position[1]
    heading: float = walk.heading
    return heading if math.hypot(dx, dy) < 1e-6 else math.atan2(dy, dx)
