"""Following a script over the floor: waypoints, pauses, turning to face, giving way."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.walking.path import PathPiece, is_about_turn, route, turn_between
from peopleboy.sim.people.walking.social_force import KEEP_RIGHT_RAD, PlanarState, social_force

Array = NDArray[np.float64]

ACCELERATION_M_S2 = 1.0
TURN_RATE_RAD_S = math.radians(150.0)
RISE_S = 0.6  # the time that it takes to sit down, to rise, or to change any other posture
_LONGEST_STEP_S = 1.0 / 60.0
_BRAKE_M_S2 = 2.0
_KEEP_CLEAR_M = 0.25  # of the robot, where a person that waits for it comes to stand
_STEER_GAIN = 8.0  # [1/s]
_START_WITHIN_RAD = math.radians(25.0)
_GIVING_WAY_M_S2 = 4.0
_TRY_SIDE_S = 2.0  # how long one tries to pass on one side
_HURRY = 1.3  # who gives way may be this much faster than planned (Helbing and Molnar 1995, eq. 11)


@dataclass(frozen=True, slots=True, kw_only=True)
class Waypoint:
    """A place to go to.

    Attributes:
        at_m: (x, y) [m] in the world frame.
        speed_m_s: [m/s] on the way to it.
        pause_s: [s] waits there.
        face: while pausing, turn to a point, to "robot", or to a person by name; None keeps the direction.
        posture: while pausing.
    """

    at_m: tuple[float, float]
    speed_m_s: float = 1.2
    pause_s: float = 0.0
    face: tuple[float, float] | str | None = None
    posture: Posture = Posture.STANDING


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """What a walker may have to give way to.

    Attributes:
        others: people by name.
        robot: None if there is none.
        walls: (K, 4) [m] rectangles min_x, min_y, max_x, max_y.
    """

    others: Mapping[str, PlanarState]
    robot: PlanarState | None
    walls: Array

    def find(self, face: tuple[float, float] | str) -> Array | None:
        """Position (2,) [m] of what somebody turns to; None if it is not there."""
        if not isinstance(face, str):
            return np.array(face)
        state = self.robot if face == "robot" else self.others.get(face)
        return None if state is None else state.position


ALONE = Surroundings(others={}, robot=None, walls=np.empty((0, 4)))


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
        self.posture = Posture(path[0].posture) if self._has_pause(0) else Posture.STANDING
        self.heading = self._first_heading()
        self._pause_left = self._pause_of(0)
        self._speed = 0.0
        self._pieces: tuple[PathPiece, ...] = ()
        self._along = 0.0
        self._on_feet_in = 0.0
        self._blocked_s = 0.0

    @property
    def is_walking(self) -> bool:
        """Whether it is on its way to a waypoint."""
        return bool(self._pieces)

    def enter(self, around: Surroundings) -> None:
        """Face at once what the first waypoint says, if it is there."""
        face = self._path[0].face
        target = around.find(face) if face is not None and self._has_pause(0) else None
        if target is not None:
            self.heading = self._bearing(target)

    def step(self, dt_s: float, around: Surroundings) -> None:
        """Move on by a time step; long ones are divided."""
        count = max(math.ceil(dt_s / _LONGEST_STEP_S - 1e-9), 1)
        for _ in range(count):
            self._step(dt_s / count, around)

    def _step(self, dt_s: float, around: Surroundings) -> None:
        if self._pieces and self._yields:
            self._give_way(dt_s, around)
        elif self._pieces:
            self._follow(dt_s, around)
        else:
            self._pause(dt_s, around)

    def _first_heading(self) -> float:
        """Towards what the first waypoint faces, else towards the second."""
        first = self._path[0]
        if self._has_pause(0) and isinstance(first.face, tuple):
            target = first.face
        elif len(self._path) > 1:
            target = self._path[1].at_m
        else:
            return 0.0
        return math.atan2(target[1] - first.at_m[1], target[0] - first.at_m[0])

    def _has_pause(self, index: int) -> bool:
        return index == len(self._path) - 1 or self._path[index].pause_s > 0.0

    def _pause_of(self, index: int) -> float:
        """How long to stay at a waypoint [s]; at the last one for ever."""
        return math.inf if index == len(self._path) - 1 else self._path[index].pause_s

    def _pause(self, dt_s: float, around: Surroundings) -> None:
        """Stand, turn to what the script says, and set off when the pause is over."""
        self.velocity = np.zeros(2)
        self._speed = 0.0
        self._pause_left -= dt_s
        if self._pause_left > 1e-9:
            face = self._path[self.reached].face
            target = None if face is None else around.find(face)
            self._turn(dt_s, self.heading if target is None else self._bearing(target))
            return
        if self.posture is not Posture.STANDING:
            self.posture = Posture.STANDING
            self._on_feet_in = RISE_S
        self._on_feet_in -= dt_s
        bearing = self._bearing(np.array(self._path[self.reached + 1].at_m))
        self._turn(dt_s, bearing)
        if self._on_feet_in <= 0.0 and abs(turn_between(self.heading, bearing)) < _START_WITHIN_RAD:
            self._set_off()

    def _set_off(self) -> None:
        """Plan the way to the next waypoint at which to stop."""
        stop = self.reached + 1
        while not self._stops_at(stop):
            stop += 1
        here = (float(self.position[0]), float(self.position[1]))
        self._pieces = route(
            [here, *(w.at_m for w in self._path[self.reached + 1 : stop + 1])], self.reached + 1
        )
        self._along = 0.0
        self._pause_left = 0.0

    def _stops_at(self, index: int) -> bool:
        if self._has_pause(index):
            return True
        before, corner, after = (w.at_m for w in self._path[index - 1 : index + 2])
        return is_about_turn(before, corner, after)

    def _arrive(self) -> None:
        """Stop at the end of the planned way."""
        self._speed = 0.0
        self.velocity = np.zeros(2)
        self.reached = self._pieces[-1].goal
        self._pieces = ()
        self._pause_left = self._pause_of(self.reached)
        if self._has_pause(self.reached):
            self.posture = Posture(self._path[self.reached].posture)

    def _follow(self, dt_s: float, around: Surroundings) -> None:
        """Move along the planned way, exactly."""
        limit = min(self._speed_limit(dt_s), self._limit_by_robot(around.robot))
        rise = ACCELERATION_M_S2 * dt_s
        self._speed = max(min(limit, self._speed + rise), self._speed - 2.0 * _BRAKE_M_S2 * dt_s, 0.0)
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
        limit = self._piece_speed(self._pieces[0])
        ahead = self._pieces[0].length_m - self._along
        for piece in self._pieces[1:]:
            limit = min(limit, _braking_speed(ahead, self._piece_speed(piece), ACCELERATION_M_S2, dt_s))
            ahead += piece.length_m
        return min(limit, _braking_speed(ahead, 0.0, ACCELERATION_M_S2, dt_s))

    def _piece_speed(self, piece: PathPiece) -> float:
        """Planned speed [m/s], less where the arc is too tight to turn so fast."""
        speed = self._path[piece.goal].speed_m_s
        return speed if piece.curvature == 0.0 else min(speed, TURN_RATE_RAD_S * 0.8 / abs(piece.curvature))

    def _limit_by_robot(self, robot: PlanarState | None) -> float:
        """Speed [m/s] at which a person does not walk into a robot that stands in the way."""
        if robot is None:
            return math.inf
        _, direction = self._pieces[0].at(self._along)
        gap = robot.position - self.position
        ahead = gap[0] * math.cos(direction) + gap[1] * math.sin(direction)
        aside = abs(gap[1] * math.cos(direction) - gap[0] * math.sin(direction))
        reach = self._radius_m + robot.radius_m
        if ahead < 0.0 or aside > reach:
            return math.inf
        clear = ahead - math.sqrt(max(reach**2 - aside**2, 0.0)) - _KEEP_CLEAR_M
        return math.sqrt(2.0 * _BRAKE_M_S2 * max(clear, 0.0))

    def _give_way(self, dt_s: float, around: Surroundings) -> None:
        """Move by social force towards the next waypoint."""
        goal = self._pieces[0].goal
        target = np.array(self._path[goal].at_m, dtype=float)
        gap = target - self.position
        distance = float(np.hypot(*gap))
        is_last = goal == self._pieces[-1].goal
        speed = self._path[goal].speed_m_s
        wanted = min(speed, _braking_speed(distance, 0.0, ACCELERATION_M_S2, dt_s)) if is_last else speed
        desired = gap / max(distance, 1e-9) * wanted
        others = [*around.others.values(), *([around.robot] if around.robot is not None else [])]
        force = social_force(self.position, self.velocity, desired, others, around.walls, self._bend())
        self.velocity = _shorten(self.velocity + _shorten(force, _GIVING_WAY_M_S2) * dt_s, _HURRY * speed)
        self.position = self.position + self.velocity * dt_s
        self._speed = float(np.hypot(*self.velocity))
        is_blocked = self._speed < 0.5 * wanted
        self._blocked_s = self._blocked_s + dt_s if is_blocked else max(self._blocked_s - dt_s, 0.0)
        if self._speed > 0.15:
            self._turn(dt_s, math.atan2(self.velocity[1], self.velocity[0]))
        self._pass_waypoint(target, is_last, others)

    def _bend(self) -> float:
        """To which side to give way [rad]: to the right; if that does not help, left and right in turn."""
        side = 1.0 if int(self._blocked_s / _TRY_SIDE_S) % 2 == 0 else -1.0
        return side * KEEP_RIGHT_RAD * (1.0 + min(self._blocked_s / _TRY_SIDE_S, 4.0))

    def _pass_waypoint(self, target: Array, is_last: bool, others: Sequence[PlanarState]) -> None:
        """Go on to the next waypoint where this one is reached, or where others stand on it."""
        distance = float(np.hypot(*(target - self.position)))
        is_taken = any(np.hypot(*(other.position - target)) < 0.6 for other in others)
        if is_last:
            if distance < 0.04 or (is_taken and distance < 1.0 and self._speed < 0.4):
                self._arrive()
        elif distance < (0.9 if is_taken else 0.35):
            goal = self._pieces[0].goal
            self.reached = goal
            self._pieces = tuple(piece for piece in self._pieces if piece.goal > goal)

    def _bearing(self, target: Array) -> float:
        """Direction [rad] of a point; the present heading if it is here."""
        gap = target - self.position
        return self.heading if float(np.hypot(*gap)) < 1e-6 else math.atan2(gap[1], gap[0])

    def _turn(self, dt_s: float, wanted: float) -> None:
        """Turn towards a direction, fast at first and gently at the end."""
        turn = turn_between(self.heading, wanted) * min(_STEER_GAIN * dt_s, 1.0)
        turn = min(max(turn, -TURN_RATE_RAD_S * dt_s), TURN_RATE_RAD_S * dt_s)
        self.turn_rate = turn / dt_s
        self.heading = math.remainder(self.heading + turn, 2.0 * math.pi)


def _braking_speed(distance: float, final: float, brake: float, dt_s: float) -> float:
    """Highest speed [m/s] for this step from which the final one is reached within a distance."""
    lost = brake * dt_s / 2.0
    return math.sqrt(lost**2 + 2.0 * brake * max(distance, 0.0) + final**2) - lost


def _shorten(vector: Array, longest: float) -> Array:
    length = float(np.hypot(*vector))
    return vector if length <= longest else vector * (longest / length)
