"""How people behave towards the robot and their group: reactions, leading, and decisions."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.person_config import Lead, Reaction, Way
from peopleboy.sim.people.walking.path import is_free
from peopleboy.sim.people.walking.social_force import PlanarState
from peopleboy.sim.people.walking.walker import AS_PLANNED, Wish

Array = NDArray[np.float64]

_FORGOTTEN_M: Final = 1.0  # an encounter ends at this distance beyond the one at which it began
_ROOM_M: Final = 0.3  # distance that a person keeps from walls


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConductSituation:
    """A person and the robot at an instant.

    Attributes:
        at: (2,) [m] position of the person.
        heading: [rad] direction of its body.
        home: (2,) [m] the waypoint at which the script has it stay now; None on the way to the next one.
        is_walking: whether it is on the way to the next waypoint.
        is_seated: whether it sits or lies.
        robot: the robot's state.
        walls: (K, 4) [m] rectangles that block people and their view.
    """

    at: Array
    heading: float
    home: Array | None
    is_walking: bool
    is_seated: bool
    robot: PlanarState
    walls: Array

    @property
    def gap_m(self) -> float:
        """[m] distance between the centres of person and robot."""
        return math.dist(self.at, self.robot.position)

    @property
    def away(self) -> Array:
        """(2,) unit vector from the robot to the person; along x if their positions are equal."""
        way = self.at - self.robot.position
        length = float(np.hypot(*way))
        return way / length if length > 1e-6 else np.array([1.0, 0.0])

    @property
    def is_in_sight(self) -> bool:
        """Whether the line of sight between the two is free."""
        return is_free(self.at, self.robot.position, self.walls)

    def can_go(self, place: Array) -> bool:
        """Return whether the straight path to a point (2,) [m] is free."""
        return is_free(self.at, place, self.walls, _ROOM_M)


class Encounter:
    """Decides at every step whether a person and the robot have met.

    They meet when the robot is near enough and in sight, and part when it is a metre farther away. Losing
    sight of each other meanwhile does not end the encounter.
    """

    def __init__(self, from_m: float) -> None:
        self._from_m = from_m
        self._is_on = False

    def update(self, now: ConductSituation) -> bool:
        """Update with the current situation, and return whether the two have met."""
        gap_m = now.gap_m
        if self._is_on:
            self._is_on = gap_m <= self._from_m + _FORGOTTEN_M
        else:
            self._is_on = gap_m <= self._from_m and now.is_in_sight
        return self._is_on


_COMES_M_S: Final = 0.05  # a slower robot counts as standing
_FORESEEN_S: Final = 4.0  # a standing person steps aside for a robot that arrives within this time
_SPARE_M: Final = 0.3  # added to the distance to keep, so that one step is enough
_RETREAT_M: Final = 1.2  # added to the distance to keep, so that the robot takes a while to come near again
_ARRIVED_M: Final = 0.3
_IN_THE_WAY_M: Final = 0.6  # a person this near to its target point is in the robot's way
_CHASE_S: Final = 15.0  # time after which a person gives up reaching the robot
_PASSES_M: Final = 0.9  # distance from the robot's centre within which it blocks a person who goes on
_NECK_RAD: Final = math.radians(70.0)  # beyond this head angle the body turns, too
_WAYS_OUT_RAD: Final = tuple(math.radians(side * off) for off in (0.0, 30.0, 60.0, 90.0) for side in (1, -1))


class Conduct(Protocol):
    """What a person does during one encounter with the robot."""

    def wish(self, dt_s: float, now: ConductSituation) -> Wish:
        """Return the person's change to its script."""
        ...


class Ignoring:
    """Neither looks at the robot nor makes way; stops only to avoid walking into it."""

    def wish(self, dt_s: float, now: ConductSituation) -> Wish:  # noqa: ARG002
        """Return the person's change to its script."""
        return Wish(heeds_robot=False)


class MakingWay:
    """Walks round the robot early, steps aside when it approaches, and looks at it."""

    def __init__(self, reaction: Reaction) -> None:
        self._keep_m = reaction.distance_m
        self._aside: Array | None = None

    def wish(self, dt_s: float, now: ConductSituation) -> Wish:  # noqa: ARG002
        """Return the person's change to its script."""
        robot = now.robot.position
        if now.is_walking or now.is_seated:
            return Wish(clear_m=self._keep_m, gaze_at=robot)
        place = now.at if now.home is None else now.home
        is_coming = _lateral_m(place, now, self._keep_m + _SPARE_M) is not None
        if is_coming and self._aside is None:
            self._aside = self._place_aside(now)
        if not is_coming:
            self._aside = None
            return Wish(clear_m=self._keep_m, gaze_at=robot)
        return Wish(clear_m=self._keep_m, gaze_at=robot, goes_to=self._aside, stands=True, faces=robot)

    def _place_aside(self, now: ConductSituation) -> Array | None:
        """Return where to stand so that the robot passes: the nearer side of its path, if there is room."""
        lateral = _lateral_m(now.at, now, self._keep_m)
        if lateral is None:
            return None
        speed = float(np.hypot(*now.robot.velocity))
        left = np.array([-now.robot.velocity[1], now.robot.velocity[0]]) / speed
        side = 1.0 if lateral >= 0.0 else -1.0
        for way in (side, -side):
            place = now.at + (way * (self._keep_m + _SPARE_M) - lateral) * left
            if now.can_go(place):
                return place
        return None


class Wary:
    """Keeps clear of the robot, walks away when it approaches, and looks back at it."""

    def __init__(self, reaction: Reaction) -> None:
        self._keep_m = reaction.distance_m
        self._refuge: Array | None = None

    def wish(self, dt_s: float, now: ConductSituation) -> Wish:  # noqa: ARG002
        """Return the person's change to its script."""
        robot = now.robot.position
        if now.is_seated or (now.is_walking and now.gap_m > self._keep_m):
            self._refuge = None
            return Wish(clear_m=self._keep_m, gaze_at=robot)
        if self._refuge is not None and math.dist(now.at, self._refuge) < _ARRIVED_M:
            self._refuge = None
        is_near = now.gap_m < self._keep_m + _SPARE_M
        if is_near and (self._refuge is None or math.dist(self._refuge, robot) < self._keep_m):
            self._refuge = self._place_away(now)
        if self._refuge is not None:
            return Wish(clear_m=self._keep_m, gaze_at=robot, goes_to=self._refuge)
        stays = now.home is not None and math.dist(now.home, robot) < self._keep_m + _SPARE_M
        return Wish(clear_m=self._keep_m, gaze_at=robot, stands=stays, faces=robot if stays else None)

    def _place_away(self, now: ConductSituation) -> Array | None:
        """Return where to be clear of the robot again: straight away from it, or aside where walls are."""
        away = now.away
        for turn in _WAYS_OUT_RAD:
            cos, sin = math.cos(turn), math.sin(turn)
            direction = np.array([cos * away[0] - sin * away[1], sin * away[0] + cos * away[1]])
            place = now.robot.position + (self._keep_m + _RETREAT_M) * direction
            if now.can_go(place):
                return place
        return None


class Curious:
    """Walks up to the robot, looks at it for a while, and goes on."""

    def __init__(self, reaction: Reaction) -> None:
        self._keep_m = reaction.distance_m
        self._gaze_s = reaction.duration_s
        self._chases_s = _CHASE_S

    def wish(self, dt_s: float, now: ConductSituation) -> Wish:
        """Return the person's change to its script."""
        if self._gaze_s <= 0.0 or self._chases_s <= 0.0:
            return Wish(clear_m=_PASSES_M)
        robot = now.robot.position
        if now.gap_m <= self._keep_m + _ARRIVED_M:
            self._gaze_s -= dt_s
            return Wish(stands=True, faces=robot, gaze_at=robot)
        self._chases_s -= dt_s
        place = robot + self._keep_m * now.away
        if now.is_seated or not now.can_go(place):
            return Wish(gaze_at=robot)
        return Wish(goes_to=place, faces=robot, gaze_at=robot)


class Blocking:
    """Steps into the robot's way, stands before it for a while, and goes on."""

    def __init__(self, reaction: Reaction) -> None:
        self._keep_m = reaction.distance_m
        self._stands_s = reaction.duration_s
        self._chases_s = _CHASE_S

    def wish(self, dt_s: float, now: ConductSituation) -> Wish:
        """Return the person's change to its script."""
        if self._stands_s <= 0.0 or self._chases_s <= 0.0:
            return Wish(clear_m=_PASSES_M)
        robot = now.robot
        ahead = np.array([math.cos(robot.heading_rad), math.sin(robot.heading_rad)])
        place = robot.position + self._keep_m * ahead
        off_m = math.dist(now.at, place)
        if off_m <= _IN_THE_WAY_M:
            self._stands_s -= dt_s
        if off_m <= _ARRIVED_M:
            return Wish(stands=True, faces=robot.position, gaze_at=robot.position)
        self._chases_s -= dt_s
        if now.is_seated or not now.can_go(place):
            return Wish(gaze_at=robot.position)
        return Wish(goes_to=place, faces=robot.position, gaze_at=robot.position)


class Surprised:
    """Stops and looks at the robot for a while, and goes on."""

    def __init__(self, reaction: Reaction) -> None:
        self._stands_s = reaction.duration_s

    def wish(self, dt_s: float, now: ConductSituation) -> Wish:
        """Return the person's change to its script."""
        if self._stands_s <= 0.0:
            return Wish(clear_m=_PASSES_M)
        self._stands_s -= dt_s
        robot = now.robot.position
        off = math.remainder(math.atan2(*(robot - now.at)[::-1]) - now.heading, math.tau)
        return Wish(stands=True, gaze_at=robot, faces=robot if abs(off) > _NECK_RAD else None)


def _lateral_m(place: Array, now: ConductSituation, keep_m: float) -> float | None:
    """Return a place's offset to the left of the robot's path [m]; None if the robot will not come near."""
    velocity = now.robot.velocity
    speed = float(np.hypot(*velocity))
    if speed < _COMES_M_S:
        return None
    way = place - now.robot.position
    ahead = float(way @ velocity) / speed
    left = float(velocity[0] * way[1] - velocity[1] * way[0]) / speed
    is_coming = -keep_m < ahead < keep_m + speed * _FORESEEN_S
    return left if is_coming and abs(left) < keep_m else None


_GLANCE_EVERY_S: Final = 4.0
_GLANCE_S: Final = 1.2


class Leading:
    """A person who leads the robot along its path."""

    def __init__(self, lead: Lead) -> None:
        self._lead = lead
        self._waited_s: float | None = None
        self._has_given_up = False
        self._walked_s = 0.0

    def wish(self, dt_s: float, now: ConductSituation) -> Wish:
        """Return the person's change to its script; called once per control step of dt_s [s]."""
        robot, gap_m, lead = now.robot.position, now.gap_m, self._lead
        if gap_m <= lead.goes_on_within_m:
            self._waited_s, self._has_given_up = None, False
        elif self._waited_s is None and gap_m > lead.waits_beyond_m and not self._has_given_up:
            self._waited_s = 0.0
        if self._waited_s is not None:
            self._waited_s += dt_s
            if self._waited_s <= lead.at_most_s:
                return Wish(stands=True, faces=robot, gaze_at=robot, calls=True)
            self._waited_s, self._has_given_up = None, True
        self._walked_s += dt_s
        is_glancing = self._walked_s % _GLANCE_EVERY_S > _GLANCE_EVERY_S - _GLANCE_S
        return Wish(gaze_at=robot if is_glancing else None)


# A person's reaction to the robot and to its group, combined at every step.

Point = tuple[float, float]

_EASY_M: Final = 0.4  # a smaller lead over the group is ignored
_WAITS_M: Final = 1.5  # lead over the last of the group at which a person waits


def pace_among(points: Sequence[Point], progress: float, company: Iterable[float]) -> float:
    """Return the share of its planned speed at which a person walks to stay with its group.

    Args:
        points: [m] of the person's own path.
        progress: its progress: waypoints reached, plus the share of the path to the next one.
        company: progress of the others in the group, whose paths have the same number of points.

    Returns:
        1 up to 0.4 m ahead of the last of the group, 0 from 1.5 m on, linear between.
    """
    last = min(company, default=progress)
    ahead_m = _along(points, progress) - _along(points, last)
    return min(max((_WAITS_M - ahead_m) / (_WAITS_M - _EASY_M), 0.0), 1.0)


def _along(points: Sequence[Point], progress: float) -> float:
    """Return the distance along a path [m] of a progress."""
    ways = [0.0, *accumulate(math.dist(a, b) for a, b in pairwise(points))]
    index = min(int(progress), len(ways) - 1)
    if index == len(ways) - 1:
        return ways[-1]
    return ways[index] + (progress - index) * (ways[index + 1] - ways[index])


_CONDUCTS: Final[Mapping[Way, Callable[[Reaction], Conduct]]] = {
    "ignores": lambda _: Ignoring(),
    "makes_way": MakingWay,
    "curious": Curious,
    "wary": Wary,
    "blocks": Blocking,
    "surprised": Surprised,
}


class Mind:
    """Decides how a person changes its script; without a reaction, lead or group it never does.

    Args:
        points: [m] the points of its path.
        reacts: its reaction to the robot, or None.
        leads: how it leads the robot, or None.
    """

    def __init__(self, points: Sequence[Point], reacts: Reaction | None, leads: Lead | None) -> None:
        self._points = tuple(points)
        self._reaction = reacts
        self._leading = None if leads is None else Leading(leads)
        self._encounter = None if reacts is None else Encounter(reacts.begins_m)
        self._conduct: Conduct | None = None

    def wish(
        self, dt_s: float, now: ConductSituation | None, progress: float, company: Iterable[float]
    ) -> Wish:
        """Return the person's change to its script.

        Args:
            dt_s: [s] length of the control step.
            now: state of person and robot; None without a robot.
            progress: progress along its path, as in `pace_among`.
            company: progress of the others in its group.
        """
        wish = AS_PLANNED if now is None else self._take_to_robot(dt_s, now)
        pace = pace_among(self._points, progress, company)
        return wish if pace == 1.0 else replace(wish, pace=pace)

    def _take_to_robot(self, dt_s: float, now: ConductSituation) -> Wish:
        if self._leading is not None:
            return self._leading.wish(dt_s, now)
        if self._reaction is None or self._encounter is None:
            return AS_PLANNED
        if self._reaction.way != "ignores" and not self._encounter.update(now):
            self._conduct = None
            return AS_PLANNED
        if self._conduct is None:
            self._conduct = _CONDUCTS[self._reaction.way](self._reaction)
        return self._conduct.wish(dt_s, now)
