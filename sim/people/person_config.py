"""What describes one person and its script, and what is refused."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal, get_args

from peopleboy.bad_input import BadInput
from peopleboy.sim.people.body.anthropometry import Build, Sex
from peopleboy.sim.people.body.clothes import Clothes
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.reaction import FROM_M, Lead, Reaction

Arms = Literal["swinging", "crossed", "raised"]

HEIGHTS_M = (1.5, 2.0)
SPEEDS_M_S = (0.1, 2.5)


@dataclass(frozen=True, slots=True, kw_only=True)
class Waypoint:
    """A place to go to.

    Attributes:
        at_m: (x, y) [m] in the world frame.
        speed_m_s: [m/s] on the way to it.
        pause_s: [s] waits there.
        face: while pausing, turn to a point, to "robot", or to a person by name; None keeps the direction.
        posture: while pausing.
        until_robot_within_m: [m] the pause lasts until the robot is so near, too; None does not wait for it.
        waits_at_most_s: [s] after the pause, for the robot.
    """

    at_m: tuple[float, float]
    speed_m_s: float = 1.2
    pause_s: float = 0.0
    face: tuple[float, float] | str | None = None
    posture: Posture = Posture.STANDING
    until_robot_within_m: float | None = None
    waits_at_most_s: float = 60.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PersonConfig:
    """One person and its script.

    Attributes:
        name: unique in its world.
        height_m: [m] stature, 1.5 .. 2.0.
        sex, build: decide breadths, depths and girths.
        clothes: what it wears.
        path: where it goes; it enters at the first waypoint.
        enter_s: [s] when it enters.
        leave_s: [s] when it leaves; None stays at the end of the path.
        yields: whether it gives way to robot and people; others walk their script exactly, and wait for a
            robot in their way.
        bag: whether it carries a bag.
        arms: what the arms do while it walks.
        reacts: how it takes to the robot; None for no way in particular.
        leads: how it leads the robot along its path; None if it does not.
        group: with whom it keeps together: those of the same word, whose paths have as many points.
    """

    name: str
    path: tuple[Waypoint, ...]
    height_m: float = 1.75
    sex: Sex = "male"
    build: Build = "average"
    clothes: Clothes = field(default_factory=Clothes)
    enter_s: float = 0.0
    leave_s: float | None = None
    yields: bool = False
    bag: bool = False
    arms: Arms = "swinging"
    reacts: Reaction | None = None
    leads: Lead | None = None
    group: str | None = None

    def __post_init__(self) -> None:
        check_person(self)


def check_person(config: PersonConfig) -> None:
    """Refuse a person that cannot be.

    Raises:
        BadInput: names the person, the key, the value and what would be right.
    """
    if not config.name:
        raise BadInput("person: name must not be empty")
    who = f"person {config.name!r}"
    if not HEIGHTS_M[0] <= config.height_m <= HEIGHTS_M[1]:
        raise BadInput(f"{who}: height_m {config.height_m!r} must be {HEIGHTS_M[0]} .. {HEIGHTS_M[1]}")
    for key, known in (("sex", get_args(Sex)), ("build", get_args(Build)), ("arms", get_args(Arms))):
        if getattr(config, key) not in known:
            raise BadInput(f"{who}: {key} {getattr(config, key)!r} must be one of {', '.join(known)}")
    if config.reacts is not None and config.leads is not None:
        raise BadInput(f"{who}: who leads the robot looks out for it; leave out reacts, or leads")
    _check_times(who, config.enter_s, config.leave_s)
    _check_path(who, config.path)


def _check_times(who: str, enter_s: float, leave_s: float | None) -> None:
    if not 0.0 <= enter_s < math.inf:
        raise BadInput(f"{who}: enter_s {enter_s!r} must be 0 or more")
    if leave_s is not None and not enter_s < leave_s < math.inf:
        raise BadInput(f"{who}: leave_s {leave_s!r} must be after enter_s {enter_s!r}")


def _check_path(who: str, path: tuple[Waypoint, ...]) -> None:
    if not path:
        raise BadInput(f"{who}: path must have at least one waypoint")
    for i, waypoint in enumerate(path):
        _check_waypoint(f"{who}: path[{i}]", waypoint)
    for i, (a, b) in enumerate(pairwise(path), start=1):
        if math.dist(a.at_m, b.at_m) < 0.01:
            raise BadInput(
                f"{who}: path[{i}]: at_m {b.at_m!r} is where path[{i - 1}] is; move it or remove it"
            )


def _check_waypoint(where: str, waypoint: Waypoint) -> None:
    if not all(math.isfinite(c) for c in waypoint.at_m):
        raise BadInput(f"{where}: at_m {waypoint.at_m!r} must be finite")
    if not SPEEDS_M_S[0] <= waypoint.speed_m_s <= SPEEDS_M_S[1]:
        raise BadInput(
            f"{where}: speed_m_s {waypoint.speed_m_s!r} must be {SPEEDS_M_S[0]} .. {SPEEDS_M_S[1]}"
        )
    if not 0.0 <= waypoint.pause_s < math.inf:
        raise BadInput(f"{where}: pause_s {waypoint.pause_s!r} must be 0 or more")
    within_m = waypoint.until_robot_within_m
    if within_m is not None and not FROM_M[0] <= within_m <= FROM_M[1]:
        raise BadInput(f"{where}: until_robot_within_m {within_m!r} must be {FROM_M[0]} .. {FROM_M[1]}")
    if not 0.0 < waypoint.waits_at_most_s < math.inf:
        raise BadInput(f"{where}: waits_at_most_s {waypoint.waits_at_most_s!r} must be more than 0")
    if isinstance(waypoint.face, tuple) and not all(math.isfinite(c) for c in waypoint.face):
        raise BadInput(f"{where}: face {waypoint.face!r} must be finite")
    if waypoint.posture not in set(Posture):
        raise BadInput(f"{where}: posture {waypoint.posture!r} must be one of {', '.join(Posture)}")
