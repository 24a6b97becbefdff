"""Where everybody is, and how much of them a camera could see: told by rays, not from an image."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.people.person import Person
from peopleboy.sim.physics.physics import Physics
from peopleboy.sim.robot.robot_body import NAME
from peopleboy.sim.truth.scenes import BYSTANDER, Records
from peopleboy.sim.truth.upright import Uprights, free_ray_shares, stand_before

_RAYS = 5


def bystanders(
    people: Sequence[Person], physics: Physics, robot: Matrix, world_from_robot: Matrix, camera: Pinhole
) -> Records:
    """Tell where everybody is who is present, and how much of them the robot's camera could see.

    Args:
        people: in the scenario's order.
        physics: the world, through which rays are cast.
        robot: (3,) [m, m, rad] pose on the floor.
        world_from_robot: (4, 4) the same pose.
        camera: the thermal camera.

    Returns:
        (Q,) records BYSTANDER.
    """
    present = [(number, person) for number, person in enumerate(people, 1) if person.present]
    found = np.zeros(len(present), BYSTANDER)
    if not present:
        return found
    found["id"] = [number for number, _ in present]
    for name, values in (
        ("position_m", [person.position for _, person in present]),
        ("velocity_m_s", [person.velocity for _, person in present]),
        ("heading_rad", [person.heading for _, person in present]),
        ("height_m", [person.config.height_m for _, person in present]),
        ("radius_m", [person.radius_m for _, person in present]),
    ):
        found[name] = values
    poses = (world_from_robot @ camera.robot_from_camera)[None].repeat(len(present), axis=0)
    uprights = stand_before(found["position_m"], found["height_m"], found["radius_m"], camera, poses)
    fraction = np.ones((len(present), _RAYS))
    looked = uprights.reaches_in
    eyes, points = uprights.eyes[looked].repeat(_RAYS, axis=0), uprights.points[looked].reshape(-1, 3)
    fraction[looked] = physics.cast_rays(eyes, points, ignore=NAME)[0].reshape(-1, _RAYS)
    look_at(found, robot[None], uprights, fraction)
    return found


def look_at(people: Records, robots: Matrix, uprights: Uprights, fraction: Matrix) -> None:
    """Note how robots see people.

    Args:
        people: (Q,) records BYSTANDER, of which the last four fields are filled.
        robots: (Q, 3) or (1, 3) [m, m, rad] where they look from.
        uprights: the people before their cameras.
        fraction: (Q, 5) as in `free_ray_shares`.
    """
    gaps = people["position_m"] - robots[:, :2]
    across, up = gaps[:, 0].tolist(), gaps[:, 1].tolist()
    people["distance_m"] = list(map(math.hypot, across, up))
    bearings = np.array(list(map(math.atan2, up, across))) - robots[:, 2]
    people["bearing_rad"] = [math.remainder(bearing, math.tau) for bearing in bearings.tolist()]
    people["box"] = uprights.boxes
    people["free_ray_share"] = free_ray_shares(uprights, fraction, people["radius_m"])
