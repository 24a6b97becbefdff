"""Moving things: their actions, and their state at any time."""

import math
from dataclasses import dataclass
from enum import StrEnum
from itertools import product

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.shapes.shapes import Quaternion, Vector

Array = NDArray[np.float64]

_HANDLE_M = 1.0  # height of the handle above the floor, limited to the thing's extent
_BESIDE_M = 0.1  # largest distance from a thing to its hinge
_FROM_EDGE = 0.94  # position of the handle as a share of the distance from the centre of a leaf to its edge
_SAME_S = 1e-9


class ActionKind(StrEnum):
    """The kinds of actions on a thing."""

    APPEAR = "appear"
    VANISH = "vanish"
    GLIDE = "glide"
    TURN = "turn"
    SLIDE = "slide"


LASTING = (ActionKind.GLIDE, ActionKind.TURN, ActionKind.SLIDE)


@dataclass(frozen=True, slots=True)
class Stance:
    """Pose of the frame of a thing.

    Attributes:
        position_m: (x, y, z) [m] world frame; z is the height of its foot.
        heading_rad: [rad] direction of its front.
    """

    position_m: Vector
    heading_rad: float

    @property
    def orientation(self) -> Quaternion:
        """Quaternion x, y, z, w, world from thing."""
        return (0.0, 0.0, math.sin(self.heading_rad / 2.0), math.cos(self.heading_rad / 2.0))

    def place(self, points: Array) -> Array:
        """Map (..., 3) points [m] from the thing's frame to the world frame."""
        return np.asarray(points @ _turned(self.heading_rad).T + np.array(self.position_m))

    def locate(self, points: Array) -> Array:
        """Map (..., 3) points [m] from the world frame to the thing's frame."""
        return np.asarray((points - np.array(self.position_m)) @ _turned(self.heading_rad))

    def turned_about(self, hinge_m: tuple[float, float], angle_rad: float) -> "Stance":
        """Return the pose after a turn about a vertical axis through hinge_m (x, y) [m]."""
        x, y, z = self.position_m
        dx, dy = x - hinge_m[0], y - hinge_m[1]
        c, s = math.cos(angle_rad), math.sin(angle_rad)
        position = (hinge_m[0] + c * dx - s * dy, hinge_m[1] + s * dx + c * dy, z)
        return Stance(position, self.heading_rad + angle_rad)


@dataclass(frozen=True, slots=True, kw_only=True)
class Action:
    """An action on a thing.

    Attributes:
        kind: kind of the action.
        at_s: [s] start.
        takes_s: [s] duration; 0 for `appear` and `vanish`.
        target: pose of the thing at the end.
        hinge_m: (x, y) [m] position of the vertical axis of rotation; None for no rotation.
        by: name of the person who moves it by hand, or None.
    """

    kind: ActionKind
    at_s: float
    target: Stance
    takes_s: float = 0.0
    hinge_m: tuple[float, float] | None = None
    by: str | None = None

    @property
    def ends_s(self) -> float:
        """End of the action [s]."""
        return self.at_s + self.takes_s

    def stance(self, start: Stance, time_s: float) -> Stance:
        """Return the pose at a time during or after the action, for a thing that was at `start` before.

        The motion starts and stops smoothly: after a share u of the time it is at 3 u^2 - 2 u^3 of the path.
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
    """State of a thing at an instant.

    Attributes:
        stance: its current or last pose.
        is_there: whether it is present.
        is_moving: whether it is being moved.
        by: the person who moves it, or moved it last; None for none.
    """

    stance: Stance
    is_there: bool
    is_moving: bool
    by: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Mover:
    """A thing with actions.

    Attributes:
        name: name of the thing; its fixtures have this name, or "name/piece".
        start: its initial pose.
        low_m, high_m: [m] corners of the box around it, in its own frame.
        is_hidden_at_start: whether it is absent at first.
        actions: actions in order of time; none starts before the previous one is over.
    """

    name: str
    start: Stance
    low_m: Vector
    high_m: Vector
    is_hidden_at_start: bool = False
    actions: tuple[Action, ...] = ()

    def corners(self) -> Array:
        """Corners (8, 3) [m] of the box around it, in its own frame."""
        return np.array(list(product(*zip(self.low_m, self.high_m, strict=True))))

    def at(self, time_s: float) -> ThingState:
        """Return the state of the thing at a time [s]."""
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
        """Return the point at which a person holds the thing at a time: (3,) [m] in the world frame.

        It is the edge farthest from the hinge if there is one, the middle of the front for a sliding thing,
        and otherwise the point nearest to the person, at hand height. An axis of rotation outside the
        thing, such as the person who carries it, is not a hinge.

        Args:
            action: the action for which it is held.
            time_s: [s] time; before or after the action, its start or its end counts.
            person: (x, y) [m] position of the person.
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
    """Return the point (2,) near the end of a rectangle's longer side, far from the hinge."""
    middle, longer = (low + high) / 2.0, int(np.argmax(high - low))
    far = low if abs(low[longer] - hinge[longer]) > abs(high[longer] - hinge[longer]) else high
    middle[longer] += _FROM_EDGE * (far[longer] - middle[longer])
    return np.asarray(middle)


def ease(share: float) -> float:
    """Return the share of a path covered after a share of the time, with smooth start and stop."""
    return share * share * (3.0 - 2.0 * share)


def shorter_turn(before_rad: float, after_rad: float) -> float:
    """Return the shorter turn [rad] from one heading to another."""
    return math.remainder(after_rad - before_rad, math.tau)


def _turned(heading: float) -> Array:
    c, s = math.cos(heading), math.sin(heading)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
