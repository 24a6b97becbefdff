"""Corridors for tests: what sonars read in one, and a picture of one."""

from __future__ import annotations

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.behaviours.corridor.corridor_from_image import CorridorCamera
from peopleboy.behaviours.percept import Percept
from tests.helpers.percepts.toy_world import SONAR_ANGLE, SONAR_X, SONAR_Y

CAMERA = CorridorCamera(focal_px=356.0, position_m=(0.14, 0.06, 1.2))


def sonar_in_corridor(offset: float, heading: float, width: float) -> NDArray[np.float64]:
    """Ranges by rays fanned over each cone, met with two endless walls."""
    fan = np.radians(np.linspace(-7.5, 7.5, 61))
    direction = SONAR_ANGLE[:, None] + fan + heading  # in the corridor's frame
    y = offset + SONAR_X * math.sin(heading) + SONAR_Y * math.cos(heading)
    rise = np.sin(direction)
    room = np.where(rise > 0.0, width / 2.0 - y[:, None], width / 2.0 + y[:, None])
    ranges = room / np.maximum(np.abs(rise), 1e-9)
    return np.clip(ranges.min(axis=1), 0.15, 5.0)


def percept_of(ranges: NDArray[np.float64], time_s: float = 1.0, **changes: object) -> Percept:
    return Percept(
        time_s=time_s,
        people=(),
        sonar_m=ranges,
        sonar_angle_rad=SONAR_ANGLE,
        linear_m_s=0.0,
        angular_rad_s=0.0,
        **changes,  # type: ignore[arg-type]
    )


def drawn_corridor(
    offset: float, heading: float, width: float, light: float = 1.0, seed: int = 0
) -> NDArray[np.uint8]:
    """A grey corridor with a tiled brown floor, by the ground point of each pixel: independent of lines."""
    ahead, aside, tall = CAMERA.position_m
    u, v = np.meshgrid(np.arange(320) - 159.5, np.arange(240) - 119.5)
    x, y, z = np.ones_like(u), -u / CAMERA.focal_px, -v / CAMERA.focal_px
    along, across = (
        x * math.cos(heading) - y * math.sin(heading),
        x * math.sin(heading) + y * math.cos(heading),
    )
    start = offset + ahead * math.sin(heading) + aside * math.cos(heading)
    with np.errstate(divide="ignore"):
        to_wall = np.where(across > 0.0, width / 2.0 - start, width / 2.0 + start) / np.abs(across)
        to_floor = np.where(z < 0.0, -tall / z, np.inf)
        to_ceiling = np.where(z > 0.0, (2.7 - tall) / z, np.inf)
        to_end = 25.0 / along
    nearest = np.argmin([to_wall, to_floor, to_ceiling, to_end], axis=0)
    far = np.minimum(to_floor, 99.0)
    tile = (np.floor(far * along) + np.floor(start + far * across)) % 2.0
    floor = np.where(tile[..., None] > 0, [150.0, 135.0, 115.0], [125.0, 112.0, 95.0])
    paints = np.array([[165.0, 162.0, 150.0], [0, 0, 0], [180.0, 180.0, 178.0], [160.0, 157.0, 146.0]])
    image = np.where((nearest == 1)[..., None], floor, paints[nearest]) * light
    noise = np.random.default_rng(seed).normal(0.0, 2.0, image.shape)
    return cv2.GaussianBlur(np.clip(image + noise, 0.0, 255.0).astype(np.uint8), (0, 0), 0.6)
