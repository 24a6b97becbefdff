"""One control step of people: following scripts and wishes, giving way, waiting (numba kernels).

Records WALK of all people are changed in place; the scripts are read-only.
"""

import math
from typing import Any, Final

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.vectors import fma, remainder
from peopleboy.sim.people.body.postures import DOWN, Posture, change_times_s
from peopleboy.sim.people.motion.stance import POSTURES
from peopleboy.sim.people.walking.script import (
    ABSENT,
    NOTHING,
    POINT,
    ROBOT,
    TURN_RATE_RAD_S,
    Records,
    Scripts,
)
from peopleboy.sim.people.walking.social_force import (
    HURRY,
    NO_ROBOT,
    POINT_RADIUS_M,
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

Array = NDArray[np.float64]
Record = Any  # a row of records

ACCELERATION_M_S2: Final = 1.0
LONGEST_STEP_S: Final = 1.0 / 60.0  # longer control steps are divided
_BRAKE_M_S2: Final = 2.0
_KEEP_CLEAR_M: Final = 0.25  # distance from the robot at which a person that waits for it stops
_STEER_GAIN: Final = 8.0  # [1/s]
_START_WITHIN_RAD: Final = math.radians(25.0)
_ERRAND_M_S: Final = 1.2  # walking speed off the script
_NEARLY_M: Final = 0.1  # distance to the goal of an errand at which a person has arrived
_SIDESTEP_M: Final = 0.8  # last part of an errand, on which a person keeps facing its target
_STANDING = POSTURES[Posture.STANDING]
_KEEPS_HEADING = np.array([posture in DOWN for posture in Posture])
_CALLING = POSTURES[Posture.CALLING]
_RISE_S = np.array([change_times_s(posture)[1] for posture in Posture])


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
    """Advance the people of a world who only follow their scripts: they walk, enter and leave.

    Args:
        first: number of the first person.
        end: number after the last person.
        walks: (Q,) records of all people.
        scripts: scripts of all people.
        time_s: [s] at the start of the step.
        dt_s: [s] length of the step.
        robot: its current position and motion.
        walls: (K, 4) [m] rectangles min_x, min_y, max_x, max_y, for people who give way.
        two: 2, an argument so that squares use the library's power function, as in Python.
    """
    people, row = _motion_of(first, end, walks), -1
    for q in range(first, end):
        was_present = walks[q].is_present
        row += was_present
        if come_or_go(walks, q, time_s + dt_s):
            walk_person(walks, q, scripts, dt_s, steps_in(dt_s), Obstacles(people, row, robot, walls), two)
        elif walks[q].is_present:
            enter(walks, q, scripts, robot)


@njit(cache=True)
def _motion_of(first: int, end: int, walks: Records) -> Array:
    """Return (N, 4) positions x, y [m] and velocities [m/s] of the people who are present."""
    count, motion = 0, np.empty((end - first, 4))
    for q in range(first, end):
        walk = walks[q]
        if walk.is_present:
            motion[count, 0], motion[count, 1] = walk.position[0], walk.position[1]
            motion[count, 2], motion[count, 3] = walk.velocity[0], walk.velocity[1]
            count += 1
    return motion[:count]


@njit(cache=True)
def steps_in(dt_s: float) -> int:
    """Return the number of equal steps, none longer than `LONGEST_STEP_S`, in a control step."""
    return max(math.ceil(dt_s / LONGEST_STEP_S - 1e-9), 1)


@njit(cache=True, nogil=True)
def come_or_go(walks: Records, q: int, now_s: float) -> bool:
    """Add a person to the world or remove it at a time [s]; return whether it walks until then."""
    walk = walks[q]
    was_present = walk.is_present
    walk.now_s = now_s
    walk.is_present = walk.enter_s <= now_s + 1e-9 and not now_s > walk.leave_s - 1e-9
    walk.has_moved = was_present and walk.is_present
    return bool(walk.has_moved)


@njit(cache=True, nogil=True)
def enter(walks: Records, q: int, scripts: Scripts, robot: RobotMotion) -> None:
    """Turn a person who has just entered to the target of its first waypoint, if that is present."""
    walk, waypoint = walks[q], scripts.waypoints[scripts.first_waypoint[q]]
    if waypoint.has_pause and waypoint.faces != NOTHING:
        walk.heading = _faced(walk, waypoint.faces, waypoint, robot)


@njit(cache=True, nogil=True)
def walk_person(
    walks: Records, q: int, scripts: Scripts, dt_s: float, steps: int, obstacles: Obstacles, two: float
) -> int:
    """Advance one person by its script, as modified by its wish.

    Args:
        walks: see `walk_on`.
        q: index of the person.
        scripts: see `walk_on`.
        dt_s: [s] length of the control step.
        steps: number of its steps to do.
        obstacles: obstacles at the start of the control step.
        two: see `walk_on`.

    Returns:
        -1 normally. If the person sets off from a point near its waypoint, the number of steps left: its path
        must be planned before they are done.
    """
    walk, dt_s = walks[q], dt_s / steps_in(dt_s)
    for k in range(steps):
        if walk.is_sent:
            _stray(walk, scripts, q, dt_s, obstacles, two)
        elif walk.stands:
            _halt(walk, scripts, q, dt_s, obstacles.robot, two)
        elif walk.is_astray and walk.piece < 0:
            _turn_back(walk, scripts, q)
        elif walk.piece >= 0 and walk.is_turned_away:
            _turn_to_the_way(walk, scripts, q, dt_s)
        elif walk.piece >= 0 and (walk.yields or walk.is_astray or walk.clear_m >= 0.0):
            _give_way(walk, scripts, q, dt_s, obstacles, two)
        elif walk.piece >= 0:
            _follow(walk, scripts, q, dt_s, obstacles.robot, walk.pace, two)
        elif _pause(walk, scripts, q, dt_s, obstacles.robot):
            return steps - k - 1
    return -1


@njit(cache=True)
def _pause(walk: Record, scripts: Scripts, q: int, dt_s: float, robot: RobotMotion) -> bool:
    """Stand, face the target, and set off when the pause is over; return the result of `_set_off`."""
    walk.velocity[0] = walk.velocity[1] = walk.speed = 0.0
    walk.pause_left -= dt_s
    waypoint = scripts.waypoints[scripts.first_waypoint[q] + walk.reached]
    waits = waypoint.until_robot_within_m >= 0.0
    is_awaiting = waits and _awaits(walk, waypoint, robot)
    if walk.pause_left > 1e-9 or is_awaiting:
        if walk.pause_left <= 1e-9 or walk.pause_left == math.inf:
            walk.wait_left -= dt_s
        if waits and not is_awaiting and walk.posture == _CALLING:  # the robot has come
            walk.posture = _STANDING
        faces = waypoint.faces
        if is_awaiting and faces == NOTHING:
            faces = ROBOT
        _turn(walk, dt_s, walk.heading if faces == NOTHING else _faced(walk, faces, waypoint, robot))
        return False
    if walk.posture != _STANDING:
        walk.on_feet_in = _RISE_S[walk.posture]
        walk.posture = _STANDING
    walk.on_feet_in -= dt_s
    following = scripts.waypoints[scripts.first_waypoint[q] + walk.reached + 1]
    bearing = _bearing(walk, following.at[0], following.at[1])
    _turn(walk, dt_s, bearing)
    if walk.on_feet_in <= 0.0 and abs(remainder(bearing - walk.heading)) < _START_WITHIN_RAD:
        return _set_off(walk, scripts, q)
    return False


@njit(cache=True)
def _awaits(walk: Record, waypoint: Record, robot: RobotMotion) -> bool:
    """Whether a person in a pause waits for a robot that is not near enough yet."""
    if robot[4] < 0.0 or walk.wait_left <= 0.0:
        return False
    return bool(_gap(walk, robot[0], robot[1]) > waypoint.until_robot_within_m)


@njit(cache=True)
def _set_off(walk: Record, scripts: Scripts, q: int) -> bool:
    """Start on the path to the next stop; return whether it must be planned first.

    People who give way need only the waypoints; others follow lines, which begin at the waypoint.
    """
    waypoint = scripts.waypoints[scripts.first_waypoint[q] + walk.reached]
    walk.piece, walk.end_piece = waypoint.first_piece, waypoint.end_piece
    walk.along = walk.pause_left = 0.0
    is_beside = walk.position[0] != waypoint.at[0] or walk.position[1] != waypoint.at[1]
    return bool(is_beside and not (walk.yields or walk.is_astray))


@njit(cache=True)
def _halt(walk: Record, scripts: Scripts, q: int, dt_s: float, robot: RobotMotion, two: float) -> None:
    """Stop, and turn to the target."""
    if walk.speed > 0.0 and walk.piece >= 0 and not walk.is_astray and not walk.yields:
        _follow(walk, scripts, q, dt_s, robot, 0.0, two)
        return
    walk.speed = max(walk.speed - 2.0 * _BRAKE_M_S2 * dt_s, 0.0)
    length = _hypot(walk.velocity[0], walk.velocity[1])
    if length > walk.speed:
        walk.velocity[0] *= walk.speed / length
        walk.velocity[1] *= walk.speed / length
    walk.position[0] += walk.velocity[0] * dt_s
    walk.position[1] += walk.velocity[1] * dt_s
    if walk.speed == 0.0 and not _KEEPS_HEADING[walk.posture]:
        wanted = walk.heading
        if walk.has_face:
            wanted = _bearing(walk, walk.faces[0], walk.faces[1])
        _turn(walk, dt_s, wanted)
        walk.is_turned_away = walk.has_face


@njit(cache=True)
def _turn_to_the_way(walk: Record, scripts: Scripts, q: int, dt_s: float) -> None:
    """Turn back to the direction of the path after a stop."""
    goal = scripts.waypoints[scripts.first_waypoint[q] + _goal_of(walk, scripts, q)]
    bearing = _bearing(walk, goal.at[0], goal.at[1])
    _turn(walk, dt_s, bearing)
    walk.is_turned_away = abs(remainder(bearing - walk.heading)) > _START_WITHIN_RAD


@njit(cache=True)
def _stray(walk: Record, scripts: Scripts, q: int, dt_s: float, obstacles: Obstacles, two: float) -> None:
    """Leave the path of the script for a point on the floor."""
    if walk.posture != _STANDING:
        walk.on_feet_in = _RISE_S[walk.posture]
        walk.posture = _STANDING
    walk.is_astray, walk.is_turned_away, walk.is_homing, walk.piece = True, False, False, -1
    walk.on_feet_in -= dt_s
    distance = _gap(walk, walk.goes_to[0], walk.goes_to[1])
    if walk.on_feet_in > 0.0 or distance < _NEARLY_M:
        _halt(walk, scripts, q, dt_s, obstacles.robot, two)
        return
    wanted = min(_ERRAND_M_S, _braking_speed(distance, 0.0, dt_s, two))
    goal = (walk.goes_to[0], walk.goes_to[1])
    _walk_by_force(walk, dt_s, goal, wanted, HURRY * _ERRAND_M_S, obstacles, two)
    if walk.has_face and distance < _SIDESTEP_M:
        _turn(walk, dt_s, _bearing(walk, walk.faces[0], walk.faces[1]))


@njit(cache=True)
def _turn_back(walk: Record, scripts: Scripts, q: int) -> None:
    """Start to return to the script: to the waypoint to stay at, or to the next one."""
    if walk.pause_left <= 0.0:
        _set_off(walk, scripts, q)
        return
    home = scripts.waypoints[scripts.first_waypoint[q] + walk.reached]
    if _gap(walk, home.at[0], home.at[1]) < _NEARLY_M:
        walk.is_astray = False
    else:
        walk.is_homing, walk.piece, walk.along = True, 0, 0.0


@njit(cache=True)
def _goal_of(walk: Record, scripts: Scripts, q: int) -> int:
    """Return the number of the waypoint that a person walks to."""
    return int(walk.reached if walk.is_homing else scripts.pieces[scripts.first_piece[q] + walk.piece].goal)


@njit(cache=True)
def _follow(
    walk: Record, scripts: Scripts, q: int, dt_s: float, robot: RobotMotion, pace: float, two: float
) -> None:
    """Move exactly along the planned path, at a share of the planned speed."""
    pieces, first = scripts.pieces, scripts.first_piece[q]
    piece = pieces[first + walk.piece]
    ahead = piece.heading + piece.curvature * walk.along
    limit = pace * min(_speed_limit(walk, scripts, q, dt_s, two), _limit_by_robot(walk, robot, ahead, two))
    rise = ACCELERATION_M_S2 * dt_s
    walk.speed = max(min(limit, walk.speed + rise), walk.speed - 2.0 * _BRAKE_M_S2 * dt_s, 0.0)
    walk.along += walk.speed * dt_s
    while walk.along >= pieces[first + walk.piece].length - 1e-4:
        walk.along -= pieces[first + walk.piece].length
        if walk.piece + 1 == walk.end_piece:
            goal = pieces[first + walk.piece].goal
            end = scripts.waypoints[scripts.first_waypoint[q] + goal]
            walk.position[0], walk.position[1] = end.at[0], end.at[1]
            _arrive(walk, scripts, q, goal)
            return
        walk.piece += 1
        walk.reached = pieces[first + walk.piece].goal - 1
    direction = _put(walk, pieces[first + walk.piece])
    walk.velocity[0] = walk.speed * math.cos(direction)
    walk.velocity[1] = walk.speed * math.sin(direction)
    _turn(walk, dt_s, direction)


@njit(cache=True)
def _put(walk: Record, piece: Record) -> float:
    """Place a person at its progress on a piece, and return the direction there."""
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
    """Return the speed [m/s] that allows gentle braking for every slower piece ahead and for the stop."""
    first = scripts.first_piece[q]
    piece = scripts.pieces[first + walk.piece]
    limit: float = piece.speed
    ahead = piece.length - walk.along
    for k in range(first + walk.piece + 1, first + walk.end_piece):
        piece = scripts.pieces[k]
        limit = min(limit, _braking_speed(ahead, piece.speed_squared, dt_s, two))
        ahead += piece.length
    return min(limit, _braking_speed(ahead, 0.0, dt_s, two))


@njit(cache=True)
def _braking_speed(distance: float, final_squared: float, dt_s: float, two: float) -> float:
    """Return the highest speed [m/s] from which the final one can be reached within a distance [m]."""
    lost = ACCELERATION_M_S2 * dt_s / 2.0
    return math.sqrt(lost**two + 2.0 * ACCELERATION_M_S2 * max(distance, 0.0) + final_squared) - lost


@njit(cache=True)
def _limit_by_robot(walk: Record, robot: RobotMotion, direction: float, two: float) -> float:
    """Return the speed [m/s] in a direction [rad] at which a person does not walk into the robot."""
    if robot[4] < 0.0:
        return math.inf
    x, y = robot[0] - walk.position[0], robot[1] - walk.position[1]
    ahead = x * math.cos(direction) + y * math.sin(direction)
    aside = abs(y * math.cos(direction) - x * math.sin(direction))
    reach = walk.radius_m + robot[4]
    if ahead < 0.0 or aside > reach:
        return math.inf
    clear = ahead - math.sqrt(max(reach**two - aside**two, 0.0)) - _KEEP_CLEAR_M
    return math.sqrt(2.0 * _BRAKE_M_S2 * max(clear, 0.0))


@njit(cache=True)
def _give_way(walk: Record, scripts: Scripts, q: int, dt_s: float, obstacles: Obstacles, two: float) -> None:
    """Move by social force towards the next waypoint."""
    walk.is_astray = walk.is_astray or not walk.yields
    goal = _goal_of(walk, scripts, q)
    waypoint = scripts.waypoints[scripts.first_waypoint[q] + goal]
    target = (waypoint.at[0], waypoint.at[1])
    wanted, limit = waypoint.speed, HURRY * waypoint.speed
    is_last = walk.is_homing or goal == scripts.pieces[scripts.first_piece[q] + walk.end_piece - 1].goal
    if is_last:
        braking = _braking_speed(_gap(walk, target[0], target[1]), 0.0, dt_s, two)
        wanted, limit = min(wanted, braking), min(limit, braking)
    wanted = walk.pace * wanted
    seen = _walk_by_force(walk, dt_s, target, wanted, limit, obstacles, two)
    walk.blocked_s = blocked_s(walk.blocked_s, walk.speed, wanted, dt_s)
    distance = _gap(walk, target[0], target[1])
    if distance < TAKEN_WITHIN_M:
        is_occupied = is_taken(target, seen)
        if is_last:
            if has_arrived(distance, walk.blocked_s, walk.speed, is_occupied):
                _arrive(walk, scripts, q, goal)
        elif has_passed(distance, is_occupied):
            walk.reached = goal
            while scripts.pieces[scripts.first_piece[q] + walk.piece].goal <= goal:
                walk.piece += 1


@njit(cache=True)
def _walk_by_force(
    walk: Record,
    dt_s: float,
    goal: tuple[float, float],
    wanted: float,
    limit: float,
    obstacles: Obstacles,
    two: float,
) -> Obstacles:
    """Move by social force towards a goal [m], at the desired speed, up to a limit [m/s].

    Returns:
        The obstacles, with the robot enlarged or left out as the wish says.
    """
    robot = obstacles.robot
    if not walk.heeds_robot:
        robot = NO_ROBOT
    elif robot[4] >= 0.0 and walk.clear_m >= 0.0:
        robot = (robot[0], robot[1], robot[2], robot[3], max(robot[4], walk.clear_m - POINT_RADIUS_M))
    seen = Obstacles(obstacles.people, obstacles.walker, robot, obstacles.walls)
    x, y = velocity_by_force(
        (walk.position[0], walk.position[1]), (walk.velocity[0], walk.velocity[1]), goal, wanted, seen,
        bend_rad(walk.blocked_s), dt_s,
    )  # fmt: skip
    if not walk.heeds_robot:
        limit = min(limit, _limit_by_robot(walk, obstacles.robot, math.atan2(y, x), two))
    fast = math.sqrt(x * x + y * y)
    share = 1.0 if fast <= limit else limit / fast
    walk.speed = min(fast, limit)
    walk.velocity[0], walk.velocity[1] = x * share, y * share
    walk.position[0] += walk.velocity[0] * dt_s
    walk.position[1] += walk.velocity[1] * dt_s
    if walk.speed > TURNS_M_S:
        _turn(walk, dt_s, math.atan2(y, x))
    return seen


@njit(cache=True)
def _arrive(walk: Record, scripts: Scripts, q: int, goal: int) -> None:
    """Stop at the end of the planned path."""
    waypoint = scripts.waypoints[scripts.first_waypoint[q] + goal]
    walk.velocity[0] = walk.velocity[1] = walk.speed = 0.0
    if goal > walk.reached:  # otherwise it has returned to where it should stay
        walk.pause_left, walk.wait_left = waypoint.pause_s, waypoint.waits_at_most_s
    walk.reached, walk.piece, walk.is_astray, walk.is_homing = goal, -1, False, False
    if waypoint.has_pause:
        walk.posture = waypoint.posture


@njit(cache=True)
def _turn(walk: Record, dt_s: float, wanted: float) -> None:
    """Turn towards a direction [rad], fast at first and gently at the end."""
    turn = remainder(wanted - walk.heading) * min(_STEER_GAIN * dt_s, 1.0)
    turn = min(max(turn, -TURN_RATE_RAD_S * dt_s), TURN_RATE_RAD_S * dt_s)
    walk.turn_rate = turn / dt_s
    walk.heading = remainder(walk.heading + turn)


@njit(cache=True)
def _faced(walk: Record, faces: int, waypoint: Record, robot: RobotMotion) -> float:
    """Return the direction [rad] of the target to face; the current heading if it is absent."""
    if faces == POINT:
        return _bearing(walk, waypoint.face[0], waypoint.face[1])
    if faces == ABSENT or robot[4] < 0.0:
        return float(walk.heading)
    return _bearing(walk, robot[0], robot[1])


@njit(cache=True)
def _bearing(walk: Record, x: float, y: float) -> float:
    """Return the direction [rad] to a point [m]; the current heading if it is here."""
    dx, dy = x - walk.position[0], y - walk.position[1]
    heading: float = walk.heading
    return heading if math.hypot(dx, dy) < 1e-6 else math.atan2(dy, dx)


@njit(cache=True)
def _gap(walk: Record, x: float, y: float) -> float:
    """Return the distance [m] to a point [m]."""
    dx, dy = x - walk.position[0], y - walk.position[1]
    return math.sqrt(dx * dx + dy * dy)


@njit(cache=True)
def _hypot(x: float, y: float) -> float:
    """Return the length of a vector, correctly rounded as by `math.hypot`; numba's is not."""
    low, high = min(abs(x), abs(y)), max(abs(x), abs(y))
    squared = high * high + low * low
    if squared == 0.0:
        return 0.0
    lost = fma(high, high, -(high * high)) + fma(low, low, -(low * low))
    lost += (high * high - squared) + low * low
    length = math.sqrt(squared)
    return length + (fma(-length, length, squared) + lost) / (2.0 * length)
