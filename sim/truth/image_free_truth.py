"""Where robot and people are and who could see whom: the truth as far as no image is needed for it."""

from __future__ import annotations

from typing import NamedTuple

from peopleboy.sim.geometry.planar import Planar
from peopleboy.sim.truth.boxes import Box
from peopleboy.sim.truth.seen import is_seen


class Bystander(NamedTuple):
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
        free_ray_share: share of five points up the body's middle that are inside the thermal image with
            nothing solid before them; `peopleboy.sim.truth.seen` has how near that is to the share of pixels.
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
    free_ray_share: float

    @property
    def is_seen(self) -> bool:
        """Whether the thermal camera would see enough of the person."""
        return is_seen(self.free_ray_share)


class ImageFreeTruth(NamedTuple):
    """The truth about one instant without images.

    Attributes:
        time_s: [s] since the start.
        robot: true pose of the robot.
        robot_velocity: true forward speed [m/s] and turn rate [rad/s].
        contacts: names of what the robot touches, the floor aside.
        people: everybody who is present, in the scenario's order.
    """

    time_s: float
    robot: Planar
    robot_velocity: tuple[float, float]
    contacts: tuple[str, ...]
    people: tuple[Bystander, ...]
