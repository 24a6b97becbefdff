import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.sim.people.walking.social_force import (
    KEEP_RIGHT_RAD,
    NO_ROBOT,
    POINT_RADIUS_M,
    RELAXATION_S,
    Obstacles,
    social_force,
)
from tests.helpers.worlds.naive_social_force import naive_social_force

NO_WALLS = np.empty((0, 4))


@given(st.integers(0, 2**32), st.integers(0, 8), st.booleans(), st.floats(-1.5, 1.5))
def test_forces_are_those_of_the_naive_computation(seed, count, has_robot, bend_rad):
    rng = np.random.default_rng(seed)
    people = np.column_stack([rng.uniform(-4.0, 4.0, (count, 2)), rng.uniform(-2.0, 2.0, (count, 2))])
    at, velocity, desired = rng.uniform(-2.0, 2.0, (3, 2))
    robot = (*rng.uniform(-4.0, 4.0, 2), *rng.uniform(-1.0, 1.0, 2), rng.uniform(0.2, 1.0))
    corners = rng.uniform(-5.0, 5.0, (3, 2, 2))
    walls = np.concatenate([corners.min(axis=1), corners.max(axis=1)], axis=1)[: rng.integers(4)]
    walker = int(rng.integers(-1, count))
    obstacles = Obstacles(people, walker, robot if has_robot else NO_ROBOT, walls)
    force = social_force(tuple(at), tuple(velocity), tuple(desired), obstacles, bend_rad)
    others = np.delete(people, walker, axis=0) if walker >= 0 else people
    others = np.column_stack([others, np.full(len(others), POINT_RADIUS_M)])
    if has_robot:
        others = np.concatenate([others, np.array(robot)[None]])
    expected = naive_social_force(at, velocity, desired, others, walls, bend_rad)
    np.testing.assert_allclose(force, expected, rtol=1e-9, atol=1e-9)


def test_alone_one_is_pulled_to_the_wish():
    nobody = Obstacles(np.empty((0, 4)), -1, NO_ROBOT, NO_WALLS)
    force = social_force((0.0, 0.0), (0.5, 0.0), (1.0, 1.0), nobody, KEEP_RIGHT_RAD)
    assert force == pytest.approx((0.5 / RELAXATION_S, 1.0 / RELAXATION_S))


def test_nobody_pushes_himself():
    me = Obstacles(np.array([[0.0, 0.0, 1.0, 0.0]]), 0, NO_ROBOT, NO_WALLS)
    force = social_force((0.0, 0.0), (1.0, 0.0), (1.0, 0.0), me, KEEP_RIGHT_RAD)
    assert force == (0.0, 0.0)
