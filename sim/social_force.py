"""How people give way: the social force model."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Helbing and Molnar, Social force model for pedestrian dynamics, Phys. Rev. E 51, 4282 (1995), section III.
RELAXATION_S = 0.5
PEOPLE_STRENGTH = 2.1  # [m2/s2] V0
PEOPLE_RANGE_M = 0.3  # sigma
WALL_STRENGTH = 10.0  # [m2/s2] U0
WALL_RANGE_M = 0.2  # R
STEP_TIME_S = 2.0  # delta t: how far ahead the other's step is foreseen
HALF_SIGHT_RAD = math.radians(100.0)  # phi
BEHIND = 0.5  # c: weight of what is out of sight
# Ours: who comes head-on is passed on the right, so that nobody gets stuck; a force bends by this much.
_KEEP_RIGHT_RAD = 0.25
_POINT_RADIUS_M = 0.25  # the size of the bodies that the constants were made for


@dataclass(frozen=True, slots=True, eq=False)
class PlanarState:
    """Somebody or something that moves over the floor.

    Attributes:
        position: (2,) [m] in the world frame.
        velocity: (2,) [m/s].
        radius_m: [m] of the circle that it takes up.
    """

    position: Array
    velocity: Array
    radius_m: float = 0.25


def social_force(
    position: Array, velocity: Array, desired: Array, others: Iterable[PlanarState], walls: Array
) -> Array:
    """Sum what pulls a person to the goal and pushes it away from others and walls.

    Source: Helbing and Molnar (1995), eqs. 2 to 10, without attraction and fluctuations.

    Args:
        position: (2,) [m].
        velocity: (2,) [m/s].
        desired: (2,) [m/s] velocity towards the goal.
        others: people and robots.
        walls: (K, 4) [m] rectangles min_x, min_y, max_x, max_y.

    Returns:
        (2,) [m/s2] acceleration.
    """
    force: Array = (desired - velocity) / RELAXATION_S
    heading = desired if float(np.hypot(*desired)) > 1e-6 else velocity
    for other in others:
        force = force + _sight_weight(heading, other.position - position) * _push_of(position, heading, other)
    if len(walls):
        force = force + _push_of_wall(position, walls)
    return force


def _push_of(position: Array, heading: Array, other: PlanarState) -> Array:
    """Repulsion (2,) [m/s2] by one other: falls off with ellipses that reach out along the other's step."""
    gap = position - other.position
    distance = float(np.hypot(*gap))
    if distance < 1e-6:
        return np.array([0.0, 0.0])
    step = other.velocity * STEP_TIME_S
    shrink = max((distance - (other.radius_m - _POINT_RADIUS_M)) / distance, 0.2)
    gap, distance = gap * shrink, distance * shrink
    ahead = gap - step
    ahead_distance = max(float(np.hypot(*ahead)), 1e-6)
    squared = (distance + ahead_distance) ** 2 - float(step @ step)
    b = math.sqrt(max(squared, 1e-6)) / 2.0
    slope = (distance + ahead_distance) / (4.0 * max(b, 0.05))
    strength = PEOPLE_STRENGTH / PEOPLE_RANGE_M * math.exp(-b / PEOPLE_RANGE_M) * slope
    push: Array = strength * (gap / distance + ahead / ahead_distance)
    return _bend_right(push, heading)


def _bend_right(push: Array, heading: Array) -> Array:
    """Turn a push that comes from straight ahead so that it moves the walker to the right."""
    speed, strength = float(np.hypot(*heading)), float(np.hypot(*push))
    if speed < 1e-6 or strength < 1e-9 or float(heading @ push) > -0.5 * speed * strength:
        return push
    cos, sin = math.cos(_KEEP_RIGHT_RAD), math.sin(_KEEP_RIGHT_RAD)
    return np.array([cos * push[0] - sin * push[1], sin * push[0] + cos * push[1]])


def _sight_weight(heading: Array, towards: Array) -> float:
    """Weight of what lies in a direction: 1 in sight, `BEHIND` out of it (eqs. 8 and 9)."""
    scale = float(np.hypot(*heading) * np.hypot(*towards))
    if scale < 1e-9 or float(heading @ towards) >= scale * math.cos(HALF_SIGHT_RAD):
        return 1.0
    return BEHIND


def _push_of_wall(position: Array, walls: Array) -> Array:
    """Repulsion (2,) [m/s2] by the nearest point of the nearest wall (eq. 5)."""
    nearest = np.clip(position, walls[:, :2], walls[:, 2:])
    gaps = position - nearest
    distances = np.hypot(gaps[:, 0], gaps[:, 1])
    k = int(np.argmin(distances))
    distance = max(float(distances[k]), 1e-3)
    if distance < 2e-3:
        return np.array([0.0, 0.0])
    push: Array = WALL_STRENGTH / WALL_RANGE_M * math.exp(-distance / WALL_RANGE_M) * gaps[k] / distance
    return push
