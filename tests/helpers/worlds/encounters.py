"""People who meet a robot that drives as it is told, without any world around them."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.body.skeleton import JOINT_NAMES
from peopleboy.sim.people.person import Person
from peopleboy.sim.people.walking.social_force import PlanarState
from peopleboy.sim.people.walking.walker import NO_WALKERS
from tests.helpers.worlds.walkers import NO_WALLS

Array = NDArray[np.float64]
RATE_HZ = 15


class Meeting(NamedTuple):
    """What happened, one row for each fifteenth of a second.

    Attributes:
        at: (T, 2) [m] where the person was.
        robot: (T, 2) [m] where the robot was.
        speed: (T,) [m/s] of the person.
        off: (T,) [rad] between the direction in which the person's nose points and that to the robot.
        ahead: (T,) [rad] between the directions of nose and body, positive left.
        posture: T names.
    """

    at: Array
    robot: Array
    speed: Array
    off: Array
    ahead: Array
    posture: list[str]

    @property
    def gap(self) -> Array:
        """(T,) [m] between the middles of both."""
        gaps: Array = np.linalg.norm(self.at - self.robot, axis=1)
        return gaps


def drive(
    start: Sequence[float], velocity: Sequence[float], stop_s: float = np.inf
) -> Callable[[float], Array]:
    """A robot's place at a time, on a straight way until it stops."""
    return lambda time_s: np.array(start) + min(time_s, stop_s) * np.array(velocity)


def meet(person: Person, way: Callable[[float], Array], seconds: float, walls: Array = NO_WALLS) -> Meeting:
    """Let a person meet a robot that drives along a way, its front ahead."""
    rows, postures = [], []
    heading = 0.0
    for k in range(round(seconds * RATE_HZ)):
        time_s = k / RATE_HZ
        place, velocity = way(time_s), (way(time_s + 1e-3) - way(time_s)) / 1e-3
        if np.hypot(*velocity) > 1e-6:
            heading = float(np.arctan2(velocity[1], velocity[0]))
        state = PlanarState(position=place, velocity=velocity, radius_m=0.355, heading_rad=heading)
        person.step(time_s, 1.0 / RATE_HZ, NO_WALKERS, state, walls)
        gaze = gaze_of(person)
        x, y = place - person.position
        rows.append(
            (
                *(*person.position, *place, np.hypot(*person.velocity)),
                *(_apart(np.arctan2(y, x), gaze), _apart(gaze, person.heading)),
            )
        )
        postures.append(str(person.posture))
    table = np.array(rows)
    return Meeting(table[:, :2], table[:, 2:4], table[:, 4], np.abs(table[:, 5]), table[:, 6], postures)


def gaze_of(person: Person) -> float:
    """The direction [rad] in which a person's nose points on the floor: from between the ears."""
    joints = person.joints()
    nose, ears = (
        joints[JOINT_NAMES.index("nose")],
        joints[[JOINT_NAMES.index(f"{s}_ear") for s in ("left", "right")]],
    )
    x, y, _ = nose - ears.mean(axis=0)
    return float(np.arctan2(y, x))


def _apart(one: float, other: float) -> float:
    return float(np.remainder(one - other + np.pi, 2.0 * np.pi) - np.pi)
