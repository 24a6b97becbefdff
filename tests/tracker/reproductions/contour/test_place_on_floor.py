"""Places on the floor: exact where the box is, honest where it errs."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.tracker.reproductions.contour.box_interaction import (
    CORRELATION,
    ERRORS,
    FARTHEST_M,
    FOOT_BELOW,
    FOOT_SD,
    HEAD_SD,
    PERSON_M,
    STATURE_SD_M,
    TORSO_ROW,
    _ends,
    places_on_floor,
    standing_box,
)
from peopleboy.tracker.track import Box, Status
from tests.helpers.calls.refused import refused


def calibrate(camera: Pinhole) -> PinholeCalibration:
    return PinholeCalibration(camera.intrinsics, camera.robot_from_camera)


def box_of(x: float, y: float, calibration: PinholeCalibration, stature_m: float = PERSON_M) -> Box:
    """The tracker's box of somebody who stands at a place, 20 px wide about the torso."""
    (head, top), (sole, foot) = calibration.project(np.array([[x, y, stature_m], [x, y, 0.0]])).tolist()
    height = (foot - top) / (1.0 - FOOT_BELOW)
    return head + TORSO_ROW * (sole - head) - 10.0, top, 20.0, height


@given(
    st.floats(1.5, 12.0), st.floats(-0.4, 0.4), st.floats(0.4, 1.8), st.floats(-0.3, 0.3),
    st.integers(60, 960), st.floats(0.3, 1.2), st.floats(-0.35, 0.35),
)  # fmt: skip
def test_a_person_of_the_usual_stature_is_where_it_stands(
    away, bearing, up, yaw, height, field_of_view, pitch
):
    camera = Pinhole(
        width=height * 2,
        height=height,
        vertical_fov_rad=field_of_view,
        position_m=(0.2, -0.1, up),
        yaw_rad=yaw,
        pitch_rad=pitch,
    )
    x, y = 0.2 + away * math.cos(yaw + bearing), -0.1 + away * math.sin(yaw + bearing)
    [place] = places_on_floor([box_of(x, y, calibrate(camera))], [Status.TRACKED], calibrate(camera))
    assert place.position_m == pytest.approx((x, y), abs=1e-6)
    left, _, width, height = box_of(x, y, calibrate(camera))
    stands = standing_box(place, calibrate(camera))
    assert stands[0] + stands[2] / 2 == pytest.approx(left + width / 2, abs=1e-6)
    assert stands[3] == pytest.approx(height * (1.0 - FOOT_BELOW))


@given(st.floats(-0.5, 0.5), st.floats(0.4, 1.8), st.integers(60, 480), st.floats(-math.pi, math.pi))
def test_a_level_camera_reads_the_middle_column_at_both_ends_to_the_last_bit(share, up, rows, yaw):
    camera = Pinhole(width=2 * rows, height=rows, position_m=(0.2, -0.1, up), yaw_rad=yaw)
    left, top, width, height = box = (share * rows + rows / 3, rows * 0.3, rows * 0.1, rows * 0.5)
    ends = np.array([[left + width / 2, top], [left + width / 2, top + (1.0 - FOOT_BELOW) * height]])
    found, [lean] = _ends(np.array([box]), calibrate(camera))
    assert (found == ends).all()
    assert lean == 0.0


def test_who_leans_more_in_the_image_is_placed_less_surely_across():
    calibration = calibrate(Pinhole(pitch_rad=0.3, position_m=(0.0, 0.0, 1.2)))
    spreads = []
    for aside in (0.0, 1.0, 2.0):
        [place] = places_on_floor([box_of(6.0, aside, calibration)], [Status.TRACKED], calibration)
        xx, xy, yy = place.covariance_m2
        spreads.append(float(np.linalg.eigvalsh([[xx, xy], [xy, yy]])[0]))
    assert spreads[0] == pytest.approx((ERRORS[Status.TRACKED][1] * PERSON_M) ** 2, rel=1e-4)
    assert spreads == sorted(spreads)
    assert spreads[2] > 1.5 * spreads[0]


@given(st.floats(2.0, 10.0), st.floats(-math.pi, math.pi))
def test_the_ellipse_points_along_the_line_of_sight(away, yaw):
    calibration = calibrate(Pinhole(position_m=(0.0, 0.0, 1.2), yaw_rad=yaw))
    x, y = away * math.cos(yaw), away * math.sin(yaw)
    [place] = places_on_floor([box_of(x, y, calibration)], [Status.TRACKED], calibration)
    xx, xy, yy = place.covariance_m2
    variance, axes = np.linalg.eigh([[xx, xy], [xy, yy]])
    along, across = ERRORS[Status.TRACKED]
    assert variance[1] == pytest.approx((along * away) ** 2, rel=1e-4)
    assert variance[0] == pytest.approx((across * PERSON_M) ** 2, rel=1e-4)
    assert abs(axes[:, 1] @ [math.cos(yaw), math.sin(yaw)]) == pytest.approx(1.0)


def test_feet_and_head_are_mixed_as_least_squares_would():
    """An independent way: errors drawn as they are said to be, and the mix that leaves the least."""
    rng, up, away = np.random.default_rng(0), 1.2, 6.0
    covariance = [
        [FOOT_SD**2, CORRELATION * FOOT_SD * HEAD_SD],
        [CORRELATION * FOOT_SD * HEAD_SD, HEAD_SD**2],
    ]
    size = PERSON_M / away
    errors = rng.multivariate_normal((0.0, 0.0), covariance, 100_000) * size
    stature = PERSON_M + STATURE_SD_M * rng.standard_normal(100_000)
    foot, head = up / away + errors[:, 0], (stature - up) / away + errors[:, 1]
    shares = np.linspace(0.0, 1.0, 101)
    spreads = [np.std(s * foot / up + (1.0 - s) * head / (PERSON_M - up)) for s in shares]
    best = shares[int(np.argmin(spreads))]

    calibration = calibrate(Pinhole(position_m=(0.0, 0.0, up)))
    left, top, width, height = box_of(away, 0.0, calibration)
    step = 0.1
    higher = (left, top - step, width, height + step / (1.0 - FOOT_BELOW) * (1.0 - FOOT_BELOW))
    [place] = places_on_floor([higher], [Status.TRACKED], calibration)
    moved = 1.0 / place.position_m[0] - 1.0 / away
    slope = step / Pinhole().focal_px
    foot_moved = -FOOT_BELOW * slope  # a box that begins higher by a step ends lower by this of it
    share = (moved - slope / (PERSON_M - up)) / (foot_moved / up - slope / (PERSON_M - up))
    assert share == pytest.approx(best, abs=0.03)


@pytest.mark.parametrize("status", list(ERRORS))
def test_who_is_seen_less_is_placed_less_surely(status: Status):
    assert all(error >= usual for error, usual in zip(ERRORS[status], ERRORS[Status.TRACKED], strict=True))


def test_feet_above_the_horizon_are_far_away_and_not_behind():
    calibration = calibrate(Pinhole())
    [place] = places_on_floor([(100.0, 40.0, 20.0, 50.0)], [Status.TRACKED], calibration)
    assert math.hypot(*place.position_m) <= FARTHEST_M + 1.0
    assert place.position_m[0] > 0.0


def test_nobody_is_nowhere():
    assert places_on_floor([], [], calibrate(Pinhole())) == []


def test_a_calibration_of_another_shape_is_refused():
    with refused("intrinsics", "(3, 3)", "(2, 2)"):
        PinholeCalibration(np.eye(2), np.eye(4))
    with refused("robot_from_camera", "finite"):
        PinholeCalibration(np.eye(3), np.full((4, 4), np.nan))


@given(
    st.floats(-0.3, 0.3), st.floats(-3.0, 3.0), st.floats(0.5, 20.0), st.floats(-5.0, 5.0), st.floats(0, 2)
)
def test_a_ray_leads_back_to_the_point_that_its_pixel_shows(pitch, yaw, ahead, aside, up):
    camera = Pinhole(pitch_rad=pitch, yaw_rad=yaw)
    calibration = calibrate(camera)
    pose = camera.robot_from_camera
    point = pose[:3, :3] @ [aside, up - 1.0, ahead] + pose[:3, 3]
    [ray] = calibration.rays(calibration.project(point[None]))
    assert ray * ahead + calibration.position_m == pytest.approx(point, abs=1e-6)
    assert np.isnan(calibration.project((2.0 * pose[:3, 3] - point)[None])).all()
