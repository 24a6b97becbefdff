"""The robot's body: the file that describes it, its wheels, its outline on the floor."""

from __future__ import annotations

import math
from pathlib import Path

from peopleboy.sim.geometry.planar import Planar

NAME = "robot"
URDF = Path(__file__).with_name("peoplebot.urdf")

WHEEL_RADIUS_M = 0.0825
WHEEL_DISTANCE_M = 0.333
RADIUS_M = 0.355  # of the circle about the middle between the wheels in which the robot turns on the spot
# The body's rear and front ends and its half width [m], about the same middle.
_REAR_M, _FRONT_M, _HALF_WIDTH_M = -0.30, 0.21, 0.19


def wheel_speeds(linear: float, angular: float) -> tuple[float, float]:
    """Return the rim speeds [m/s] of the left and right wheel that give a robot's velocity [m/s, rad/s]."""
    half = angular * WHEEL_DISTANCE_M / 2.0
    return linear - half, linear + half


def outline_gap(pose: Planar, point_m: tuple[float, float]) -> float:
    """Distance [m] on the floor between the outline of a robot at a pose and a point; 0 inside."""
    cos, sin = math.cos(pose.heading), math.sin(pose.heading)
    x, y = point_m[0] - pose.x, point_m[1] - pose.y
    ahead, aside = cos * x + sin * y, cos * y - sin * x
    return math.hypot(max(_REAR_M - ahead, ahead - _FRONT_M, 0.0), max(abs(aside) - _HALF_WIDTH_M, 0.0))
