"""A place of a script: where to go, and what to do there."""

from __future__ import annotations

from dataclasses import dataclass

from peopleboy.sim.people.body.postures import Posture


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
