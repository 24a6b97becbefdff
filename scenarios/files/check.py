"""Check what a schema cannot: people inside walls, a robot inside a table, two people with one name."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput, Key, dotted, found_in, gathered
from peopleboy.scenarios.files.check_moves import MovedThings
from peopleboy.scenarios.files.people import PersonSpec
from peopleboy.scenarios.files.robot import ORACLE, RobotSpec, check_cameras
from peopleboy.scenarios.files.routes import Point, find_route
from peopleboy.scenarios.files.scenario_file import (
    STRENGTHS,
    CameraFault,
    FaultSpec,
    ScenarioSpec,
    SonarFault,
)
from peopleboy.sim.people.person_config import Waypoint
from peopleboy.sim.places.floor_plan import FloorPlan, Rectangle
from peopleboy.sim.places.place import Place
from peopleboy.sim.truth.truth import BORDER
from peopleboy.sim.world_config import CONTROL_HZ
from peopleboy.tracker.trackers import TRACKERS
from peopleboy.wording import hint

BODY_M = 0.2  # clearance of a person's centre from walls and objects
ROBOT_M = 0.27  # radius of the circle around the robot
_ONE_PLACE_M = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """Where people can walk.

    Attributes:
        plan: the floor plan.
        boxes: walls and objects, grown by half a person's width.
        names: names of the boxes.
        seats: names of objects to sit on.
        moved: objects that do not stay where they start.
    """

    plan: FloorPlan
    boxes: tuple[Rectangle, ...]
    names: tuple[str, ...]
    seats: frozenset[str]
    moved: MovedThings

    def fault(self, person: PersonSpec) -> BadInput | None:
        """Return the first fault of a person's path, with keys below the person's; None without any."""
        return next(self.faults(person), None)

    def faults(self, person: PersonSpec) -> Iterator[BadInput]:
        """Yield the faults of a person's path, with keys below the person's."""
        found = False
        for fault in self._path_faults(person):
            found = True
            yield fault
        moved = None if found else self.moved.fault(replace(person, path=self.routed(person)), BODY_M)
        if moved is not None:
            yield moved

    @property
    def robot_boxes(self) -> tuple[Rectangle, ...]:
        """The boxes, grown by the robot's radius."""
        return tuple(box.grown(ROBOT_M - BODY_M) for box in self.boxes)

    def robot_route(self, start: Point, end: Point) -> tuple[Point, ...] | None:
        """Return the corners of the robot's shortest route between two places; None without a route."""
        return find_route(self.plan, self.robot_boxes, start, end)

    def routed(self, person: PersonSpec) -> tuple[Waypoint, ...]:
        """Return a person's path, with `route: true` led around what is in the way."""
        if not person.route:
            return person.path
        path = list(person.path[:1])
        for start, end in pairwise(person.path):
            corners = self._route(start, end) or ()
            path += [
                Waypoint(at_m=(round(x, 4), round(y, 4)), speed_m_s=end.speed_m_s) for x, y in corners[1:-1]
            ]
            path.append(end)
        return tuple(path)

    def _route(self, start: Waypoint, end: Waypoint) -> tuple[Point, ...] | None:
        boxes = [box for box, _ in self._blocking(start, end)]
        return find_route(self.plan, boxes, start.at_m, end.at_m)

    def _path_faults(self, person: PersonSpec) -> Iterator[BadInput]:
        """Yield a fault for each waypoint that is not free, and each line between free ones that is not."""
        is_free, path = False, person.path
        for index, waypoint in enumerate(path):
            fault = self._point_fault(waypoint)
            was_free, is_free = is_free, fault is None
            if fault is None and was_free:
                fault = (self._route_fault if person.route else self._leg_fault)(path[index - 1], waypoint)
            if fault is not None:
                yield BadInput(fault, key=("path", index, "at_m"))

    def _point_fault(self, waypoint: Waypoint) -> str | None:
        x, y = waypoint.at_m
        for box, name in self._blocking(waypoint):
            if box.contains(x, y):
                return f"({x:g}, {y:g}) is in or within {BODY_M:g} m of {name!r}; move it away"
        if not self.plan.contains(x, y):
            return f"({x:g}, {y:g}) is outside the floor; {self.plan.describe()}"
        return None

    def _leg_fault(self, start: Waypoint, end: Waypoint) -> str | None:
        for box, name in self._blocking(start, end):
            if crosses(box, start.at_m, end.at_m):
                (x0, y0), (x1, y1) = start.at_m, end.at_m
                return (
                    f"the straight line from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g}) runs through "
                    f"or within {BODY_M:g} m of {name!r}; add a waypoint that leads around it, or route: true"
                )
        return None

    def _route_fault(self, start: Waypoint, end: Waypoint) -> str | None:
        if self._route(start, end) is not None:
            return None
        (x0, y0), (x1, y1) = start.at_m, end.at_m
        return (
            f"no gap of {2.0 * BODY_M:g} m leads from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g}); "
            "move the waypoint, or what stands in between"
        )

    def _blocking(self, *waypoints: Waypoint) -> Iterator[tuple[Rectangle, str]]:
        """Yield the boxes and names that block; a seat does not block a person who sits down or gets up."""
        may_sit = any(waypoint.posture == "sitting" for waypoint in waypoints)
        for box, name in zip(self.boxes, self.names, strict=True):
            if not (may_sit and name in self.seats):
                yield box, name


def make_ground(spec: ScenarioSpec, plan: FloorPlan, place: Place) -> Ground:
    """Collect everything that people must walk around."""
    return Ground(
        plan=plan,
        boxes=tuple(_rectangle(row).grown(BODY_M) for row in place.obstacles),
        names=place.obstacle_names,
        seats=place.seats,
        moved=MovedThings(
            place=place,
            duration_s=spec.duration_s,
        ),
    )


def check_scenario(spec: ScenarioSpec, people: Sequence[tuple[Key, PersonSpec]], ground: Ground) -> None:
    """Refuse a scenario that cannot be run.

    Args:
        spec: the scenario.
        people: all people, including group members, each with its key in the file.
        ground: where people can walk.

    Raises:
        BadInput: the scenario is invalid; the error holds the key.
    """
    _check_duration(spec.duration_s)
    _check_order("at_s", [light.at_s for light in spec.lights], ("lights",))
    _check_faults(spec)
    _check_company(people, ground.moved.place)
    _check_robot(spec, ground)
    names = [person.name for _, person in people]
    faults = [
        fault.within(*key) for key, person in people for fault in _person_faults(person, spec, ground, names)
    ]
    if faults:
        raise gathered(faults)
    ground.moved.check(people, spec.robot.at_m, ROBOT_M)
    with found_in("robot", "cameras"):
        check_cameras(spec.robot)


def crosses(box: Rectangle, start: tuple[float, float], end: tuple[float, float]) -> bool:
    """Return whether a line segment has a point inside a rectangle (slab method)."""
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
            f"{duration_s:g} is shorter than a frame; must be at least 1/{CONTROL_HZ} s", key=("duration_s",)
        )


def _check_company(people: Sequence[tuple[Key, PersonSpec]], place: Place) -> None:
    """Refuse people who conflict with each other or with the place."""
    _check_names(people, place)
    _check_groups(people)
    _check_starts(people)


def _person_faults(
    person: PersonSpec, spec: ScenarioSpec, ground: Ground, names: Sequence[str]
) -> Iterator[BadInput]:
    """Yield the faults of a person's script, or if there are none, those of the path and of its start."""
    try:
        _check_times(person, spec.duration_s)
        _check_faces(person, names)
    except BadInput as fault:
        yield fault
        return
    yield from ground.faults(person)
    try:
        _check_distance(person, spec.robot)
    except BadInput as fault:
        yield fault


def _check_distance(person: PersonSpec, robot: RobotSpec) -> None:
    """Refuse a person who starts inside the robot."""
    distance = math.dist(person.path[0].at_m, robot.at_m)
    if distance < ROBOT_M + BODY_M:
        raise BadInput(
            f"{person.name!r} starts {distance:.2g} m from the robot's centre, inside the robot; "
            f"must be at least {ROBOT_M + BODY_M:g} m",
            key=("path", 0, "at_m"),
        )


def _check_names(people: Sequence[tuple[Key, PersonSpec]], place: Place) -> None:
    """Refuse names that the ground truth could not tell apart from each other or from other entities."""
    standing = {fixture.name.split("/")[0] for fixture in place.fixtures}
    seen: dict[str, Key] = {}
    for key, person in people:
        if person.name in standing:
            raise BadInput(f"name {person.name!r} is used by an object in the place; choose another", key=key)
        if person.name == BORDER:
            raise BadInput(f"name {BORDER!r} is reserved for the image border; choose another", key=key)
        if person.name == "robot":
            raise BadInput("name 'robot' is reserved for the robot; choose another", key=key)
        if person.name in seen:
            other = dotted(seen[person.name])
            raise BadInput(f"name {person.name!r} is also used by {other}; names must be unique", key=key)
        seen[person.name] = key


def _check_groups(people: Sequence[tuple[Key, PersonSpec]]) -> None:
    """Refuse groups that cannot keep together: one member only, or paths of different lengths."""
    first: dict[str, PersonSpec] = {}
    sizes = Counter(person.group for _, person in people)
    for key, person in people:
        if person.group is None:
            continue
        if sizes[person.group] == 1:
            raise BadInput(
                f"{person.group!r} has only one member, {person.name!r}; add others, or leave it out",
                key=(*key, "group"),
            )
        other = first.setdefault(person.group, person)
        if len(other.path) != len(person.path):
            raise BadInput(
                f"{person.group!r}: {person.name!r} has {len(person.path)} waypoints and {other.name!r} "
                f"{len(other.path)}; all members need the same number",
                key=(*key, "group"),
            )


def _check_starts(people: Sequence[tuple[Key, PersonSpec]]) -> None:
    """Refuse two people who enter at the same time and place, because their bodies would coincide."""
    for index, (key, person) in enumerate(people):
        for _, other in people[:index]:
            is_there = math.dist(person.path[0].at_m, other.path[0].at_m) < _ONE_PLACE_M
            if is_there and person.enter_s == other.enter_s:
                raise BadInput(
                    f"{person.name!r} starts at the same time and place as {other.name!r}; move one of them",
                    key=(*key, "path", 0, "at_m"),
                )


def _check_times(person: PersonSpec, duration_s: float) -> None:
    if person.enter_s >= duration_s:
        raise BadInput(
            f"{person.enter_s:g} must be before the end, duration_s {duration_s:g}", key=("enter_s",)
        )
    for index in range(1, len(person.path)):
        if math.dist(person.path[index - 1].at_m, person.path[index].at_m) < 0.05:
            raise BadInput("equals the last waypoint; use pause_s there to stay", key=("path", index, "at_m"))


def _check_faces(person: PersonSpec, names: Sequence[str]) -> None:
    known = [*(name for name in names if name != person.name), "robot"]
    for index, waypoint in enumerate(person.path):
        if isinstance(waypoint.face, str) and waypoint.face not in known:
            raise BadInput(
                f"unknown name {waypoint.face!r}; {hint(waypoint.face, known)}", key=("path", index, "face")
            )


def _check_robot(spec: ScenarioSpec, ground: Ground) -> None:
    with found_in("robot"):
        with found_in("at_m"):
            _check_spot(spec.robot.at_m, ground)
        _check_behaviour(spec.robot)
        _check_goal(spec.robot, ground)
        _check_order("from_s", [command.from_s for command in spec.robot.commands], ("commands",))


def _check_spot(spot: Point, ground: Ground) -> None:
    """Refuse a place where the robot cannot stand."""
    x, y = spot
    for box, name in zip(ground.robot_boxes, ground.names, strict=True):
        if box.contains(x, y):
            raise BadInput(f"({x:g}, {y:g}) is in or within {ROBOT_M:g} m of {name!r}; move it away")
    if not ground.plan.contains(x, y):
        raise BadInput(f"({x:g}, {y:g}) is outside the floor; {ground.plan.describe()}")


def _check_behaviour(robot: RobotSpec) -> None:
    if robot.commands and robot.behaviour != "scripted":
        raise BadInput(f"behaviour {robot.behaviour!r} takes none; use 'scripted'", key=("commands",))
    if robot.behaviour == "scripted" and not robot.commands:
        example = "'{from_s: 0.0, linear_m_s: 0.5}'"
        raise BadInput(
            f"a scripted robot needs at least one, such as {example}; or use behaviour 'stand'",
            key=("commands",),
        )
    for key in ("keep_height", "give_up_s"):
        if getattr(robot, key) is not None and robot.behaviour != "follow_person":
            raise BadInput("only behaviour 'follow_person' takes it; leave it out", key=(key,))
    if robot.walls_by is not None and robot.behaviour != "follow_corridor":
        raise BadInput("only behaviour 'follow_corridor' takes it; leave it out", key=("walls_by",))
    if robot.behaviour == "go_to" and robot.goal_m is None:
        raise BadInput("behaviour 'go_to' needs one, such as [6.0, 1.5]", key=("goal_m",))
    if robot.tracker is not None:
        _check_tracker(robot.tracker)


def _check_goal(robot: RobotSpec, ground: Ground) -> None:
    """Refuse a goal that the robot cannot stand at or get to."""
    if robot.goal_m is None:
        return
    with found_in("goal_m"):
        _check_spot(robot.goal_m, ground)
        if ground.robot_route(robot.at_m, robot.goal_m) is None:
            (x, y), (x0, y0) = robot.goal_m, robot.at_m
            raise BadInput(
                f"no gap of {2.0 * ROBOT_M:g} m leads the robot from ({x0:g}, {y0:g}) to ({x:g}, {y:g}); "
                "move the goal, or what stands in between"
            )


def _check_tracker(name: str) -> None:
    if name not in (*TRACKERS, ORACLE):
        known = ", ".join((*TRACKERS, ORACLE))
        raise BadInput(f"unknown name {name!r}; choose from {known}", key=("tracker",))


def _check_faults(spec: ScenarioSpec) -> None:
    for index, fault in enumerate(spec.faults):
        if fault.from_s >= spec.duration_s:
            raise BadInput(
                f"{fault.from_s:g} must be before the end, duration_s {spec.duration_s:g}",
                key=("faults", index, "from_s"),
            )
        cameras = ("thermal", "colour", *(spec.robot.cameras or ()))
        if fault.camera is not None and fault.kind not in get_args(CameraFault):
            raise BadInput(f"{fault.kind} has no camera; leave it out", key=("faults", index, "camera"))
        if fault.camera is not None and fault.camera not in cameras:
            known = ", ".join(dict.fromkeys(cameras))
            raise BadInput(
                f"unknown camera {fault.camera!r}; choose from {known}", key=("faults", index, "camera")
            )
        if fault.sonar is not None and fault.kind not in get_args(SonarFault):
            raise BadInput(f"{fault.kind} has no sonar; leave it out", key=("faults", index, "sonar"))
        if fault.strength is not None:
            _check_strength(fault, index)


def _check_strength(fault: FaultSpec, index: int) -> None:
    allowed = STRENGTHS.get(fault.kind)
    if allowed is None:
        raise BadInput(f"{fault.kind} has no strength; leave it out", key=("faults", index, "strength"))
    if not fault.chosen_strength <= allowed.greatest:
        raise BadInput(
            f"{fault.strength:g} must be at most {allowed.greatest:g}", key=("faults", index, "strength")
        )


def _check_order(unit_key: str, times: Sequence[float], key: Key) -> None:
    for index in range(1, len(times)):
        if times[index] <= times[index - 1]:
            raise BadInput(
                f"{times[index]:g} must be after {times[index - 1]:g}", key=(*key, index, unit_key)
            )


def _rectangle(row: NDArray[np.float64]) -> Rectangle:
    return Rectangle(*(float(value) for value in row))
