import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.behaviours.dead_reckoning import RobotMotion

ways, turns = st.floats(-1.0, 1.0), st.floats(-3.0, 3.0)
POINTS = np.array([[1.0, 0.0], [0.0, 2.0], [-3.0, 0.5]])


def test_who_drives_straight_on_comes_nearer_to_what_is_ahead() -> None:
    assert RobotMotion(0.4, 0.0, 1.0).carry(POINTS) == pytest.approx(POINTS - [0.4, 0.0])


def test_who_turns_left_on_the_spot_finds_what_was_ahead_to_the_right() -> None:
    assert RobotMotion(0.0, math.pi, 0.5).carry(POINTS[:1]) == pytest.approx(np.array([[0.0, -1.0]]))


@given(ways, turns)
def test_distances_between_things_stay_and_driving_back_undoes_it(way_m: float, turn_rad: float) -> None:
    there = RobotMotion(way_m, turn_rad, 1.0).carry(POINTS)
    assert np.linalg.norm(there[0] - there[1]) == pytest.approx(np.linalg.norm(POINTS[0] - POINTS[1]))
    assert RobotMotion(-way_m, -turn_rad, 1.0).carry(there) == pytest.approx(POINTS, abs=1e-12)


def test_a_quarter_of_a_circle_in_small_steps_ends_where_geometry_says() -> None:
    points, steps = POINTS, 200
    for _ in range(steps):
        points = RobotMotion(math.pi / 2.0, math.pi / 2.0, 1.0 / steps).carry(points)  # radius 1 m
    x, y = (POINTS - [1.0, 1.0]).T
    assert points == pytest.approx(np.stack([y, -x], axis=1), abs=1e-4)
