"""What people do while they have met the robot, a class for each way to take to it.

Every one has `wish(dt_s, now)`, asked once a control step of dt_s [s] as long as an encounter lasts, and is
made anew for the next encounter.
"""

from __future__ import annotations

import math
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.reacting.encounter import Situation
from peopleboy.sim.people.reacting.reaction import Reaction
from peopleboy.sim.people.walking.wish import Wish

Array = NDArray[np.float64]

_COMES_M_S: Final = 0.05  # a slower robot stands
_FORESEEN_S: Final = 4.0  # who stands steps aside for a robot that comes so soon
_SPARE_M: Final = 0.3  # more than is to be kept, so that one step is enough
_RETREAT_M: Final = 1.2  # more than is to be kept, to be left alone for a while
_ARRIVED_M: Final = 0.3
_IN_THE_WAY_M: Final = 0.6  # within which of the place to be one is in the robot's way
_CHASE_S: Final = 15.0  # after which a robot that is not reached is let go
_PASSES_M: Final = 0.9  # from the robot's middle, where it is in the way of who goes on
_NECK_RAD: Final = math.radians(70.0)  # who looks farther round turns the body, too
_WAYS_OUT_RAD: Final = tuple(math.radians(side * off) for off in (0.0, 30.0, 60.0, 90.0) for side in (1, -1))


class Conduct(Protocol):
    """What a person does during one encounter with the robot."""

    def wish(self, dt_s: float, now: Situation) -> Wish:
        """Tell what the person would rather do than its script."""
        ...


class Ignoring:
    """Neither looks nor makes way; stops only where it would walk into the robot."""

    def wish(self, dt_s: float, now: Situation) -> Wish:  # noqa: ARG002
        """Tell what the person would rather do than its script."""
        return Wish(heeds_robot=False)


class MakingWay:
    """Walks round the robot in good time, steps aside for one that comes, and looks at it."""

    def __init__(self, reaction: Reaction) -> None:
        self._keep_m = reaction.keep_m
        self._aside: Array | None = None

    def wish(self, dt_s: float, now: Situation) -> Wish:  # noqa: ARG002
        """Tell what the person would rather do than its script."""
        robot = now.robot.position
        if now.is_walking or now.is_seated:
            return Wish(clear_m=self._keep_m, looks_at=robot)
        place = now.at if now.home is None else now.home
        is_coming = _lateral_m(place, now, self._keep_m + _SPARE_M) is not None
        if is_coming and self._aside is None:
            self._aside = self._place_aside(now)
        if not is_coming:
            self._aside = None
            return Wish(clear_m=self._keep_m, looks_at=robot)
        return Wish(clear_m=self._keep_m, looks_at=robot, goes_to=self._aside, stands=True, faces=robot)

    def _place_aside(self, now: Situation) -> Array | None:
        """Where to stand so that the robot passes, on the nearer side of its way if there is room."""
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
    """Keeps clear of the robot, walks away from one that comes nearer, and looks back at it."""

    def __init__(self, reaction: Reaction) -> None:
        self._keep_m = reaction.keep_m
        self._refuge: Array | None = None

    def wish(self, dt_s: float, now: Situation) -> Wish:  # noqa: ARG002
        """Tell what the person would rather do than its script."""
        robot = now.robot.position
        if now.is_seated or (now.is_walking and now.gap_m > self._keep_m):
            self._refuge = None
            return Wish(clear_m=self._keep_m, looks_at=robot)
        if self._refuge is not None and math.dist(now.at, self._refuge) < _ARRIVED_M:
            self._refuge = None
        is_near = now.gap_m < self._keep_m + _SPARE_M
        if is_near and (self._refuge is None or math.dist(self._refuge, robot) < self._keep_m):
            self._refuge = self._place_away(now)
        if self._refuge is not None:
            return Wish(clear_m=self._keep_m, looks_at=robot, goes_to=self._refuge)
        stays = now.home is not None and math.dist(now.home, robot) < self._keep_m + _SPARE_M
        return Wish(clear_m=self._keep_m, looks_at=robot, stands=stays, faces=robot if stays else None)

    def _place_away(self, now: Situation) -> Array | None:
        """Where to be clear of the robot again: straight away from it, or as far aside as walls demand."""
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
        self._keep_m = reaction.keep_m
        self._looks_s = reaction.lasts_s
        self._chases_s = _CHASE_S

    def wish(self, dt_s: float, now: Situation) -> Wish:
        """Tell what the person would rather do than its script."""
        if self._looks_s <= 0.0 or self._chases_s <= 0.0:
            return Wish(clear_m=_PASSES_M)
        robot = now.robot.position
        if now.gap_m <= self._keep_m + _ARRIVED_M:
            self._looks_s -= dt_s
            return Wish(stands=True, faces=robot, looks_at=robot)
        self._chases_s -= dt_s
        place = robot + self._keep_m * now.away
        if now.is_seated or not now.can_go(place):
            return Wish(looks_at=robot)
        return Wish(goes_to=place, faces=robot, looks_at=robot)


class Blocking:
    """Steps into the robot's way, stands before it for a while, and goes on."""

    def __init__(self, reaction: Reaction) -> None:
        self._keep_m = reaction.keep_m
        self._stands_s = reaction.lasts_s
        self._chases_s = _CHASE_S

    def wish(self, dt_s: float, now: Situation) -> Wish:
        """Tell what the person would rather do than its script."""
        if self._stands_s <= 0.0 or self._chases_s <= 0.0:
            return Wish(clear_m=_PASSES_M)
        robot = now.robot
        ahead = np.array([math.cos(robot.heading_rad), math.sin(robot.heading_rad)])
        place = robot.position + self._keep_m * ahead
        off_m = math.dist(now.at, place)
        if off_m <= _IN_THE_WAY_M:
            self._stands_s -= dt_s
        if off_m <= _ARRIVED_M:
            return Wish(stands=True, faces=robot.position, looks_at=robot.position)
        self._chases_s -= dt_s
        if now.is_seated or not now.can_go(place):
            return Wish(looks_at=robot.position)
        return Wish(goes_to=place, faces=robot.position, looks_at=robot.position)


class Surprised:
    """Stops and looks at the robot for a while, and goes on."""

    def __init__(self, reaction: Reaction) -> None:
        self._stands_s = reaction.lasts_s

    def wish(self, dt_s: float, now: Situation) -> Wish:
        """Tell what the person would rather do than its script."""
        if self._stands_s <= 0.0:
            return Wish(clear_m=_PASSES_M)
        self._stands_s -= dt_s
        robot = now.robot.position
        off = math.remainder(math.atan2(*(robot - now.at)[::-1]) - now.heading, math.tau)
        return Wish(stands=True, looks_at=robot, faces=robot if abs(off) > _NECK_RAD else None)


def _lateral_m(place: Array, now: Situation, keep_m: float) -> float | None:
    """How far to the left [m] of the robot's way a place is; None if it does not come there soon and near."""
    velocity = now.robot.velocity
    speed = float(np.hypot(*velocity))
    if speed < _COMES_M_S:
        return None
    way = place - now.robot.position
    ahead = float(way @ velocity) / speed
    left = float(velocity[0] * way[1] - velocity[1] * way[0]) / speed
    is_coming = -keep_m < ahead < keep_m + speed * _FORESEEN_S
    return left if is_coming and abs(left) < keep_m else None
