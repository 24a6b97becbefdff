"""Check moved objects: they must be in reach and may not pass through people, the robot or each other."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from peopleboy.bad_input import BadInput, Key
from peopleboy.scenarios.files.people import PersonSpec
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.walking.walker import ALONE, Walker
from peopleboy.sim.places.extent import BoxSet, boxes_of, overlaps
from peopleboy.sim.places.moving import Action, Mover
from peopleboy.sim.places.place import HEAD_M, STEP_M, Place

REACH_M = 0.75  # on the floor, from a person's centre to the object in the hand, including leaning
_HOLDS_M = 0.08  # clearance from an object that the person moves
_STEP_S = 0.1
_DEEP_M = 0.03  # allowed overlap of objects: feet sink in, and boxes approximate round shapes


@dataclass(frozen=True, slots=True)
class _Spot:
    """A person's position at one instant: x, y [m], and whether the person sits or is about to sit."""

    at: tuple[float, float]
    sits: bool


@dataclass(frozen=True)
class MovedThings:
    """The objects of a place that are moved, and the space that they occupy at each time.

    Attributes:
        place: the place that contains them.
        duration_s: [s] duration of a run.
    """

    place: Place
    duration_s: float
    _boxes: dict[str, BoxSet] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Compute the boxes of the objects once."""
        for mover in self.place.movers:
            own = [f for f in self.place.fixtures if f.name.split("/")[0] == mover.name]
            self._boxes[mover.name] = boxes_of(own, mover.start)

    def fault(self, person: PersonSpec, clearance_m: float) -> BadInput | None:
        """Return the fault of a person's path due to moved objects, with keys below the person's, or None."""
        if not self.place.movers:
            return None
        for time_s, standing in _walk(person, self.duration_s):
            for mover in self.place.movers:
                is_own = person.name in {action.by for action in mover.actions}
                near_m = _HOLDS_M if is_own else clearance_m
                if self._is_in_the_way(mover, standing, time_s, near_m):
                    x, y = standing.at
                    return BadInput(
                        f"at {time_s:.1f} s {person.name!r} is at ({x:.2f}, {y:.2f}), in or within "
                        f"{near_m:g} m of {mover.name!r}, which is there at that time; move one of them",
                        key=("path",),
                    )
        return None

    def check(
        self, people: Sequence[tuple[Key, PersonSpec]], robot: tuple[float, float], robot_m: float
    ) -> None:
        """Refuse moves through the robot's start position or through objects, and moves out of reach.

        Args:
            people: all people, including group members, each with its key in the file.
            robot: x, y [m] of the robot's centre at the start.
            robot_m: [m] radius of the robot.

        Raises:
            BadInput: a move is invalid; the error holds the key of the action.
        """
        held: dict[str, list[tuple[Mover, Action]]] = {}
        for mover in self.place.movers:
            self._check_robot(mover, 0.0, robot, robot_m, _key(self.place, mover))
            for index, action in enumerate(mover.actions):
                key: Key = (*_key(self.place, mover), "actions", index)
                for time_s in _times(action):
                    self._check_robot(mover, time_s, robot, robot_m, key)
                    self._check_things(mover, time_s, key)
                if action.by is not None:
                    actor = next(person for _, person in people if person.name == action.by)
                    _check_hand(mover, action, actor, key)
                    _check_free(mover, action, held.setdefault(action.by, []), key)

    def _is_in_the_way(self, mover: Mover, standing: _Spot, time_s: float, near_m: float) -> bool:
        state = mover.at(time_s)
        if not state.is_there or (standing.sits and mover.name in self.place.seats):
            return False
        boxes = self._boxes[mover.name].moved(state.stance).between(STEP_M, HEAD_M)
        return boxes.distance(standing.at) < near_m

    def _check_robot(
        self, mover: Mover, time_s: float, robot: tuple[float, float], robot_m: float, key: Key
    ) -> None:
        state = mover.at(time_s)
        boxes = self._boxes[mover.name].moved(state.stance).between(STEP_M, HEAD_M)
        if state.is_there and boxes.distance(robot) < robot_m:
            x, y = robot
            raise BadInput(
                f"{mover.name!r} would be in the robot at {time_s:.1f} s, which starts at ({x:g}, {y:g})",
                key=key,
            )

    def _check_things(self, mover: Mover, time_s: float, key: Key) -> None:
        state = mover.at(time_s)
        if not state.is_there:
            return
        own = self._boxes[mover.name].moved(state.stance)
        names, still = self._still
        others = [(np.array(names), still)]
        for other in self.place.movers:
            its = other.at(time_s)
            if other is not mover and its.is_there:
                boxes = self._boxes[other.name].moved(its.stance)
                others.append((np.array([other.name] * len(boxes.centre)), boxes))
        for called, boxes in others:
            hit = overlaps(own, boxes, _DEEP_M).any(axis=0)
            if hit.any():
                what = str(called[hit][0])
                raise BadInput(f"{mover.name!r} would pass through {what!r} at {time_s:.1f} s", key=key)

    @cached_property
    def _still(self) -> tuple[list[str], BoxSet]:
        """Names and boxes of all solid shapes that are never moved, except floor and ceiling."""
        moved = {mover.name for mover in self.place.movers} | {"floor", "ceiling"}
        fixtures = [f for f in self.place.fixtures if f.is_solid and f.name.split("/")[0] not in moved]
        names = [f.name.split("/")[0] for f in fixtures for _ in boxes_of([f]).heading]
        return names, boxes_of(fixtures)


def _check_hand(mover: Mover, action: Action, person: PersonSpec, key: Key) -> None:
    waits = any(waypoint.until_robot_within_m is not None for waypoint in person.path)
    is_moved = person.yields or person.reacts or person.leads or person.group or waits
    if is_moved or person.jitter_m or person.speed_jitter or person.enter_jitter_s:
        raise BadInput(
            f"{person.name!r} must follow an exact script to move {mover.name!r}: "
            "without yields, reacts, leads, group, until_robot_within_m, jitter_m, speed_jitter and "
            "enter_jitter_s",
            key=(*key, "by"),
        )
    ways = dict(_walk(person, action.ends_s + 2.0 * _STEP_S))
    for time_s in _times(action):
        nearest = min(ways, key=lambda t: abs(t - time_s), default=None)
        if nearest is None or abs(nearest - time_s) > _STEP_S:
            raise BadInput(f"{person.name!r} is not present at {time_s:.1f} s", key=(*key, "by"))
        at = ways[nearest].at
        grip = mover.grip(action, time_s, at)
        gap = math.dist(at, grip[:2].tolist())
        if gap > REACH_M:
            raise BadInput(
                f"{person.name!r} is {gap:.2f} m from {mover.name!r} at {time_s:.1f} s, at ({at[0]:.2f}, "
                f"{at[1]:.2f}); must be within {REACH_M:g} m",
                key=(*key, "by"),
            )


def _key(place: Place, mover: Mover) -> Key:
    """Return the key of an object in the scenario file."""
    return ("things", place.things.index(mover.name))


def _check_free(mover: Mover, action: Action, before: list[tuple[Mover, Action]], key: Key) -> None:
    """Refuse an action by a person who moves another object at that time."""
    for other, busy in before:
        if other is not mover and action.at_s < busy.ends_s and busy.at_s < action.ends_s:
            raise BadInput(
                f"{action.by!r} moves {other.name!r} from {busy.at_s:g} to {busy.ends_s:g} s; "
                "a person can move only one object at a time",
                key=(*key, "by"),
            )
    before.append((mover, action))


def _times(action: Action) -> list[float]:
    steps = max(math.ceil(action.takes_s / _STEP_S), 1)
    return [action.at_s + action.takes_s * step / steps for step in range(steps + 1)]


def _walk(person: PersonSpec, until_s: float) -> list[tuple[float, _Spot]]:
    """Return the positions of an undisturbed person, at intervals of 0.1 s."""
    path = person.path
    walker = Walker(path, yields=False, radius_m=0.0)
    end = until_s if person.leave_s is None else min(until_s, person.leave_s)
    found, time_s = [], person.enter_s
    while time_s < end:
        ahead = path[walker.reached : walker.reached + 2]
        sits = any(
            w.posture is Posture.SITTING and math.dist(w.at_m, walker.position.tolist()) < 1.0 for w in ahead
        )
        x, y = walker.position.tolist()
        found.append((time_s, _Spot((x, y), sits)))
        walker.step(_STEP_S, ALONE)
        time_s += _STEP_S
    return found
