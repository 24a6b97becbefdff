"""How people give way: the social force model."""

from __future__ import annotations

import math
from collections.abc import Sequence
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
STEP_TIME_S = 1.0  # delta t: how far ahead a step is foreseen
HALF_SIGHT_RAD = math.radians(100.0)  # phi
BEHIND = 0.5  # c: weight of what is out of sight
# Helbing, Farkas and Vicsek, Simulating dynamical features of escape panic, Nature 407, 487 (2000): the push
# of bodies about to touch; B is theirs, the strength a third of their A / m, for people who are not in panic.
TOUCH_STRENGTH = 8.0  # [m/s2]
TOUCH_RANGE_M = 0.08
# Ours: who comes head-on is passed on the right, so that nobody gets stuck; a force bends by this much.
KEEP_RIGHT_RAD = 0.25
POINT_RADIUS_M = 0.25  # the size of the bodies that the constants were made for


@dataclass(frozen=True, slots=True, eq=False)
class PlanarState:
    """Somebody or something that moves over the floor.

    Attributes:
        position: (2,) [m] in the world frame.
        velocity: (2,) [m/s].
        radius_m: [m] of the circle that it takes up.
        heading_rad: [rad] where its front is; of people it is not asked for.
    """

    position: Array
    velocity: Array
    radius_m: float = 0.25
    heading_rad: float = 0.0


def social_force(
    position: Array,
    velocity: Array,
    desired: Array,
    others: Sequence[PlanarState],
    walls: Array,
    bend_rad: float = KEEP_RIGHT_RAD,
) -> Array:
    """Sum what pulls a person to the goal and pushes it away from others and walls.

    Source: Helbing and Molnar (1995), eqs. 2 to 10, without attraction and fluctuations.

    Args:
        position: (2,) [m].
        velocity: (2,) [m/s].
        desired: (2,) [m/s] velocity towards the goal.
        others: people and robots.
        walls: (K, 4) [m] rectangles min_x, min_y, max_x, max_y.
        bend_rad: [rad] by how much a push from ahead is turned to pass on the right; negative for the left.

    Returns:
        (2,) [m/s2] acceleration.
    """
    force: Array = (desired - velocity) / RELAXATION_S
    if others:
        heading = desired if _length(desired) > 1e-6 else velocity
        gaps = position - np.array([other.position for other in others])  # (N, 2)
        pushes = _push_of(gaps, velocity, others)
        weights = _sight_weight(heading, -gaps)
        force = force + weights @ _bend(pushes, heading, bend_rad)
    if len(walls):
        force = force + _push_of_wall(position, walls)
    return force


def _push_of(gaps: Array, velocity: Array, others: Sequence[PlanarState]) -> Array:
    """(N, 2) [m/s2] repulsion by others, which falls off with ellipses that reach out along the coming step.

    Our change to eq. 4: the step is that of the velocity relative to the walker, half as long (Johansson,
    Helbing and Shukla 2007), so that a robot that stands still is avoided like a person who comes.
    """
    distance = np.maximum(_length(gaps), 1e-3)
    beyond = np.array([other.radius_m for other in others]) - POINT_RADIUS_M
    shrink = np.maximum(1.0 - beyond / distance, 0.2)
    gaps, distance = gaps * shrink[:, None], distance * shrink
    touch = TOUCH_STRENGTH * np.exp((2.0 * POINT_RADIUS_M - distance) / TOUCH_RANGE_M)
    step = (np.array([other.velocity for other in others]) - velocity) * STEP_TIME_S
    ahead = gaps - step
    ahead_distance = np.maximum(_length(ahead), 1e-3)
    b = np.sqrt(np.maximum((distance + ahead_distance) ** 2 - _length(step) ** 2, 1e-2)) / 2.0
    strength = PEOPLE_STRENGTH / PEOPLE_RANGE_M * np.exp(-b / PEOPLE_RANGE_M)
    slope = (distance + ahead_distance) / (4.0 * b)
    direction = gaps / distance[:, None] + ahead / ahead_distance[:, None]
    pushes: Array = (strength * slope)[:, None] * direction + (touch / distance)[:, None] * gaps
    return pushes


def _bend(pushes: Array, heading: Array, bend_rad: float) -> Array:
    """Turn (N, 2) pushes that come from ahead so that they move the walker to one side."""
    is_ahead = pushes @ heading < -0.5 * _length(pushes) * _length(heading)
    cos, sin = math.cos(bend_rad), math.sin(bend_rad)
    return np.where(is_ahead[:, None], pushes @ np.array([[cos, sin], [-sin, cos]]), pushes)


def _sight_weight(heading: Array, towards: Array) -> Array:
    """(N,) weight of what lies in directions (N, 2): 1 in sight, `BEHIND` out of it (eqs. 8 and 9)."""
    limit = _length(heading) * _length(towards) * math.cos(HALF_SIGHT_RAD)
    return np.where(towards @ heading >= limit, 1.0, BEHIND)


def _length(vectors: Array) -> Array:
    length: Array = np.sqrt((vectors * vectors).sum(axis=-1))
    return length


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
