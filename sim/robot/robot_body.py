"""The robot's body: the file that describes it, its wheels, outline and sonars, and its materials."""

import math
from pathlib import Path

import numpy as np

from peopleboy.geometry.pose2 import Pose2
from peopleboy.sim.shapes.materials import Material

NAME = "robot"
URDF = Path(__file__).with_name("peoplebot.urdf")

WHEEL_RADIUS_M = 0.0825
WHEEL_DISTANCE_M = 0.333
RADIUS_M = 0.355  # radius about the point between the wheels that the robot needs to turn on the spot
# The body's rear and front ends and its half width [m], relative to the same point.
_REAR_M, _FRONT_M, _HALF_WIDTH_M = -0.30, 0.21, 0.19


def wheel_speeds(linear: float, angular: float) -> tuple[float, float]:
    """Return the rim speeds [m/s] of the left and right wheel that give a robot's velocity [m/s, rad/s]."""
    half = angular * WHEEL_DISTANCE_M / 2.0
    return linear - half, linear + half


def outline_gap(pose: Pose2, point_m: tuple[float, float]) -> float:
    """Return the distance [m] on the floor between a robot's outline at a pose and a point; 0 inside."""
    ahead, aside = pose.to_local(point_m)
    return math.hypot(max(_REAR_M - ahead, ahead - _FRONT_M, 0.0), max(abs(aside) - _HALF_WIDTH_M, 0.0))


def nearest_on_outline(point_m: tuple[float, float]) -> tuple[float, float]:
    """Return the point of the robot's outline that is nearest to a point, both in the robot frame."""
    ahead, aside = point_m
    return min(max(ahead, _REAR_M), _FRONT_M), min(max(aside, -_HALF_WIDTH_M), _HALF_WIDTH_M)


# x, y [m] and angle [deg] of each sonar of the lower rings: ARIA's parameter file peoplebot-sh.p, SonarUnit
# 0..15 (its 16..31, up on the deck, are left out).
_UNITS = np.array(
    [
        (0.069, 0.136, 90.0),
        (0.114, 0.119, 50.0),
        (0.148, 0.078, 30.0),
        (0.166, 0.027, 10.0),
        (0.166, -0.027, -10.0),
        (0.148, -0.078, -30.0),
        (0.114, -0.119, -50.0),
        (0.069, -0.136, -90.0),
        (-0.157, -0.136, -90.0),
        (-0.203, -0.119, -130.0),
        (-0.237, -0.078, -150.0),
        (-0.255, -0.027, -170.0),
        (-0.255, 0.027, 170.0),
        (-0.237, 0.078, 150.0),
        (-0.203, 0.119, 130.0),
        (-0.157, 0.136, 90.0),
    ]
)
SONAR_POSITION_M = _UNITS[:, :2].copy()
SONAR_ANGLE_RAD = np.radians(_UNITS[:, 2])


_BODY = Material(temperature_c=26.0, emissivity=0.9, variation_k=0.8, variation_m=0.4, rgb=(0.45, 0.04, 0.05))
_WHEEL = Material(temperature_c=22.0, rgb=(0.04, 0.04, 0.045))


def robot_material(link_name: str) -> Material:
    """Return the material of one link of the robot: warm electronics in the body, cool wheels."""
    return _WHEEL if "wheel" in link_name or "caster" in link_name else _BODY
