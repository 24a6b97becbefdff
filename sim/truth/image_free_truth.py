"""Where robot and people are and who could see whom: the truth as far as no image is needed for it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from peopleboy.sim.geometry.pinhole import Camera, Matrix, invert_pose, transform
from peopleboy.sim.people.person import Person
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.robot.peoplebot import NAME, Planar
from peopleboy.sim.truth.truth import Box

# Heights at which a person's middle is looked for, in shares of the stature.
_LOOKED_AT = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
_NEAREST_M = 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class Bystander:
    """One person who is present, seen or not.

    Attributes:
        id: 1, 2, ... in the scenario's order.
        name: as in the scenario.
        position_m: (x, y) on the floor, world frame.
        heading_rad: [rad] where the body faces, world frame.
        velocity_m_s: (x, y) [m/s] world frame.
        height_m, radius_m: [m] of the upright body that stands for the person in contacts and sonar.
        distance_m: [m] on the floor from the robot's origin.
        bearing_rad: [rad] from the robot's nose, positive to the left.
        box: left, top, width, height [px] of that upright body in the thermal image, whatever the posture, as
            if nothing hid it; None when it is not before the camera.
        visible_share: share of five points up the body's middle that are inside the thermal image with
            nothing solid before them.
    """

    id: int
    name: str
    position_m: tuple[float, float]
    heading_rad: float
    velocity_m_s: tuple[float, float]
    height_m: float
    radius_m: float
    distance_m: float
    bearing_rad: float
    box: Box | None
    visible_share: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ImageFreeTruth:
    """The truth about one instant without images.

    Attributes:
        time_s: [s] since the start.
        robot: true pose of the robot.
        robot_velocity: true forward speed [m/s] and turn rate [rad/s].
        contacts: names of what the robot touches, the floor aside.
        people: everybody who is present.
    """

    time_s: float
    robot: Planar
    robot_velocity: tuple[float, float]
    contacts: tuple[str, ...]
    people: tuple[Bystander, ...]


def bystanders(
    people: Sequence[Person], bullet: Bullet, world_from_robot: Matrix, camera: Camera
) -> tuple[Bystander, ...]:
    """Tell where everybody is who is present, and how much of them the robot's camera could see.

    Args:
        people: in the scenario's order.
        bullet: the world, through which rays are cast.
        world_from_robot: (4, 4).
        camera: the thermal camera.
    """
    world_from_camera = world_from_robot @ camera.robot_from_camera
    heading = math.atan2(world_from_robot[1, 0], world_from_robot[0, 0])
    return tuple(
        _bystander(number, person, bullet, world_from_robot[:2, 3], heading, camera, world_from_camera)
        for number, person in enumerate(people, 1)
        if person.present
    )


def _bystander(
    number: int, person: Person, bullet: Bullet, robot: Matrix, heading: float, camera: Camera, pose: Matrix
) -> Bystander:
    (x, y), (vx, vy) = person.position.tolist(), person.velocity.tolist()
    dx, dy = x - float(robot[0]), y - float(robot[1])
    box = _upright_box(person, camera, pose)
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
        visible_share=_visible_share(person, bullet, camera, pose) if _is_inside(box, camera) else 0.0,
    )


def _upright_box(person: Person, camera: Camera, world_from_camera: Matrix) -> Box | None:
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


def _is_inside(box: Box | None, camera: Camera) -> bool:
    """Whether any of a box lies in the image."""
    if box is None:
        return False
    left, top, width, height = box
    return left + width > -0.5 and left < camera.width and top + height > -0.5 and top < camera.height


def _visible_share(person: Person, bullet: Bullet, camera: Camera, world_from_camera: Matrix) -> float:
    x, y = person.position.tolist()
    points = np.array([[x, y, share * person.config.height_m] for share in _LOOKED_AT])
    u, v = camera.project(transform(invert_pose(world_from_camera), points)).T
    is_inside = (u > -0.5) & (u < camera.width - 0.5) & (v > -0.5) & (v < camera.height - 0.5)
    eye = np.tile(world_from_camera[:3, 3], (len(points), 1))
    fraction, _ = bullet.cast_rays(eye, points, ignore=NAME)
    # A ray ends within the person's own capsule, which it meets a radius before.
    short = np.linalg.norm(points - eye, axis=1) * (1.0 - fraction)
    is_free = short <= 1.5 * person.radius_m
    return float(np.mean(is_inside & is_free))
