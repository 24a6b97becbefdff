"""List the contacts of a run: what the robot touched, how fast, and who caused it."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from peopleboy.sim.robot.robot_body import RADIUS_M, nearest_on_outline
from peopleboy.sim.truth.events import CONTACT_ENDS_S
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.sim.truth.truth import Truth

AT_REST_M_S = 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """A contact of the robot, by the speeds just before it.

    Attributes:
        time_s: [s] when it began.
        other: name of the person or thing.
        robot_m_s: [m/s] speed of the robot's hull towards the other: that of a turning hull is at its corner.
        relative_m_s: [m/s] speed at which the two approached each other.
        cause: "robot", or "person" if the person approached faster than the robot did, or the robot was at
            rest; a thing that moves into a robot at rest is moved by a person.
    """

    time_s: float
    other: str
    robot_m_s: float
    relative_m_s: float
    cause: str

    def to_json(self) -> dict[str, Any]:
        """Return it as an object of metrics.json."""
        return asdict(self)


class ContactLog:
    """Collects contacts, instant by instant; bouncing, or rubbing along a wall, is one contact."""

    def __init__(self) -> None:
        self._before: Truth | ImageFreeTruth | None = None
        self._touched_s: dict[str, float] = {}
        self.contacts: list[Contact] = []

    def add(self, truth: Truth | ImageFreeTruth) -> None:
        """Add the next instant."""
        before = truth if self._before is None else self._before
        for name in truth.contacts:
            if truth.time_s - self._touched_s.get(name, -math.inf) >= CONTACT_ENDS_S:
                self.contacts.append(_contact(name, truth.time_s, before))
            self._touched_s[name] = truth.time_s
        self._before = truth


def _contact(name: str, time_s: float, before: Truth | ImageFreeTruth) -> Contact:
    """Return the contact with a body, from the instant before it."""
    linear_m_s, angular_rad_s = before.robot_velocity
    person = next((person for person in before.people if person.name == name), None)
    if person is None:
        robot_m_s = relative_m_s = math.hypot(linear_m_s, RADIUS_M * angular_rad_s)
        by_person = 0.0
    else:
        x, y = before.robot.to_local(person.position_m)
        hull_x, hull_y = nearest_on_outline((x, y))
        towards = np.array([x - hull_x, y - hull_y])  # robot frame
        towards /= max(float(np.hypot(*towards)), 1e-9)
        robot_m_s = float(towards @ (linear_m_s - angular_rad_s * hull_y, angular_rad_s * hull_x))
        cos, sin = math.cos(before.robot.heading), math.sin(before.robot.heading)
        velocity = np.array([[cos, sin], [-sin, cos]]) @ person.velocity_m_s
        by_person = -float(towards @ velocity)
        relative_m_s = robot_m_s + by_person
    is_robots = robot_m_s > AT_REST_M_S and robot_m_s >= by_person
    return Contact(
        time_s=time_s,
        other=name,
        robot_m_s=round(robot_m_s, 3),
        relative_m_s=round(relative_m_s, 3),
        cause="robot" if is_robots else "person",
    )
