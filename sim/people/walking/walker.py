"""Following a script over the floor: waypoints, pauses, turning to face, giving way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.postures import RISE_S, Posture
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.people.walking.path import PathPiece, Point, is_about_turn, route, turn_between
from peopleboy.sim.people.walking.social_force import (
    HURRY,
    NO_ROBOT,
    POINT_RADIUS_M,
    TAKEN_WITHIN_M,
    TURNS_M_S,
    Obstacles,
    PlanarState,
    RobotMotion,
    bend_rad,
    blocked_s,
    has_arrived,
    has_passed,
    is_taken,
    velocity_by_force,
)
from peopleboy.sim.people.walking.surroundings import ALONE, AS_PLANNED, Surroundings, Wish

Array = NDArray[np.float64]

ACCELERATION_M_S2 = 1.0
TURN_RATE_RAD_S = math.radians(150.0)
LONGEST_STEP_S = 1.0 / 60.0
BRAKE_M_S2 = 2.0
KEEP_CLEAR_M = 0.25  # of the robot, where a person that waits for it comes to stand
STEER_GAIN = 8.0  # [1/s]
START_WITHIN_RAD = math.radians(25.0)
_ERRAND_M_S = 1.2  # how fast one goes where no script sends one
_NEARLY_M = 0.1  # how near to the goal of an errand one has arrived
_SIDESTEP_M = 0.8  # the last of an errand, on which one does not turn away from what one faces


class Walker:
    """A person as a point with a direction, on its way through a script.

    Attributes:
        position: (2,) [m].
        heading: [rad].
        velocity: (2,) [m/s].
        turn_rate: [rad/s].
        reached: index of the last waypoint reached.
        posture: the one to take up now.
    """

    def __init__(self, path: Sequence[Waypoint], yields: bool, radius_m: float) -> None:
        self._path = tuple(path)
        self._yields = yields
        self._radius_m = radius_m
        self.position = np.array(path[0].at_m, dtype=float)
        self.velocity = np.zeros(2)
        self.turn_rate = 0.0
        self.reached = 0
        self.posture = Posture(path[0].posture) if self.has_pause(0) else Posture.STANDING
        self.heading = self._first_heading()
        self._pause_left = self.pause_of(0)
        self._speed = 0.0
        self._pieces: tuple[PathPiece, ...] = ()
        self._along = 0.0
        self._on_feet_in = 0.0
        self._blocked_s = 0.0
        self._wait_left = self._path[0].waits_at_most_s
        self._is_astray = False
        self._is_turned_away = False

    @property
    def is_walking(self) -> bool:
        """Whether it is on its way to a waypoint."""
        return bool(self._pieces)

    @property
    def home(self) -> Array | None:
        """(2,) [m] the waypoint at which it is to be now; None on the way to the next one."""
        return np.array(self._path[self.reached].at_m, dtype=float) if self._pause_left > 0.0 else None

    @property
    def progress(self) -> float:
        """Waypoints reached, from 0 on, and the share of the way from the last one to the next."""
        if self.reached == len(self._path) - 1:
            return float(self.reached)
        start, end = (np.array(self._path[i].at_m) for i in (self.reached, self.reached + 1))
        left = math.dist(self.position, end) / math.dist(start, end)
        return self.reached + min(max(1.0 - left, 0.0), 1.0)

    def is_awaiting(self, robot: PlanarState | None) -> bool:
        """Whether it waits for the robot, as its script says."""
        within_m = self._path[self.reached].until_robot_within_m
        if within_m is None or robot is None or self._pieces or self._wait_left <= 0.0:
            return False
        return math.dist(self.position, robot.position) > within_m

    def enter(self, around: Surroundings) -> None:
        """Face at once what the first waypoint says, if it is there."""
        face = self._path[0].face
        target = around.find(face) if face is not None and self.has_pause(0) else None
        if target is not None:
            self.heading = self._bearing(target)

    def step(self, dt_s: float, around: Surroundings, wish: Wish = AS_PLANNED) -> None:
        """Move on by a time step, by the script as far as a wish leaves it; long steps are divided."""
        count = max(math.ceil(dt_s / LONGEST_STEP_S - 1e-9), 1)
        for _ in range(count):
            self._step(dt_s / count, around, wish)

    def _step(self, dt_s: float, around: Surroundings, wish: Wish) -> None:
        if wish.goes_to is not None:
            self._stray(dt_s, wish.goes_to, around, wish)
        elif wish.stands:
            self._halt(dt_s, around, wish)
        elif self._is_astray and not self._pieces:
            self._turn_back()
        elif self._pieces and self._is_turned_away:
            self._turn_to_the_way(dt_s)
        elif self._pieces and (self._yields or self._is_astray or wish.clear_m is not None):
            self._give_way(dt_s, around, wish)
        elif self._pieces:
            self._follow(dt_s, around, wish.pace)
        else:
            self._pause(dt_s, around)

    def _first_heading(self) -> float:
        """Towards what the first waypoint faces, else towards the second."""
        first = self._path[0]
        if self.has_pause(0) and isinstance(first.face, tuple):
            target = first.face
        elif len(self._path) > 1:
            target = self._path[1].at_m
        else:
            return 0.0
        return math.atan2(target[1] - first.at_m[1], target[0] - first.at_m[0])

    def has_pause(self, index: int) -> bool:
        """Whether one stays at a waypoint."""
        waypoint = self._path[index]
        is_kept = waypoint.pause_s > 0.0 or waypoint.until_robot_within_m is not None
        return index == len(self._path) - 1 or is_kept

    def pause_of(self, index: int) -> float:
        """How long to stay at a waypoint [s]; at the last one for ever."""
        return math.inf if index == len(self._path) - 1 else self._path[index].pause_s

    def _pause(self, dt_s: float, around: Surroundings) -> None:
        """Stand, turn to what the script says, and set off when the pause is over."""
        self.velocity = np.zeros(2)
        self._speed = 0.0
        self._pause_left -= dt_s
        is_awaiting = self.is_awaiting(around.robot)
        if self._pause_left > 1e-9 or is_awaiting:
            if self._pause_left <= 1e-9 or self.reached == len(self._path) - 1:
                self._wait_left -= dt_s
            self._stop_calling(is_awaiting)
            face = self._path[self.reached].face or ("robot" if is_awaiting else None)
            target = None if face is None else around.find(face)
            self._turn(dt_s, self.heading if target is None else self._bearing(target))
            return
        if self.posture is not Posture.STANDING:
            self.posture = Posture.STANDING
            self._on_feet_in = RISE_S
        self._on_feet_in -= dt_s
        bearing = self._bearing(np.array(self._path[self.reached + 1].at_m))
        self._turn(dt_s, bearing)
        if self._on_feet_in <= 0.0 and abs(turn_between(self.heading, bearing)) < START_WITHIN_RAD:
            self._set_off()

    def _stop_calling(self, is_awaiting: bool) -> None:
        """Lower the arm of one whose call was heard: the robot has come."""
        waits = self._path[self.reached].until_robot_within_m is not None
        if waits and not is_awaiting and self.posture is Posture.CALLING:
            self.posture = Posture.STANDING

    def _halt(self, dt_s: float, around: Surroundings, wish: Wish) -> None:
        """Come to a stand, and turn to what is to be faced."""
        if self._speed > 0.0 and self._pieces and not self._is_astray and not self._yields:
            self._follow(dt_s, around, pace=0.0)
            return
        self._speed = max(self._speed - 2.0 * BRAKE_M_S2 * dt_s, 0.0)
        self.velocity = _shorten(self.velocity, self._speed)
        self.position = self.position + self.velocity * dt_s
        if self._speed == 0.0 and self.posture is not Posture.SITTING:
            self._turn(dt_s, self.heading if wish.faces is None else self._bearing(wish.faces))
            self._is_turned_away = wish.faces is not None

    def _turn_to_the_way(self, dt_s: float) -> None:
        """Turn back to where the way leads, as who has stopped and looked elsewhere."""
        bearing = self._bearing(np.array(self._path[self._pieces[0].goal].at_m))
        self._turn(dt_s, bearing)
        self._is_turned_away = abs(turn_between(self.heading, bearing)) > START_WITHIN_RAD

    def _stray(self, dt_s: float, goal: Array, around: Surroundings, wish: Wish) -> None:
        """Leave the way of the script, on foot, for a point of the floor."""
        if self.posture is not Posture.STANDING:
            self.posture = Posture.STANDING
            self._on_feet_in = RISE_S
        self._is_astray, self._is_turned_away, self._pieces = True, False, ()
        self._on_feet_in -= dt_s
        distance = self._gap(_pair(goal))
        if self._on_feet_in > 0.0 or distance < _NEARLY_M:
            self._halt(dt_s, around, wish)
            return
        wanted = min(_ERRAND_M_S, _braking_speed(distance, 0.0, ACCELERATION_M_S2, dt_s))
        self._be_pushed(dt_s, _pair(goal), wanted, HURRY * _ERRAND_M_S, around, wish)
        if wish.faces is not None and distance < _SIDESTEP_M:
            self._turn(dt_s, self._bearing(wish.faces))

    def _turn_back(self) -> None:
        """Plan the way back to where the script is: to the waypoint to stay at, or to the next one."""
        if self.home is None:
            self._set_off()
            return
        here, home = (float(self.position[0]), float(self.position[1])), self._path[self.reached].at_m
        if math.dist(here, home) < _NEARLY_M:
            self._is_astray = False
        else:
            self._pieces = route([here, home], self.reached)
            self._along = 0.0

    def _set_off(self) -> None:
        """Plan the way to the next waypoint at which to stop."""
        stop = self.reached + 1
        while not self.stops_at(stop):
            stop += 1
        here = (float(self.position[0]), float(self.position[1]))
        self._pieces = route(
            [here, *(w.at_m for w in self._path[self.reached + 1 : stop + 1])], self.reached + 1
        )
        self._along = 0.0
        self._pause_left = 0.0

    def stops_at(self, index: int) -> bool:
        """Whether one comes to a stand at a waypoint."""
        if self.has_pause(index):
            return True
        before, corner, after = (w.at_m for w in self._path[index - 1 : index + 2])
        return is_about_turn(before, corner, after)

    def _arrive(self) -> None:
        """Stop at the end of the planned way."""
        self._speed = 0.0
        self.velocity = np.zeros(2)
        goal = self._pieces[-1].goal
        if goal > self.reached:  # else it has come back to where it was to stay
            self._pause_left, self._wait_left = self.pause_of(goal), self._path[goal].waits_at_most_s
        self.reached = goal
        self._pieces = ()
        self._is_astray = False
        if self.has_pause(self.reached):
            self.posture = Posture(self._path[self.reached].posture)

    def _follow(self, dt_s: float, around: Surroundings, pace: float) -> None:
        """Move along the planned way, exactly, at a share of the planned speed."""
        _, ahead = self._pieces[0].at(self._along)
        limit = pace * min(self._speed_limit(dt_s), self._limit_by_robot(around.robot, ahead))
        rise = ACCELERATION_M_S2 * dt_s
        self._speed = max(min(limit, self._speed + rise), self._speed - 2.0 * BRAKE_M_S2 * dt_s, 0.0)
        self._along += self._speed * dt_s
        while self._along >= self._pieces[0].length_m - 1e-4:
            self._along -= self._pieces[0].length_m
            if len(self._pieces) == 1:
                self.position = np.array(self._path[self._pieces[0].goal].at_m, dtype=float)
                self._arrive()
                return
            self.reached = self._pieces[1].goal - 1
            self._pieces = self._pieces[1:]
        self.position, direction = self._pieces[0].at(self._along)
        self.velocity = self._speed * np.array([math.cos(direction), math.sin(direction)])
        self._turn(dt_s, direction)

    def _speed_limit(self, dt_s: float) -> float:
        """Speed [m/s] from which every slower piece ahead, and the stop, can be reached by gentle braking."""
        limit = self.piece_speed(self._pieces[0])
        ahead = self._pieces[0].length_m - self._along
        for piece in self._pieces[1:]:
            limit = min(limit, _braking_speed(ahead, self.piece_speed(piece), ACCELERATION_M_S2, dt_s))
            ahead += piece.length_m
        return min(limit, _braking_speed(ahead, 0.0, ACCELERATION_M_S2, dt_s))

    def piece_speed(self, piece: PathPiece) -> float:
        """Planned speed [m/s], less where the arc is too tight to turn so fast."""
        speed = self._path[piece.goal].speed_m_s
        return speed if piece.curvature == 0.0 else min(speed, TURN_RATE_RAD_S * 0.8 / abs(piece.curvature))

    def _limit_by_robot(self, robot: PlanarState | None, direction: float) -> float:
        """Speed [m/s] in a direction [rad] at which a person does not walk into a robot that stands there."""
        if robot is None:
            return math.inf
        gap = robot.position - self.position
        ahead = gap[0] * math.cos(direction) + gap[1] * math.sin(direction)
        aside = abs(gap[1] * math.cos(direction) - gap[0] * math.sin(direction))
        reach = self._radius_m + robot.radius_m
        if ahead < 0.0 or aside > reach:
            return math.inf
        clear = ahead - math.sqrt(max(reach**2 - aside**2, 0.0)) - KEEP_CLEAR_M
        return math.sqrt(2.0 * BRAKE_M_S2 * max(clear, 0.0))

    def _give_way(self, dt_s: float, around: Surroundings, wish: Wish) -> None:
        """Move by social force towards the next waypoint."""
        self._is_astray = self._is_astray or not self._yields
        goal = self._pieces[0].goal
        target, speed = self._path[goal].at_m, self._path[goal].speed_m_s
        is_last = goal == self._pieces[-1].goal
        wanted, limit = speed, HURRY * speed
        if is_last:
            braking = _braking_speed(self._gap(target), 0.0, ACCELERATION_M_S2, dt_s)
            wanted, limit = min(wanted, braking), min(limit, braking)
        wanted = wish.pace * wanted
        obstacles = self._be_pushed(dt_s, target, wanted, limit, around, wish)
        self._blocked_s = blocked_s(self._blocked_s, self._speed, wanted, dt_s)
        if self._gap(target) < TAKEN_WITHIN_M:
            self._pass_waypoint(target, is_last, is_taken(target, obstacles))

    def _be_pushed(
        self, dt_s: float, goal: Point, wanted: float, limit: float, around: Surroundings, wish: Wish
    ) -> Obstacles:
        """Move by social force towards a goal [m], as fast as is wanted, up to a limit [m/s].

        Returns:
            What it made way for.
        """
        robot = _as_wished(around.robot, wish)
        obstacles = Obstacles(around.people.motion, around.walker, robot, around.walls)
        bend = bend_rad(self._blocked_s)
        x, y = velocity_by_force(
            _pair(self.position), _pair(self.velocity), goal, wanted, obstacles, bend, dt_s
        )
        if not wish.heeds_robot:
            limit = min(limit, self._limit_by_robot(around.robot, math.atan2(y, x)))
        fast = math.sqrt(x * x + y * y)
        self._speed = min(fast, limit)
        self.velocity = np.array([x, y]) * (1.0 if fast <= limit else limit / fast)
        self.position = self.position + self.velocity * dt_s
        if self._speed > TURNS_M_S:
            self._turn(dt_s, math.atan2(y, x))
        return obstacles

    def _pass_waypoint(self, target: Point, is_last: bool, is_occupied: bool) -> None:
        """Go on to the next waypoint where this one is reached, or where others stand on it."""
        distance = self._gap(target)
        if is_last:
            if has_arrived(distance, self._blocked_s, self._speed, is_occupied):
                self._arrive()
        elif has_passed(distance, is_occupied):
            goal = self._pieces[0].goal
            self.reached = goal
            self._pieces = tuple(piece for piece in self._pieces if piece.goal > goal)

    def _gap(self, target: Point) -> float:
        """Distance [m] of a point."""
        x, y = self.position.tolist()
        x, y = target[0] - x, target[1] - y
        return math.sqrt(x * x + y * y)

    def _bearing(self, target: Array) -> float:
        """Direction [rad] of a point; the present heading if it is here."""
        gap = target - self.position
        return self.heading if float(np.hypot(*gap)) < 1e-6 else math.atan2(gap[1], gap[0])

    def _turn(self, dt_s: float, wanted: float) -> None:
        """Turn towards a direction, fast at first and gently at the end."""
        turn = turn_between(self.heading, wanted) * min(STEER_GAIN * dt_s, 1.0)
        turn = min(max(turn, -TURN_RATE_RAD_S * dt_s), TURN_RATE_RAD_S * dt_s)
        self.turn_rate = turn / dt_s
        self.heading = math.remainder(self.heading + turn, 2.0 * math.pi)


def _as_wished(robot: PlanarState | None, wish: Wish) -> RobotMotion:
    """The robot as one makes way for it: larger for who keeps farther away; none for who does not care."""
    if robot is None or not wish.heeds_robot:
        return NO_ROBOT
    radius_m = robot.radius_m
    if wish.clear_m is not None:
        radius_m = max(radius_m, wish.clear_m - POINT_RADIUS_M)
    return *_pair(robot.position), *_pair(robot.velocity), radius_m


def _braking_speed(distance: float, final: float, brake: float, dt_s: float) -> float:
    """Highest speed [m/s] for this step from which the final one is reached within a distance."""
    lost = brake * dt_s / 2.0
    return math.sqrt(lost**2 + 2.0 * brake * max(distance, 0.0) + final**2) - lost


def _pair(vector: Array) -> tuple[float, float]:
    x, y = vector.tolist()
    return x, y


def _shorten(vector: Array, longest: float) -> Array:
    length = math.hypot(*vector.tolist())
    return vector if length <= longest else vector * (longest / length)


# When a person that nobody disturbs is where.

_STEP_S = 0.05
_LONGEST_S = 3600.0


class Entry(NamedTuple):
    """One line of a timetable: time [s], place [m], and what happens."""

    time_s: float
    x_m: float
    y_m: float
    what: str


def timetable(config: PersonConfig) -> list[Entry]:
    """List when a person enters, passes or reaches its waypoints, sets off again and leaves.

    It is what happens when neither the robot nor other people are in the way.
    """
    walker = Walker(config.path, yields=False, radius_m=0.0)
    time_s = config.enter_s
    entries = [_entry(time_s, walker, "enters")]
    while walker.reached < len(config.path) - 1 and not _has_left(config, time_s):
        was_walking, reached = walker.is_walking, walker.reached
        walker.step(_STEP_S, ALONE)
        time_s += _STEP_S
        if walker.reached > reached:
            is_stop = not walker.is_walking
            entries.append(_entry(time_s, walker, f"{'reaches' if is_stop else 'passes'} {walker.reached}"))
        has_stood = len(entries) > 1 or config.path[0].pause_s > 0.0
        if walker.is_walking and not was_walking and has_stood:
            entries.append(_entry(time_s, walker, f"leaves {walker.reached}"))
        if time_s > _LONGEST_S:
            break
    if config.leave_s is not None:
        entries.append(_entry(config.leave_s, walker, "leaves the world"))
    return entries


def _has_left(config: PersonConfig, time_s: float) -> bool:
    return config.leave_s is not None and time_s >= config.leave_s - 1e-9


def _entry(time_s: float, walker: Walker, what: str) -> Entry:
    return Entry(round(time_s, 3), float(walker.position[0]), float(walker.position[1]), what)
