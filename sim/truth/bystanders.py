"""Where everybody is, and how much of them a camera could see: told by rays, not from an image."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose, transform
from peopleboy.sim.people.person import Person
from peopleboy.sim.physics.physics import Physics
from peopleboy.sim.robot.robot_body import NAME
from peopleboy.sim.truth.boxes import Box, reaches_into
from peopleboy.sim.truth.image_free_truth import Bystander

# Heights at which a person's middle is looked for, in shares of the stature.
_LOOKED_AT = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
_NEAREST_M = 0.05


def bystanders(
    people: Sequence[Person], physics: Physics, world_from_robot: Matrix, camera: Pinhole
) -> tuple[Bystander, ...]:
    """Tell where everybody is who is present, and how much of them the robot's camera could see.

    Args:
        people: in the scenario's order.
        physics: the world, through which rays are cast.
        world_from_robot: (4, 4).
        camera: the thermal camera.
    """
    world_from_camera = world_from_robot @ camera.robot_from_camera
    heading = math.atan2(world_from_robot[1, 0], world_from_robot[0, 0])
    return tuple(
        _bystander(number, person, physics, world_from_robot[:2, 3], heading, camera, world_from_camera)
        for number, person in enumerate(people, 1)
        if person.present
    )


def _bystander(
    number: int,
    person: Person,
    physics: Physics,
    robot: Matrix,
    heading: float,
    camera: Pinhole,
    pose: Matrix,
) -> Bystander:
    (x, y), (vx, vy) = person.position.tolist(), person.velocity.tolist()
    dx, dy = x - float(robot[0]), y - float(robot[1])
    box = _upright_box(person, camera, pose)
    is_inside = box is not None and reaches_into(box, camera)
    return Bystander(
        id=number,
        name=person.name,
        position_m=(x, y),
        heading_rad=float(person.heading),
        velocity_m_s=(vx, vy),
        height_m=person.config.height_m,
        radius_m=person.radius_m,
        distance_m=math.hypot(dx, dy),
        bearing_rad=math.remainder(math.atan2(dy, dx) - heading, math.tau),
        box=box,
        free_ray_share=_free_ray_share(person, physics, camera, pose) if is_inside else 0.0,
    )


def _upright_box(person: Person, camera: Pinhole, world_from_camera: Matrix) -> Box | None:
    """Head to feet, and the body's width to either side of its middle."""
    x, y = person.position.tolist()
    height = person.config.height_m
    ends = np.array([[x, y, height], [x, y, 0.0], [x, y, height / 2.0]])
    points = transform(invert_pose(world_from_camera), ends)
    if points[:, 2].min() < _NEAREST_M:
        return None
    (_, top), (_, bottom), (middle, _) = camera.project(points).tolist()
    half = camera.focal_px * person.radius_m / float(points[2, 2])
    return middle - half, top, 2.0 * half, bottom - top


def _free_ray_share(person: Person, physics: Physics, camera: Pinhole, world_from_camera: Matrix) -> float:
    x, y = person.position.tolist()
    points = np.array([[x, y, share * person.config.height_m] for share in _LOOKED_AT])
    u, v = camera.project(transform(invert_pose(world_from_camera), points)).T
    is_inside = (u > -0.5) & (u < camera.width - 0.5) & (v > -0.5) & (v < camera.height - 0.5)
    eye = np.tile(world_from_camera[:3, 3], (len(points), 1))
    fraction, _ = physics.cast_rays(eye, points, ignore=NAME)
    # A ray ends within the person's own capsule, which it meets a radius before.
    short = np.linalg.norm(points - eye, axis=1) * (1.0 - fraction)
    is_free = short <= 1.5 * person.radius_m
    return float(np.mean(is_inside & is_free))
