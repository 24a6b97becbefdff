"""Things that are moved: where a thing is at a time, and what happens to it then."""

import math
from dataclasses import dataclass
from enum import StrEnum
from itertools import product

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.shapes.shapes import Quaternion, Vector

Array = NDArray[np.float64]

_HANDLE_M = 1.0  # above the floor, as near as the thing has it
_BESIDE_M = 0.1  # from a thing to its hinge
_FROM_EDGE = 0.94  # of the way from the middle of a leaf to its edge is its handle
_SAME_S = 1e-9


class ActionKind(StrEnum):
    """What may happen to a thing."""

    APPEAR = "appear"
    VANISH = "vanish"
    GLIDE = "glide"
    TURN = "turn"
    SLIDE = "slide"


LASTING = (ActionKind.GLIDE, ActionKind.TURN, ActionKind.SLIDE)


@dataclass(frozen=True, slots=True)
class Stance:
    """Where the frame of a thing is.

    Attributes:
        position_m: (x, y, z) [m] world frame; z is the height of its foot.
        heading_rad: [rad] where its front looks.
    """

    position_m: Vector
    heading_rad: float

    @property
    def orientation(self) -> Quaternion:
        """World from thing: x, y, z, w."""
        return (0.0, 0.0, math.sin(self.heading_rad / 2.0), math.cos(self.heading_rad / 2.0))

    def place(self, points: Array) -> Array:
        """(..., 3) [m] points of the thing's frame, in the world frame."""
        return np.asarray(points @ _turned(self.heading_rad).T + np.array(self.position_m))

    def locate(self, points: Array) -> Array:
        """(..., 3) [m] points of the world frame, in the thing's frame."""
        return np.asarray((points - np.array(self.position_m)) @ _turned(self.heading_rad))

    def turned_about(self, hinge_m: tuple[float, float], angle_rad: float) -> "Stance":
        """The stance after a turn about an upright axis through hinge_m (x, y) [m]."""
        x, y, z = self.position_m
        dx, dy = x - hinge_m[0], y - hinge_m[1]
        c, s = math.cos(angle_rad), math.sin(angle_rad)
        position = (hinge_m[0] + c * dx - s * dy, hinge_m[1] + s * dx + c * dy, z)
        return Stance(position, self.heading_rad + angle_rad)


@dataclass(frozen=True, slots=True, kw_only=True)
class Action:
    """Something that happens to a thing.

    Attributes:
        kind: what.
        at_s: [s] when it begins.
        takes_s: [s] how long it lasts; 0 of what appears or vanishes.
        target: where the thing is at its end.
        hinge_m: (x, y) [m] of the upright axis that it turns about; None if it does not turn.
        by: name of the person whose hand does it; None for nobody.
    """

    kind: ActionKind
    at_s: float
    target: Stance
    takes_s: float = 0.0
    hinge_m: tuple[float, float] | None = None
    by: str | None = None

    @property
    def ends_s(self) -> float:
        """[s] when it is over."""
        return self.at_s + self.takes_s

    def stance(self, start: Stance, time_s: float) -> Stance:
        """Where a thing that was at `start` before is at a time while or after this happens.

        It starts and stops gently: after a share u of the time it has gone 3 u^2 - 2 u^3 of the way.
        """
        if self.kind not in LASTING or time_s >= self.ends_s - _SAME_S:
            return self.target
        share = ease((time_s - self.at_s) / self.takes_s)
        turn = share * shorter_turn(start.heading_rad, self.target.heading_rad)
        if self.hinge_m is not None:
            return start.turned_about(self.hinge_m, turn)
        x, y, z = (a + share * (b - a) for a, b in zip(start.position_m, self.target.position_m, strict=True))
        return Stance((x, y, z), start.heading_rad + turn)


@dataclass(frozen=True, slots=True)
class ThingState:
    """A thing at an instant.

    Attributes:
        stance: where it is, or was last.
        is_there: whether it is to be seen.
        is_moving: whether something moves it.
        by: the person who moves it, or did last; None for nobody.
    """

    stance: Stance
    is_there: bool
    is_moving: bool
    by: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Mover:
    """A thing to which something happens.

    Attributes:
        name: of the thing; its fixtures are called so, or "name/piece".
        start: where it is at first.
        low_m, high_m: [m] corners of the box around it, in its own frame.
        is_hidden_at_start: whether it is not there yet.
        actions: in the order of time; none begins before the one before it is over.
    """

    name: str
    start: Stance
    low_m: Vector
    high_m: Vector
    is_hidden_at_start: bool = False
    actions: tuple[Action, ...] = ()

    def corners(self) -> Array:
        """(8, 3) [m] corners of the box around it, in its own frame."""
        return np.array(list(product(*zip(self.low_m, self.high_m, strict=True))))

    def at(self, time_s: float) -> ThingState:
        """Return where the thing is at a time [s]; it depends on nothing else."""
        stance, is_there, by = self.start, not self.is_hidden_at_start, None
        for action in self.actions:
            if time_s < action.at_s - _SAME_S:
                break
            is_there, by = action.kind is not ActionKind.VANISH, action.by
            if time_s < action.ends_s - _SAME_S:
                return ThingState(action.stance(stance, time_s), is_there, is_moving=True, by=by)
            stance = action.target
        return ThingState(stance, is_there, is_moving=False, by=by)

    def grip(self, action: Action, time_s: float, person: tuple[float, float]) -> Array:
        """Where a person holds the thing at a time: (3,) [m] in the world frame.

        It is the edge farthest from the hinge of what has one, the middle of the front of what slides, and
        of anything else the point nearest to the person, as far up as a hand is. A thing that is turned about
        an axis beside it, as about who carries it, has no hinge.

        Args:
            action: for which it is held.
            time_s: [s]; outside the action, where it is held at its beginning or its end.
            person: (x, y) [m] where the person stands.
        """
        stance = self.at(min(max(time_s, action.at_s), action.ends_s)).stance
        low, high = np.array(self.low_m), np.array(self.high_m)
        height = min(max(_HANDLE_M, stance.position_m[2] + low[2]), stance.position_m[2] + high[2])
        hand = stance.locate(np.array([*person, height]))
        if action.kind is ActionKind.SLIDE:
            hand = np.array([high[0], (low[1] + high[1]) / 2.0, (low[2] + high[2]) / 2.0])
        elif action.hinge_m is not None:
            hinge = stance.locate(np.array([*action.hinge_m, height]))[:2]
            if np.all((hinge > low[:2] - _BESIDE_M) & (hinge < high[:2] + _BESIDE_M)):
                hand[:2] = _handle(low[:2], high[:2], hinge)
        return stance.place(np.clip(hand, low, high))


def _handle(low: Array, high: Array, hinge: Array) -> Array:
    """(2,) near the end of the longer side of a rectangle, far from the hinge."""
    middle, longer = (low + high) / 2.0, int(np.argmax(high - low))
    far = low if abs(low[longer] - hinge[longer]) > abs(high[longer] - hinge[longer]) else high
    middle[longer] += _FROM_EDGE * (far[longer] - middle[longer])
    return np.asarray(middle)


def ease(share: float) -> float:
    """How far something has gone after a share of its time, if it starts and stops gently."""
    return share * share * (3.0 - 2.0 * share)


def shorter_turn(before_rad: float, after_rad: float) -> float:
    """The turn [rad] from one heading to another, the shorter way round."""
    return math.remainder(after_rad - before_rad, math.tau)


def _turned(heading: float) -> Array:
    c, s = math.cos(heading), math.sin(heading)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
