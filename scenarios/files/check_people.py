"""What a schema cannot see of people: two of one name, in one place, or who come when all is over."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence

from peopleboy.bad_input import BadInput, Key, dotted
from peopleboy.scenarios.files.people import PersonSpec
from peopleboy.scenarios.files.robot import RobotSpec
from peopleboy.sim.places.place import Place
from peopleboy.sim.truth.truth import BORDER
from peopleboy.wording import hint

BODY_M = 0.2  # clearance that the middle of a person keeps from walls and things
ROBOT_M = 0.27  # radius of the circle around the robot
_ONE_PLACE_M = 0.05


def check_company(people: Sequence[tuple[Key, PersonSpec]], place: Place) -> None:
    """Refuse people who cannot be there together.

    Args:
        people: everybody, groups included, each with its key in the file.
        place: where they are.

    Raises:
        BadInput: with the key of what it is.
    """
    _check_names(people, place)
    _check_groups(people)
    _check_starts(people)


def check_person(person: PersonSpec, duration_s: float, names: Sequence[str]) -> None:
    """Refuse a person who cannot do what the script says in so many seconds, among people of these names.

    Raises:
        BadInput: with the key, below the person's.
    """
    _check_times(person, duration_s)
    _check_faces(person, names)


def check_distance(person: PersonSpec, robot: RobotSpec) -> None:
    """Refuse a person who starts in the robot.

    Raises:
        BadInput: with the key, below the person's.
    """
    distance = math.dist(person.path[0].at_m, robot.at_m)
    if distance < ROBOT_M + BODY_M:
        raise BadInput(
            f"{person.name!r} starts {distance:.2g} m from the robot's middle, inside it; "
            f"keep {ROBOT_M + BODY_M:g} m",
            key=("path", 0, "at_m"),
        )


def _check_names(people: Sequence[tuple[Key, PersonSpec]], place: Place) -> None:
    """Refuse people whom the truth could not tell from each other, or from what else it names."""
    standing = {fixture.name.split("/")[0] for fixture in place.fixtures}
    seen: dict[str, Key] = {}
    for key, person in people:
        if person.name in standing:
            raise BadInput(f"name {person.name!r} is that of something in the place; choose another", key=key)
        if person.name == BORDER:
            raise BadInput(f"name {BORDER!r} is taken by the image's border; choose another", key=key)
        if person.name == "robot":
            raise BadInput("name 'robot' is taken by the robot; choose another", key=key)
        if person.name in seen:
            other = dotted(seen[person.name])
            raise BadInput(f"name {person.name!r} is also that of {other}; give each its own", key=key)
        seen[person.name] = key


def _check_groups(people: Sequence[tuple[Key, PersonSpec]]) -> None:
    """Refuse people who are to keep together and cannot compare how far they have got."""
    first: dict[str, PersonSpec] = {}
    sizes = Counter(person.group for _, person in people)
    for key, person in people:
        if person.group is None:
            continue
        if sizes[person.group] == 1:
            raise BadInput(
                f"{person.group!r} has nobody but {person.name!r}; give it to others, too, or leave it out",
                key=(*key, "group"),
            )
        other = first.setdefault(person.group, person)
        if len(other.path) != len(person.path):
            raise BadInput(
                f"{person.group!r}: {person.name!r} has {len(person.path)} points of its path, and "
                f"{other.name!r} {len(other.path)}; give them as many",
                key=(*key, "group"),
            )


def _check_starts(people: Sequence[tuple[Key, PersonSpec]]) -> None:
    """Refuse people who come at the same time to the same place, and would be one body."""
    for index, (key, person) in enumerate(people):
        for _, other in people[:index]:
            is_there = math.dist(person.path[0].at_m, other.path[0].at_m) < _ONE_PLACE_M
            if is_there and person.enter_s == other.enter_s:
                raise BadInput(
                    f"{person.name!r} starts where {other.name!r} does, in the same body; move one of them",
                    key=(*key, "path", 0, "at_m"),
                )


def _check_times(person: PersonSpec, duration_s: float) -> None:
    if person.enter_s >= duration_s:
        raise BadInput(
            f"{person.enter_s:g} must be before the end, duration_s {duration_s:g}", key=("enter_s",)
        )
    for index in range(1, len(person.path)):
        if math.dist(person.path[index - 1].at_m, person.path[index].at_m) < 0.05:
            raise BadInput("it is the point before; use pause_s there to stay", key=("path", index, "at_m"))


def _check_faces(person: PersonSpec, names: Sequence[str]) -> None:
    known = [*(name for name in names if name != person.name), "robot"]
    for index, waypoint in enumerate(person.path):
        if isinstance(waypoint.face, str) and waypoint.face not in known:
            raise BadInput(
                f"unknown name {waypoint.face!r}; {hint(waypoint.face, known)}", key=("path", index, "face")
            )
