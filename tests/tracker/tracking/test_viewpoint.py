"""Tests of how people in metres are seen, and where people who are seen stand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.tracking.config import STATURE_M
from peopleboy.tracker.tracking.viewpoint import Viewpoint

FOCAL = 300.0
SHAPE = (240, 320)


def calibration(pitch_deg: float, height_m: float) -> PinholeCalibration:
    """Make that of a camera that looks down by an angle."""
    down = math.radians(pitch_deg)
    right, ahead = (0.0, -1.0, 0.0), (math.cos(down), 0.0, -math.sin(down))
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([right, np.cross(ahead, right), ahead])
    pose[:3, 3] = (0.1, 0.0, height_m)
    intrinsics = np.array([[FOCAL, 0.0, 159.5], [0.0, FOCAL, 119.5], [0.0, 0.0, 1.0]])
    return PinholeCalibration(intrinsics, pose)


@given(
    st.floats(-15.0, 15.0),
    st.floats(0.4, 1.8),
    st.floats(2.0, 15.0),
    st.floats(-0.3, 0.3),
    st.floats(-0.3, 0.2),
)
def test_people_are_seen_where_the_calibration_projects_them(
    pitch_deg: float, height_m: float, away_m: float, slope: float, build: float
) -> None:
    given_by = calibration(pitch_deg, height_m)
    view = Viewpoint.of(given_by, SHAPE)
    feet = np.array([[slope * away_m, height_m, away_m]])
    column, head, foot = view.seen(feet, np.array([build]))[0]
    robot = np.array(
        [[0.1 + away_m, -slope * away_m, 0.0], [0.1 + away_m, -slope * away_m, STATURE_M * math.exp(build)]]
    )
    below, above = given_by.project(robot)
    assert foot == pytest.approx(below[1], abs=1e-6)
    assert column == pytest.approx((below[0] + above[0]) / 2.0, abs=1e-6)
    assert head == pytest.approx(above[1], abs=1e-6)


@given(st.floats(-15.0, 15.0), st.floats(2.0, 15.0), st.floats(-0.3, 0.3))
def test_a_box_tells_where_somebody_of_the_usual_stature_stands(
    pitch_deg: float, away_m: float, slope: float
) -> None:
    view = Viewpoint.of(calibration(pitch_deg, 1.2), SHAPE)
    feet = np.array([[slope * away_m, 1.2, away_m]])
    column, head, foot = view.seen(feet, np.zeros(1))[0]
    height = foot - head
    box = np.array([[column - 5.0, foot - height, 10.0, height]])
    assert view.feet(box)[0] == pytest.approx(feet[0], abs=1e-6)


def test_slopes_are_the_derivatives_of_what_is_seen() -> None:
    view = Viewpoint.of(calibration(6.0, 1.2), SHAPE)
    feet, build = np.array([[0.5, 1.2, 6.0]]), np.array([0.05])
    step = 1e-4 * np.array([1.0, -2.0, 3.0, 1.0])
    expected = view.seen(feet + step[:3], build + step[3]) - view.seen(feet, build)
    assert view.slopes(feet, build)[0] @ step == pytest.approx(expected[0], rel=1e-3)


def test_a_camera_of_which_nothing_is_known_looks_level_and_knows_no_floor() -> None:
    view = Viewpoint.of(None, SHAPE)
    assert view.floor_m is None
    assert view.seen(np.array([[0.0, 0.0, 5.0]]), np.zeros(1))[0, ::2] == pytest.approx([159.5, 119.5])
