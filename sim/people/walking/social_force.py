"""The social force model, by which people give way (numba kernels)."""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
RobotMotion: TypeAlias = tuple[float, float, float, float, float]
"""Position [m] and velocity x, y [m/s] of a robot, and its radius [m]; negative without a robot."""

NO_ROBOT: Final[RobotMotion] = (0.0, 0.0, 0.0, 0.0, -1.0)

# Helbing and Molnar, Social force model for pedestrian dynamics, Phys. Rev. E 51, 4282 (1995), section III.
RELAXATION_S = 0.5
PEOPLE_STRENGTH = 2.1  # [m2/s2] V0
PEOPLE_RANGE_M = 0.3  # sigma
WALL_STRENGTH = 10.0  # [m2/s2] U0
WALL_RANGE_M = 0.2  # R
STEP_TIME_S = 1.0  # delta t: time ahead of a foreseen step
HALF_SIGHT_RAD = math.radians(100.0)  # phi
BEHIND = 0.5  # c: weight of people out of sight
# Helbing, Farkas and Vicsek, Simulating dynamical features of escape panic, Nature 407, 487 (2000): the push
# of bodies about to touch; B is theirs, the strength a third of their A / m, for people who are not in panic.
TOUCH_STRENGTH = 8.0  # [m/s2]
TOUCH_RANGE_M = 0.08
# Ours: people who meet head-on pass on the right, so that they do not get stuck; a force bends by this angle.
KEEP_RIGHT_RAD = 0.25
POINT_RADIUS_M = 0.25  # the size of the bodies that the constants were made for


@dataclass(frozen=True, slots=True, eq=False)
class PlanarState:
    """State of a person or an object that moves over the floor.

    Attributes:
        position: (2,) [m] in the world frame.
        velocity: (2,) [m/s].
        radius_m: [m] radius of its circular outline.
        heading_rad: [rad] direction of its front; unused for people.
    """

    position: Array
    velocity: Array
    radius_m: float = 0.25
    heading_rad: float = 0.0


def robot_motion(robot: PlanarState | None) -> RobotMotion:
    """Return the position and motion of a robot in the format of the kernels."""
    if robot is None:
        return NO_ROBOT
    return *robot.position.tolist(), *robot.velocity.tolist(), robot.radius_m


class Obstacles(NamedTuple):
    """Obstacles to a walking person.

    Attributes:
        people: (N, 4) positions x, y [m] and velocities [m/s] of all people.
        walker: row of `people` that is the person's own; -1 for none.
        robot: position and motion of the robot.
        walls: (K, 4) [m] rectangles min_x, min_y, max_x, max_y.
    """

    people: Array
    walker: int
    robot: RobotMotion
    walls: Array


@njit(cache=True, nogil=True)
def social_force(
    at: tuple[float, float],
    velocity: tuple[float, float],
    desired: tuple[float, float],
    obstacles: Obstacles,
    bend_rad: float,
) -> tuple[float, float]:
    """Sum the attraction to the goal and the repulsion by others and walls.

    Source: Helbing and Molnar (1995), eqs. 2 to 10, without attraction and fluctuations.

    Args:
        at: [m].
        velocity: [m/s].
        desired: [m/s] velocity towards the goal.
        obstacles: people, robot and walls around.
        bend_rad: [rad] angle by which a force from ahead is turned to pass right; negative for the left.

    Returns:
        [m/s2] acceleration.
    """
    x, y = (desired[0] - velocity[0]) / RELAXATION_S, (desired[1] - velocity[1]) / RELAXATION_S
    heading = desired if math.hypot(desired[0], desired[1]) > 1e-6 else velocity
    turn = math.cos(bend_rad), math.sin(bend_rad)
    people, walker, robot, walls = obstacles
    for k in range(len(people)):
        if k != walker:
            other = people[k]
            push = _push_of(
                at[0] - other[0], at[1] - other[1], other[2] - velocity[0], other[3] - velocity[1],
                POINT_RADIUS_M, heading, turn,
            )  # fmt: skip
            x, y = x + push[0], y + push[1]
    if robot[4] >= 0.0:
        push = _push_of(
            at[0] - robot[0], at[1] - robot[1], robot[2] - velocity[0], robot[3] - velocity[1],
            robot[4], heading, turn,
        )  # fmt: skip
        x, y = x + push[0], y + push[1]
    if len(walls):
        push = _push_of_wall(at, walls)
        x, y = x + push[0], y + push[1]
    return x, y


@njit(cache=True)
def _push_of(
    gap_x: float,
    gap_y: float,
    step_x: float,
    step_y: float,
    radius_m: float,
    heading: tuple[float, float],
    turn: tuple[float, float],
) -> tuple[float, float]:
    """Return the repulsion [m/s2] by another person or the robot at a gap [m].

    It falls off with ellipses that reach out along the coming step. Our change to eq. 4: the step is that of
    the velocity relative to the walker, half as long (Johansson, Helbing and Shukla 2007), so that a robot
    that stands still is avoided like an approaching person. A force from ahead is turned by an angle, whose
    cosine and sine are given; a force from out of sight has less weight (eqs. 8 and 9).
    """
    sight = _sight_weight(heading, -gap_x, -gap_y)
    distance = max(math.hypot(gap_x, gap_y), 1e-3)
    shrink = max(1.0 - (radius_m - POINT_RADIUS_M) / distance, 0.2)
    gap_x, gap_y, distance = gap_x * shrink, gap_y * shrink, distance * shrink
    touch = TOUCH_STRENGTH * math.exp((2.0 * POINT_RADIUS_M - distance) / TOUCH_RANGE_M)
    step_x, step_y = step_x * STEP_TIME_S, step_y * STEP_TIME_S
    ahead_x, ahead_y = gap_x - step_x, gap_y - step_y
    ahead = max(math.hypot(ahead_x, ahead_y), 1e-3)
    both = distance + ahead
    b = math.sqrt(max(both * both - (step_x * step_x + step_y * step_y), 1e-2)) / 2.0
    push = PEOPLE_STRENGTH / PEOPLE_RANGE_M * math.exp(-b / PEOPLE_RANGE_M) * both / (4.0 * b)
    x = push * (gap_x / distance + ahead_x / ahead) + touch / distance * gap_x
    y = push * (gap_y / distance + ahead_y / ahead) + touch / distance * gap_y
    if x * heading[0] + y * heading[1] < -0.5 * math.hypot(x, y) * math.hypot(heading[0], heading[1]):
        x, y = x * turn[0] - y * turn[1], x * turn[1] + y * turn[0]
    return sight * x, sight * y


@njit(cache=True)
def _sight_weight(heading: tuple[float, float], x: float, y: float) -> float:
    """Return the weight of a direction: 1 in sight, `BEHIND` out of sight (eqs. 8 and 9)."""
    limit = math.hypot(heading[0], heading[1]) * math.hypot(x, y) * math.cos(HALF_SIGHT_RAD)
    return 1.0 if x * heading[0] + y * heading[1] >= limit else BEHIND


@njit(cache=True)
def _push_of_wall(at: tuple[float, float], walls: Array) -> tuple[float, float]:
    """Return the repulsion [m/s2] by the nearest point of the nearest wall (eq. 5)."""
    nearest, gap_x, gap_y = math.inf, 0.0, 0.0
    for wall in walls:
        x = at[0] - min(max(at[0], wall[0]), wall[2])
        y = at[1] - min(max(at[1], wall[1]), wall[3])
        distance = math.hypot(x, y)
        if distance < nearest:
            nearest, gap_x, gap_y = distance, x, y
    if nearest < 2e-3:
        return 0.0, 0.0
    push = WALL_STRENGTH / WALL_RANGE_M * math.exp(-nearest / WALL_RANGE_M) / nearest
    return push * gap_x, push * gap_y


# Consequences of the force: the next velocity, the side on which to pass, and when a waypoint is reached.

HURRY: Final = 1.3  # greatest speed relative to the planned one (Helbing and Molnar 1995, eq. 11)
TAKEN_WITHIN_M: Final = 1.0  # distance to a waypoint from which a person checks whether it is occupied
TAKEN_BY_M: Final = 0.6  # distance to a waypoint within which another person occupies it
_SETTLES_M_S: Final = 0.4  # a person slower than this stops beside an occupied waypoint
_PASSED_M: Final = 0.35  # distance to a waypoint at which a person goes on to the next
_PASSED_TAKEN_M: Final = 0.9  # the same for an occupied waypoint
TURNS_M_S: Final = 0.15  # a slower person keeps its heading
_ARRIVED_M: Final = 0.02  # distance to a stop at which a person has arrived
_STUCK_M: Final = 0.5  # the same for a person who is held up by a wall or by others
_STUCK_S: Final = 1.0
_MOST_M_S2: Final = 4.0
_TRY_SIDE_S: Final = 2.0  # time of trying to pass on one side


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
    """Return the velocity [m/s] of a person after a step towards a goal [m] at a desired speed.

    It changes by at most 4 m/s2; for the rest see `social_force`.
    """
    gap_x, gap_y = goal[0] - at[0], goal[1] - at[1]
    pace = wanted_m_s / max(math.hypot(gap_x, gap_y), 1e-9)
    x, y = social_force(at, velocity, (gap_x * pace, gap_y * pace), obstacles, bend_rad)
    share = dt_s * min(_MOST_M_S2 / max(math.hypot(x, y), 1e-9), 1.0)
    return velocity[0] + share * x, velocity[1] + share * y


@njit(cache=True)
def bend_rad(blocked_s: float) -> float:
    """Return the angle [rad] for giving way: to the right; if that fails, left and right in turn."""
    side = 1.0 if int(blocked_s / _TRY_SIDE_S) % 2 == 0 else -1.0
    return side * KEEP_RIGHT_RAD * (1.0 + min(blocked_s / _TRY_SIDE_S, 4.0))


@njit(cache=True)
def blocked_s(blocked_s: float, speed_m_s: float, wanted_m_s: float, dt_s: float) -> float:
    """Return the updated time [s] for which a person has been slower than half its desired speed."""
    return blocked_s + dt_s if speed_m_s < 0.5 * wanted_m_s else max(blocked_s - dt_s, 0.0)


@njit(cache=True)
def has_arrived(distance_m: float, blocked_s: float, speed_m_s: float, is_occupied: bool) -> bool:
    """Return whether a person at this distance from its stop has arrived."""
    if is_occupied and speed_m_s < _SETTLES_M_S:
        return True
    return distance_m < (_STUCK_M if blocked_s > _STUCK_S else _ARRIVED_M)


@njit(cache=True)
def has_passed(distance_m: float, is_occupied: bool) -> bool:
    """Return whether a person at this distance from a waypoint goes on to the next one."""
    return distance_m < (_PASSED_TAKEN_M if is_occupied else _PASSED_M)


@njit(cache=True)
def is_taken(place: tuple[float, float], obstacles: Obstacles) -> bool:
    """Return whether another person or the robot occupies a place [m]."""
    people, walker, robot, _ = obstacles
    nearest = math.inf
    if robot[4] >= 0.0:
        nearest = math.hypot(robot[0] - place[0], robot[1] - place[1])
    for k in range(len(people)):
        if k != walker:
            nearest = min(nearest, math.hypot(people[k, 0] - place[0], people[k, 1] - place[1]))
    return nearest < TAKEN_BY_M
