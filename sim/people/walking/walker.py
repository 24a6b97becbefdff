"""One person's walk along its script, the wishes that modify it, and its undisturbed timetable."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.motion.stance import POSTURES
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.people.walking.script import (
    Records,
    Scripts,
    face_people,
    plan_leg,
    start_walk,
    write_script,
)
from peopleboy.sim.people.walking.social_force import Obstacles, PlanarState, robot_motion
from peopleboy.sim.people.walking.walk_kernels import come_or_go, enter, steps_in, walk_person

Array = NDArray[np.float64]


class Present(NamedTuple):
    """People who are present.

    Attributes:
        rows: row in `motion` by name.
        motion: (N, 4) positions x, y [m] and velocities [m/s].
    """

    rows: Mapping[str, int]
    motion: Array


NO_WALKERS: Final = Present({}, np.empty((0, 4)))


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """People, robot and walls around a walker.

    Attributes:
        people: the people who are present, including the walker.
        walker: its row among them; -1 if it is absent.
        robot: state of the robot, or None.
        walls: (K, 4) [m] rectangles min_x, min_y, max_x, max_y.
    """

    people: Present
    walker: int
    robot: PlanarState | None
    walls: Array

    def find(self, face: tuple[float, float] | str) -> Array | None:
        """Return the position (2,) [m] of a person's target to face; None if it is absent."""
        if not isinstance(face, str):
            return np.array(face)
        if face == "robot":
            return None if self.robot is None else self.robot.position
        row = self.people.rows.get(face)
        return None if row is None else self.people.motion[row, :2]


ALONE: Final = Surroundings(people=NO_WALKERS, walker=-1, robot=None, walls=np.empty((0, 4)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Wish:
    """Change of a person's script at one step; the defaults change nothing.

    Attributes:
        goes_to: (2,) [m] where it goes instead of along its path, giving way to all; None to follow its path.
        stands: whether it stops where it is; its pauses are suspended meanwhile.
        faces: (2,) [m] point that its body faces when it stands, and over the last steps to `goes_to`.
        looks_at: (2,) [m] point that its head turns to; None for straight ahead.
        pace: share of the planned speed.
        clear_m: [m] distance that its centre keeps from the robot's; None for the default.
        heeds_robot: whether it gives way to the robot, if it gives way at all.
        calls: whether it raises an arm and waves.
    """

    goes_to: Array | None = None
    stands: bool = False
    faces: Array | None = None
    gaze_at: Array | None = None
    pace: float = 1.0
    clear_m: float | None = None
    heeds_robot: bool = True
    calls: bool = False


AS_PLANNED: Final = Wish()


_TWO = 2.0  # see `walk_on`
_POSTURES = tuple(POSTURES)
_STEP_S = 0.05  # time step of timetables
_LONGEST_S = 3600.0


class Walker:
    """A person as an oriented point that follows a script.

    Its state is one record, which may be part of an array for many people.

    Attributes:
        script: the script.
        walks: (1,) records WALK, its state.
    """

    def __init__(
        self,
        path: Sequence[Waypoint],
        yields: bool,
        radius_m: float,
        stay_s: tuple[float, float] = (0.0, math.inf),
    ) -> None:
        self._path = tuple(path)
        self.script = write_script(path)
        nothing_before = np.zeros(1, np.int64)
        self._scripts = Scripts(*self.script, nothing_before, nothing_before)
        self._faces_people = any(isinstance(w.face, str) and w.face != "robot" for w in path)
        walks = start_walk(path, self.script, yields=yields, radius_m=radius_m)
        walks["enter_s"], walks["leave_s"] = stay_s
        walks["is_present"] = stay_s[0] <= 0.0
        self._wish = AS_PLANNED
        self.rebind(walks)

    def rebind(self, walks: Records) -> None:
        """Use another array (1,) for its state from now on; it must hold the same values already."""
        self.walks = walks
        self._walk = walks[0]
        self._position, self._velocity = walks["position"][0], walks["velocity"][0]

    @property
    def position(self) -> Array:
        """(2,) [m], a copy."""
        return np.array(self._position)

    @property
    def velocity(self) -> Array:
        """(2,) [m/s], a copy."""
        return np.array(self._velocity)

    @property
    def heading(self) -> float:
        """[rad]."""
        return float(self._walk["heading"])

    @property
    def turn_rate(self) -> float:
        """[rad/s]."""
        return float(self._walk["turn_rate"])

    @property
    def reached(self) -> int:
        """Index of the last waypoint reached."""
        return int(self._walk["reached"])

    @property
    def posture(self) -> Posture:
        """The posture to take up now."""
        return _POSTURES[int(self._walk["posture"])]

    @property
    def present(self) -> bool:
        """Whether it is in the world now."""
        return bool(self._walk["is_present"])

    @property
    def has_moved(self) -> bool:
        """Whether it has walked in the last step, and was present before and after it."""
        return bool(self._walk["has_moved"])

    @property
    def now_s(self) -> float:
        """[s] time up to which it has walked."""
        return float(self._walk["now_s"])

    @property
    def is_walking(self) -> bool:
        """Whether it is on its way to a waypoint."""
        return bool(self._walk["piece"] >= 0)

    @property
    def home(self) -> Array | None:
        """(2,) [m] the waypoint at which the script has it stay now; None on the way to the next one."""
        is_there = self._walk["pause_left"] > 0.0
        return np.array(self._path[self.reached].at_m, dtype=float) if is_there else None

    @property
    def progress(self) -> float:
        """Waypoints reached, from 0 on, plus the share of the path from the last one to the next."""
        reached = self.reached
        if reached == len(self._path) - 1:
            return float(reached)
        start, end = (self._path[i].at_m for i in (reached, reached + 1))
        left = math.dist(self._position, end) / math.dist(start, end)
        return reached + min(max(1.0 - left, 0.0), 1.0)

    def is_awaiting(self, robot: PlanarState | None) -> bool:
        """Return whether it waits for the robot, as its script says."""
        within_m = self._path[self.reached].until_robot_within_m
        if within_m is None or robot is None or self.is_walking or self._walk["wait_left"] <= 0.0:
            return False
        return math.dist(self._position, robot.position) > within_m

    def come_or_go(self, now_s: float) -> bool:
        """Enter the world or leave it at a time [s], and return whether it walks until then."""
        return bool(come_or_go(self.walks, 0, now_s))

    def enter(self, around: Surroundings) -> None:
        """Turn at once to the target of the first waypoint, if that is present."""
        self._find_people(around)
        enter(self.walks, 0, self._scripts, robot_motion(around.robot))

    def step(self, dt_s: float, around: Surroundings, wish: Wish = AS_PLANNED) -> None:
        """Advance by a time step along the script, as modified by a wish; long steps are divided."""
        self._find_people(around)
        if wish is not self._wish:
            self._wish = wish
            self._write_wish(wish)
        obstacles = Obstacles(around.people.motion, around.walker, robot_motion(around.robot), around.walls)
        left = steps_in(dt_s)
        while (left := walk_person(self.walks, 0, self._scripts, dt_s, left, obstacles, _TWO)) >= 0:
            self._plan_leg()

    def _find_people(self, around: Surroundings) -> None:
        if self._faces_people:
            places = {name: around.people.motion[row, :2] for name, row in around.people.rows.items()}
            face_people(self._path, self.script, places)

    def _write_wish(self, wish: Wish) -> None:
        walk = self._walk
        walk["is_sent"], walk["goes_to"] = wish.goes_to is not None, _point(wish.goes_to)
        walk["has_face"], walk["faces"] = wish.faces is not None, _point(wish.faces)
        walk["stands"], walk["pace"], walk["heeds_robot"] = wish.stands, wish.pace, wish.heeds_robot
        walk["clear_m"] = -1.0 if wish.clear_m is None else wish.clear_m

    def _plan_leg(self) -> None:
        """Plan its path again after it sets off from a point near its waypoint."""
        x, y = self._position.tolist()
        pieces = plan_leg(self._path, self.script, (x, y), self.reached)
        self._walk["piece"], self._walk["end_piece"] = pieces.start, pieces.stop


def _point(place: Array | None) -> tuple[float, float]:
    return (0.0, 0.0) if place is None else (float(place[0]), float(place[1]))


class TimetableEntry(NamedTuple):
    """One line of a timetable: time [s], place [m], and what happens."""

    time_s: float
    x_m: float
    y_m: float
    what: str


def timetable(config: PersonConfig) -> list[TimetableEntry]:
    """List when a person enters, passes or reaches its waypoints, sets off again and leaves.

    The times hold when neither the robot nor other people are in the way.
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


def _entry(time_s: float, walker: Walker, what: str) -> TimetableEntry:
    return TimetableEntry(round(time_s, 3), float(walker.position[0]), float(walker.position[1]), what)
