from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.sim.cameras.camera_config import COLOUR_BASELINE_M
from peopleboy.sim.cameras.kinds import affine_between
from peopleboy.sim.geometry.pinhole import Pinhole, invert_pose, transform
from peopleboy.sim.robot.robot_config import RobotConfig

ROBOT = RobotConfig()
THERMAL, COLOUR = ROBOT.cameras["thermal"].camera, ROBOT.cameras["colour"].camera


@given(depth_m=st.floats(0.5, 20.0), x=st.floats(-3.0, 3.0), y=st.floats(-3.0, 3.0))
def test_a_point_at_the_depth_falls_where_the_affine_says(depth_m: float, x: float, y: float) -> None:
    point = np.array([x, y, depth_m])
    u, v = THERMAL.project(point)
    colour_from_thermal = invert_pose(COLOUR.robot_from_camera) @ THERMAL.robot_from_camera
    expected = COLOUR.project(transform(colour_from_thermal, point))
    assert affine_between(THERMAL, COLOUR, depth_m) @ (u, v, 1.0) == pytest.approx(expected, abs=1e-6)


@given(depth_m=st.floats(0.5, 50.0))
def test_the_default_cameras_have_the_scale_of_equation_6_1_and_the_parallax_of_their_baseline(
    depth_m: float,
) -> None:
    affine = affine_between(THERMAL, COLOUR, depth_m)
    u, v = THERMAL.centre_px
    # The colour camera is on the left, so that it sees things farther right.
    parallax = COLOUR.focal_px * COLOUR_BASELINE_M / depth_m
    expected = [[1.2, 0.0, u - 1.2 * u + parallax], [0.0, 1.2, v - 1.2 * v]]
    assert affine == pytest.approx(np.array(expected), abs=1e-7)


def test_far_away_the_parallax_vanishes() -> None:
    assert affine_between(THERMAL, COLOUR, 1e7) @ (*THERMAL.centre_px, 1.0) == pytest.approx(
        COLOUR.centre_px, abs=1e-3
    )


def test_a_turned_camera_is_fitted_within_one_percent_of_the_image_on_average() -> None:
    turned = Pinhole(yaw_rad=math.radians(4.0))
    x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(-2.0, 2.0, 21), np.linspace(-1.5, 1.5, 21)))
    points = np.stack([x, y, np.full_like(x, 4.0)], axis=1)
    pixels = np.column_stack([THERMAL.project(points), np.ones_like(x)])
    expected = turned.project(
        transform(invert_pose(turned.robot_from_camera) @ THERMAL.robot_from_camera, points)
    )
    away = np.linalg.norm(pixels @ affine_between(THERMAL, turned, 4.0).T - expected, axis=1)
    assert away.mean() < 0.01 * THERMAL.width


@pytest.mark.parametrize("depth_m", [0.0, -1.0, math.nan])
def test_a_depth_that_is_not_positive_is_refused(depth_m: float) -> None:
    with pytest.raises(BadInput, match="must be positive"):
        affine_between(THERMAL, COLOUR, depth_m)


def test_cameras_that_look_away_from_each_other_are_refused() -> None:
    with pytest.raises(BadInput, match="does not see"):
        affine_between(THERMAL, Pinhole(yaw_rad=math.pi), 4.0)
