"""How the robot stands to the person to follow and to the corridor, and what happens to it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.robot.robot_body import RADIUS_M
from peopleboy.sim.truth.image_free_truth import Bystander, ImageFreeTruth

LOST_S: Final = 10.0
NOBODY_M: Final = 1000.0  # stands for a distance or gap where there is nobody


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    """What the reward is about.

    Attributes:
        target: name of the person to follow; empty if nobody is there.
        sees_target: whether the thermal camera could see the target now.
        distance_m: [m] on the floor to the target.
        bearing_rad: [rad] of the target from the robot's nose.
        gap_m: [m] between the outlines of the robot, a circle, and the nearest person.
        along_m_s: [m/s] speed along the corridor's axis, either way.
        lateral_share: offset from the corridor's centre line in half widths, left positive.
        collided: whether the robot touches anything but the floor.
        is_lost: whether the target was out of sight for 10 s after it had been seen.
    """

    target: str
    sees_target: bool
    distance_m: float
    bearing_rad: float
    gap_m: float
    along_m_s: float
    lateral_share: float
    collided: bool
    is_lost: bool


class Episode:
    """Judges one instant after another: whom to follow, and what happened."""

    def __init__(self, plan: FloorPlan, dt_s: float, *, may_lose: bool) -> None:
        self._plan, self._dt_s, self._may_lose = plan, dt_s, may_lose
        self._unseen_s = 0.0
        self._has_seen = ""
        self._seen: set[str] = set()
        self._touched: set[str] = set()
        self.events: tuple[tuple[str, str], ...] = ()

    def judge(self, scene: ImageFreeTruth) -> Situation:
        """Look at the next instant."""
        target = find_target(scene)
        sees = target is not None and target.is_seen
        self._wait(target, sees)
        along, lateral = corridor_motion(self._plan, scene)
        self.events = self._compare(scene)
        return Situation(
            target="" if target is None else target.name,
            sees_target=sees,
            distance_m=NOBODY_M if target is None else target.distance_m,
            bearing_rad=0.0 if target is None else target.bearing_rad,
            gap_m=min(
                (person.distance_m - person.radius_m - RADIUS_M for person in scene.people), default=NOBODY_M
            ),
            along_m_s=along,
            lateral_share=lateral,
            collided=bool(scene.contacts),
            is_lost=self._may_lose and self._unseen_s >= LOST_S,
        )

    def _wait(self, target: Bystander | None, sees: bool) -> None:
        """Count how long the target has been out of sight; a new target must be found first."""
        if target is None or sees or target.name != self._has_seen:
            self._unseen_s = 0.0
        else:
            self._unseen_s += self._dt_s
        if target is not None and sees:
            self._has_seen = target.name

    def _compare(self, scene: ImageFreeTruth) -> tuple[tuple[str, str], ...]:
        """Give what is new as pairs of what happened, and to or with whom."""
        seen = {person.name for person in scene.people if person.is_seen}
        touched = set(scene.contacts)
        if seen == self._seen and touched == self._touched:
            return ()
        found = [("seen", name) for name in sorted(seen - self._seen)]
        found += [("out of sight", name) for name in sorted(self._seen - seen)]
        found += [("contact", name) for name in sorted(touched - self._touched)]
        self._seen, self._touched = seen, touched
        return tuple(found)


def find_target(scene: ImageFreeTruth) -> Bystander | None:
    """The person to follow: the first in the scenario's order who is present."""
    return scene.people[0] if scene.people else None


def corridor_motion(plan: FloorPlan, scene: ImageFreeTruth) -> tuple[float, float]:
    """Speed [m/s] along the axis of the corridor's leg, and the offset from its middle in half widths.

    At a corner the leg is the one along which the robot rather looks.
    """
    robot, speed = scene.robot, scene.robot_velocity[0]
    motions = []
    for _, area in plan.areas:
        if area.min_x <= robot.x <= area.max_x and area.min_y <= robot.y <= area.max_y:
            width, depth = area.max_x - area.min_x, area.max_y - area.min_y
            aside_x = (robot.x - (area.min_x + area.max_x) / 2.0) / (width / 2.0)
            aside_y = (robot.y - (area.min_y + area.max_y) / 2.0) / (depth / 2.0)
            cos, sin = math.cos(robot.heading), math.sin(robot.heading)
            motions.append((speed * cos, aside_y) if width >= depth else (speed * sin, -aside_x))
    return max(motions, key=lambda motion: abs(motion[0]), default=(0.0, 0.0))
