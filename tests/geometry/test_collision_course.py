import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.geometry.collision_course import times_to_collision


def time_to_collision(gap, velocity, reach_m):
    return float(times_to_collision(gap[None], velocity[None], reach_m)[0])


def test_head_on_the_time_is_that_of_the_gap_between_the_discs():
    assert time_to_collision(np.array([5.0, 0.0]), np.array([-1.0, 0.0]), 1.0) == pytest.approx(4.0)
    assert time_to_collision(np.array([5.0, 1.1]), np.array([-1.0, 0.0]), 1.0) == math.inf
    assert time_to_collision(np.array([5.0, 0.0]), np.array([1.0, 0.0]), 1.0) == math.inf
    assert time_to_collision(np.array([5.0, 0.0]), np.zeros(2), 1.0) == math.inf
    assert time_to_collision(np.array([0.5, 0.0]), np.array([1.0, 0.0]), 1.0) == 0.0


speeds = st.floats(-2.0, 2.0)


@given(st.floats(1.1, 8.0), st.floats(-3.0, 3.0), speeds, speeds)
def test_at_the_time_to_collision_the_discs_touch(x, y, vx, vy):
    gap, velocity = np.array([x, y]), np.array([vx, vy])
    time_s = time_to_collision(gap, velocity, 1.0)
    if math.isfinite(time_s):
        assert np.hypot(*(gap + time_s * velocity)) == pytest.approx(1.0, abs=1e-6)
    else:
        times = np.linspace(0.0, 20.0, 400)[:, None]
        assert np.linalg.norm(gap + times * velocity, axis=1).min() > 1.0 - 1e-6
