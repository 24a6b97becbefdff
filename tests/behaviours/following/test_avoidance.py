import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.behaviours.following.avoidance import WIDELY, AvoidConfig, swerve

CONFIG = AvoidConfig()
points = st.lists(st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)), max_size=16).map(
    lambda rows: np.array(rows, float).reshape(-1, 2)
)
bearings = st.floats(-0.6, 0.6)


def polar(distance, angle):
    return np.array([[distance * math.cos(angle), distance * math.sin(angle)]])


@given(bearings, points)
def test_left_and_right_are_mirror_images_and_no_swerve_is_wider_than_allowed(bearing, echoes):
    aside = swerve(bearing, echoes, CONFIG)
    assert abs(aside) <= CONFIG.widest_rad
    on_line = np.isclose(np.arctan2(echoes[:, 1], echoes[:, 0]), bearing)
    if not on_line.any():
        assert swerve(-bearing, echoes * (1.0, -1.0), CONFIG) == pytest.approx(-aside, abs=1e-9)


@pytest.mark.parametrize("distance", [0.9 * CONFIG.reach_m, 0.7, 0.5])
def test_an_echo_on_the_left_moves_the_aim_right(distance):
    assert swerve(0.0, polar(distance, 0.2), CONFIG) < 0.0


def test_the_swerve_clears_the_echo_by_half_the_lane():
    config = AvoidConfig(widest_rad=math.pi)
    aside = swerve(0.0, polar(0.7, 0.3), config)
    assert math.sin(0.3 - aside) == pytest.approx(config.half_width_m / 0.7, abs=0.03)


@pytest.mark.parametrize("echo", [polar(1.5, 0.05), polar(0.8, 1.2), polar(0.3, math.pi), np.zeros((0, 2))])
def test_far_wide_or_rear_echoes_do_not_matter(echo):
    assert swerve(0.0, echo, CONFIG) == 0.0


def test_between_equal_door_posts_the_aim_stays():
    posts = np.array([[0.6, 0.3], [0.6, -0.3]])
    assert swerve(0.0, posts, CONFIG) == pytest.approx(0.0)


@given(st.floats(0.95, 1.2), st.floats(0.5, 0.9))
def test_before_a_wall_that_ends_on_the_right_the_aim_goes_past_its_end_though_it_lies_on_both_sides(
    ahead, reach
):
    wall = np.stack([np.full(40, ahead), np.linspace(-0.15, reach, 40)], axis=1)
    assert swerve(0.0, wall, WIDELY) < -0.1
