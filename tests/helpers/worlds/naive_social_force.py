"""The social force in NumPy, as a second computation; see `social_force`."""

import numpy as np

from peopleboy.sim.people.walking.social_force import (
    BEHIND,
    HALF_SIGHT_RAD,
    PEOPLE_RANGE_M,
    PEOPLE_STRENGTH,
    POINT_RADIUS_M,
    RELAXATION_S,
    STEP_TIME_S,
    TOUCH_RANGE_M,
    TOUCH_STRENGTH,
    WALL_RANGE_M,
    WALL_STRENGTH,
)


def naive_social_force(position, velocity, desired, others, walls, bend_rad):
    """(2,) [m/s2] of others (N, 5): x, y, their velocities, and radius."""
    force = (desired - velocity) / RELAXATION_S
    heading = desired if np.hypot(*desired) > 1e-6 else velocity
    gaps = position - others[:, :2]
    limit = np.hypot(*heading) * length(gaps) * np.cos(HALF_SIGHT_RAD)
    weights = np.where(-gaps @ heading >= limit, 1.0, BEHIND)
    force = force + weights @ bent(pushes_of(gaps, velocity, others), heading, bend_rad)
    if len(walls):
        force = force + push_of_wall(position, walls)
    return force


def pushes_of(gaps, velocity, others):
    distance = np.maximum(length(gaps), 1e-3)
    shrink = np.maximum(1.0 - (others[:, 4] - POINT_RADIUS_M) / distance, 0.2)
    gaps, distance = gaps * shrink[:, None], distance * shrink
    touch = TOUCH_STRENGTH * np.exp((2.0 * POINT_RADIUS_M - distance) / TOUCH_RANGE_M)
    step = (others[:, 2:4] - velocity) * STEP_TIME_S
    ahead = gaps - step
    ahead_distance = np.maximum(length(ahead), 1e-3)
    b = np.sqrt(np.maximum((distance + ahead_distance) ** 2 - length(step) ** 2, 1e-2)) / 2.0
    strength = PEOPLE_STRENGTH / PEOPLE_RANGE_M * np.exp(-b / PEOPLE_RANGE_M)
    slope = (distance + ahead_distance) / (4.0 * b)
    direction = gaps / distance[:, None] + ahead / ahead_distance[:, None]
    return (strength * slope)[:, None] * direction + (touch / distance)[:, None] * gaps


def bent(pushes, heading, bend_rad):
    is_ahead = pushes @ heading < -0.5 * length(pushes) * length(heading)
    cos, sin = np.cos(bend_rad), np.sin(bend_rad)
    return np.where(is_ahead[:, None], pushes @ np.array([[cos, sin], [-sin, cos]]), pushes)


def push_of_wall(position, walls):
    gaps = position - np.clip(position, walls[:, :2], walls[:, 2:])
    distance = length(gaps).min()
    if distance < 2e-3:
        return np.zeros(2)
    gap = gaps[np.argmin(length(gaps))]
    return WALL_STRENGTH / WALL_RANGE_M * np.exp(-distance / WALL_RANGE_M) * gap / distance


def length(vectors):
    return np.linalg.norm(vectors, axis=-1)
