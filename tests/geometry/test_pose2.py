"""Poses on the floor form a group, and points go there and back."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.geometry.pose2 import Pose2

poses = st.builds(Pose2, st.floats(-5, 5), st.floats(-5, 5), st.floats(-3, 3))
angles = st.floats(-math.pi, math.pi)


def matrix(pose: Pose2) -> np.ndarray:
    """The homogeneous matrix (3, 3) of a pose."""
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    return np.array([[c, -s, pose.x], [s, c, pose.y], [0.0, 0.0, 1.0]])


@given(poses, poses)
def test_poses_compose_as_their_matrices_do(parent: Pose2, child: Pose2) -> None:
    both = matrix(parent) @ matrix(child)
    np.testing.assert_allclose(matrix(parent.compose(child)), both, atol=1e-9)
    np.testing.assert_allclose(matrix(parent.integrate(child)), both, atol=1e-9)
    np.testing.assert_allclose(matrix(parent.inverse()), np.linalg.inv(matrix(parent)), atol=1e-9)


@given(poses, poses)
def test_a_relative_pose_leads_from_one_to_the_other(pose: Pose2, other: Pose2) -> None:
    found = other.compose(pose.relative_to(other))
    np.testing.assert_allclose(matrix(found), matrix(pose), atol=1e-9)


@given(poses, st.tuples(st.floats(-9, 9), st.floats(-9, 9)))
def test_points_return_from_the_frame(pose: Pose2, point: tuple[float, float]) -> None:
    assert pose.transform_point(pose.to_local(point)) == pytest.approx(point, abs=1e-9)
    local = pose.points_to_local(np.array([point]))
    assert local[0] == pytest.approx(pose.to_local(point), abs=1e-9)
    (mapped,) = pose.transform_points(np.column_stack([local, [2.0]]))
    assert mapped == pytest.approx([*point, 2.0], abs=1e-9)


@given(poses, st.floats(0.1, 9), angles)
def test_a_polar_place_is_found_again_in_the_frame(pose: Pose2, distance: float, bearing: float) -> None:
    place = pose.transform_polar(distance, bearing)
    x, y, heading = pose.x, pose.y, pose.heading
    assert place == pytest.approx(
        [x + distance * math.cos(heading + bearing), y + distance * math.sin(heading + bearing)]
    )
    local = pose.points_to_local(place)
    assert local == pytest.approx([distance * math.cos(bearing), distance * math.sin(bearing)])


def test_a_robot_that_drives_round_a_square_is_where_it_was() -> None:
    composed = integrated = Pose2()
    for _ in range(4):
        side = Pose2(1.5, 0.2, math.pi / 2)
        composed, integrated = composed.compose(side), integrated.integrate(side)
    assert (composed.x, composed.y, composed.heading) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert (integrated.x, integrated.y, integrated.heading) == pytest.approx((0.0, 0.0, math.tau), abs=1e-9)


def test_a_covariance_turns_with_the_frame() -> None:
    turned = Pose2(heading=math.pi / 2).covariance_to_local(np.diag([1.0, 4.0]))
    np.testing.assert_allclose(turned, np.diag([4.0, 1.0]), atol=1e-12)
