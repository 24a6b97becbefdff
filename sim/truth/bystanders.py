"""Where everybody is, and how much of them a camera could see: told by rays, not from an image."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.people.person import Person
from peopleboy.sim.physics.physics import Physics
from peopleboy.sim.robot.robot_body import NAME
from peopleboy.sim.truth.image_free_truth import Bystander
from peopleboy.sim.truth.upright import free_ray_shares, stand_before

_RAYS = 5


def bystanders(
    people: Sequence[Person], physics: Physics, robot: Planar, world_from_robot: Matrix, camera: Pinhole
) -> tuple[Bystander, ...]:
    """Tell where everybody is who is present, and how much of them the robot's camera could see.

    Args:
        people: in the scenario's order.
        physics: the world, through which rays are cast.
        robot: pose on the floor.
        world_from_robot: (4, 4) the same pose.
        camera: the thermal camera.
    """
    present = [(number, person) for number, person in enumerate(people, 1) if person.present]
    if not present:
        return ()
    places = np.array([person.position for _, person in present])
    heights_m = np.array([person.config.height_m for _, person in present])
    radii_m = np.array([person.radius_m for _, person in present])
    poses = (world_from_robot @ camera.robot_from_camera)[None].repeat(len(present), axis=0)
    uprights = stand_before(places, heights_m, radii_m, camera, poses)
    fraction = np.ones((len(present), _RAYS))
    looked = uprights.reaches_in
    eyes, points = uprights.eyes[looked].repeat(_RAYS, axis=0), uprights.points[looked].reshape(-1, 3)
    fraction[looked] = physics.cast_rays(eyes, points, ignore=NAME)[0].reshape(-1, _RAYS)
    shares = free_ray_shares(uprights, fraction, radii_m)
    return describe(present, robot, uprights.boxes.tolist(), shares.tolist())


def describe(
    present: Sequence[tuple[int, Person]],
    robot: Planar,
    boxes: Sequence[list[float]],
    shares: Sequence[float],
) -> tuple[Bystander, ...]:
    """Put together what is known of people with their numbers; boxes and shares are in their order."""
    return tuple(
        _bystander(number, person, robot, box, share)
        for (number, person), box, share in zip(present, boxes, shares, strict=True)
    )


def _bystander(number: int, person: Person, robot: Planar, box: list[float], share: float) -> Bystander:
    (x, y), (vx, vy) = person.position.tolist(), person.velocity.tolist()
    dx, dy = x - robot.x, y - robot.y
    left, top, width, height = box
    return Bystander(
        id=number,
        name=person.name,
        position_m=(x, y),
        heading_rad=float(person.heading),
        velocity_m_s=(vx, vy),
        height_m=person.config.height_m,
        radius_m=person.radius_m,
        distance_m=math.hypot(dx, dy),
        bearing_rad=math.remainder(math.atan2(dy, dx) - robot.heading, math.tau),
        box=None if math.isnan(left) else (left, top, width, height),
        free_ray_share=share,
    )
