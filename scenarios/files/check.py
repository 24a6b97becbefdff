"""What a schema cannot see: people in walls, robots in tables, two of one name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput, Key, found_in
from peopleboy.scenarios.files.check_moves import MovedThings
from peopleboy.scenarios.files.check_people import (
    BODY_M,
    ROBOT_M,
    check_company,
    check_distance,
    check_person,
)
from peopleboy.scenarios.files.people import PersonSpec
from peopleboy.scenarios.files.robot import ORACLE, RobotSpec, check_cameras
from peopleboy.scenarios.files.scenario_file import ScenarioSpec
from peopleboy.sim.people.person_config import Waypoint
from peopleboy.sim.places.floor_plan import FloorPlan, Rectangle
from peopleboy.sim.places.furniture.place_things import describe_floor, name_things
from peopleboy.sim.places.furniture.thing_config import KINDS
from peopleboy.sim.places.place import Place
from peopleboy.sim.world_config import CONTROL_HZ
from peopleboy.tracker.trackers import TRACKERS


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """Where people can walk.

    Attributes:
        plan: the floor.
        boxes: walls and things, grown by half a person.
        names: theirs.
        seats: names of things that one may sit on.
        moved: things that are not always where they are at first.
    """

    plan: FloorPlan
    boxes: tuple[Rectangle, ...]
    names: tuple[str, ...]
    seats: frozenset[str]
    moved: MovedThings

    def fault(self, person: PersonSpec) -> BadInput | None:
        """Return what is wrong with a person's path, below its key; None if it can be walked."""
        return self._path_fault(person.path) or self.moved.fault(person, BODY_M)

    def _path_fault(self, path: Sequence[Waypoint]) -> BadInput | None:
        for index, waypoint in enumerate(path):
            fault = self._point_fault(waypoint)
            if fault is None and index > 0:
                fault = self._leg_fault(path[index - 1], waypoint)
            if fault is not None:
                return BadInput(fault, key=("path", index, "at_m"))
        return None

    def _point_fault(self, waypoint: Waypoint) -> str | None:
        x, y = waypoint.at_m
        for box, name in self._blocking(waypoint):
            if box.contains(x, y):
                return f"({x:g}, {y:g}) is in or within {BODY_M:g} m of {name!r}; move it away"
        if not any(area.contains(x, y) for area in self.plan.walkable()):
            return f"({x:g}, {y:g}) is outside the floor; {describe_floor(self.plan)}"
        return None

    def _leg_fault(self, start: Waypoint, end: Waypoint) -> str | None:
        for box, name in self._blocking(start, end):
            if crosses(box, start.at_m, end.at_m):
                (x0, y0), (x1, y1) = start.at_m, end.at_m
                return (
                    f"the straight way from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g}) runs through "
                    f"or within {BODY_M:g} m of {name!r}; add a point beside it"
                )
        return None

    def _blocking(self, *waypoints: Waypoint) -> Iterator[tuple[Rectangle, str]]:
        """Everything in the way; a seat is not, for who sits down or gets up."""
        may_sit = any(waypoint.posture == "sitting" for waypoint in waypoints)
        for box, name in zip(self.boxes, self.names, strict=True):
            if not (may_sit and name in self.seats):
                yield box, name


def make_ground(spec: ScenarioSpec, plan: FloorPlan, place: Place) -> Ground:
    """Collect what people must walk around."""
    names = name_things(spec.things)
    named = zip(names, spec.things, strict=True)
    seats = frozenset(name for name, thing in named if thing.kind in KINDS and KINDS[thing.kind].is_seat)
    return Ground(
        plan=plan,
        boxes=tuple(_rectangle(row).grown(BODY_M) for row in place.obstacles),
        names=place.obstacle_names,
        seats=seats,
        moved=MovedThings(
            place=place,
            seats=seats,
            keys={name: ("things", index) for index, name in enumerate(names)},
            duration_s=spec.duration_s,
        ),
    )


def check_scenario(spec: ScenarioSpec, people: Sequence[tuple[Key, PersonSpec]], ground: Ground) -> None:
    """Refuse what cannot be played.

    Args:
        spec: the scenario.
        people: everybody, groups included, each with its key in the file.
        ground: where one can walk.

    Raises:
        BadInput: with the key of what it is.
    """
    _check_duration(spec.duration_s)
    check_company(people, ground.moved.place)
    _check_robot(spec, ground)
    with found_in("robot", "cameras"):
        check_cameras(spec.robot)
    _check_order("at_s", [light.at_s for light in spec.lights], ("lights",))
    _check_faults(spec)
    for key, person in people:
        with found_in(*key):
            check_person(person, spec.duration_s, [other.name for _, other in people])
            fault = ground.fault(person)
            if fault is not None:
                raise fault
            check_distance(person, spec.robot)
    ground.moved.check(people, spec.robot.at_m, ROBOT_M)


def crosses(box: Rectangle, start: tuple[float, float], end: tuple[float, float]) -> bool:
    """Whether a straight line has a point inside a rectangle (slab method)."""
    first, last = 0.0, 1.0
    spans = (box.min_x, box.max_x), (box.min_y, box.max_y)
    for (low, high), origin, goal in zip(spans, start, end, strict=True):
        way = goal - origin
        if abs(way) < 1e-12:
            if not low < origin < high:
                return False
            continue
        near, far = sorted(((low - origin) / way, (high - origin) / way))
        first, last = max(first, near), min(last, far)
    return first < last


def _check_duration(duration_s: float) -> None:
    if round(duration_s * CONTROL_HZ) < 1:
        raise BadInput(
            f"{duration_s:g} is less than a frame; give 1/{CONTROL_HZ} s at least", key=("duration_s",)
        )


def _check_robot(spec: ScenarioSpec, ground: Ground) -> None:
    with found_in("robot"):
        _check_start(spec.robot, ground)
        _check_behaviour(spec.robot)
        _check_order("from_s", [command.from_s for command in spec.robot.commands], ("commands",))


def _check_start(robot: RobotSpec, ground: Ground) -> None:
    x, y = robot.at_m
    margin = ROBOT_M - BODY_M
    for box, name in zip(ground.boxes, ground.names, strict=True):
        if box.grown(margin).contains(x, y):
            raise BadInput(
                f"({x:g}, {y:g}) is in or within {ROBOT_M:g} m of {name!r}; move it away", key=("at_m",)
            )
    if not any(area.contains(x, y) for area in ground.plan.walkable()):
        raise BadInput(f"({x:g}, {y:g}) is outside the floor; {describe_floor(ground.plan)}", key=("at_m",))


def _check_behaviour(robot: RobotSpec) -> None:
    if robot.commands and robot.behaviour != "scripted":
        raise BadInput(f"a robot that is to {robot.behaviour} takes none; use 'scripted'", key=("commands",))
    if robot.behaviour == "scripted" and not robot.commands:
        example = "'{from_s: 0.0, linear_m_s: 0.5}'"
        raise BadInput(
            f"a scripted robot has none; give at least one, such as {example}, or let the robot 'stand'",
            key=("commands",),
        )
    if robot.keep_height is not None and robot.behaviour != "follow_person":
        raise BadInput("only a robot that is to 'follow_person' takes it", key=("keep_height",))
    if robot.walls_by is not None and robot.behaviour != "follow_corridor":
        raise BadInput("only a robot that is to 'follow_corridor' takes it", key=("walls_by",))
    if robot.tracker is not None:
        _check_tracker(robot.tracker)


def _check_tracker(name: str) -> None:
    if name not in (*TRACKERS, ORACLE):
        known = ", ".join((*TRACKERS, ORACLE))
        raise BadInput(f"unknown name {name!r}; there are {known}", key=("tracker",))


def _check_faults(spec: ScenarioSpec) -> None:
    for index, fault in enumerate(spec.faults):
        if fault.from_s >= spec.duration_s:
            raise BadInput(
                f"{fault.from_s:g} must be before the end, duration_s {spec.duration_s:g}",
                key=("faults", index, "from_s"),
            )


def _check_order(unit_key: str, times: Sequence[float], key: Key) -> None:
    for index in range(1, len(times)):
        if times[index] <= times[index - 1]:
            raise BadInput(
                f"{times[index]:g} must be after {times[index - 1]:g} before it", key=(*key, index, unit_key)
            )


def _rectangle(row: NDArray[np.float64]) -> Rectangle:
    return Rectangle(*(float(value) for value in row))
