import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.tracker.camera_mount import Mount, mount_of
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.reproductions.contour.contour_config import LimitsConfig
from peopleboy.tracker.reproductions.contour.estimated_mount import limits_seen_from, seen_from
from peopleboy.tracker.reproductions.contour.particle_filter import is_within
from peopleboy.tracker.reproductions.contour.particles import CROWN, FOOT, H, W, X, Y, limits_px
from peopleboy.tracker.reproductions.contour.variants import VARIANTS
from peopleboy.tracker.trackers import make_tracker

FLOOR = LimitsConfig(y=(-9.0, 9.0), h=(0.01, 3.0), y_below_horizon=(-0.1, 0.9))


def camera(height_m=1.2, pitch_deg=0.0, fov_deg=44.0):
    return Pinhole(
        position_m=(0.0, 0.0, height_m),
        pitch_rad=math.radians(pitch_deg),
        vertical_fov_rad=math.radians(fov_deg),
    )


def test_the_robots_own_camera_is_the_usual_one_to_the_last_bit():
    mount = mount_of(Pinhole().calibration, 240)
    assert mount == mount_of(None, 240)
    for config in VARIANTS.values():
        assert seen_from(config, mount, 240) == config


@given(st.floats(0.3, 2.5), st.floats(-30, 30), st.floats(20, 80))
def test_the_horizon_is_where_far_points_at_the_cameras_height_are(height_m, pitch_deg, fov_deg):
    geometry = camera(height_m, pitch_deg, fov_deg)
    mount = mount_of(geometry.calibration, geometry.height)
    far = geometry.calibration.project(np.array([[1e7, 0.0, height_m]]))[0, 1]
    assert mount == Mount(
        pytest.approx(far, abs=1e-3), pytest.approx(geometry.focal_px), pytest.approx(height_m)
    )


@given(
    st.floats(0.3, 2.0), st.floats(-15, 15), st.floats(25, 60), st.floats(3.0, 12.0), st.floats(1.55, 1.85)
)
def test_people_who_stand_on_the_floor_are_within_the_limits_of_any_camera(
    height_m, pitch_deg, fov_deg, distance_m, stature_m
):
    geometry = camera(height_m, pitch_deg, fov_deg)
    calibration = geometry.calibration
    head, foot = calibration.project(np.array([[distance_m, 0.0, stature_m], [distance_m, 0.0, 0.0]]))[:, 1]
    h = (foot - head) / (CROWN + FOOT)
    state = np.zeros((3, 9), dtype=np.float32)
    state[:, H], state[:, W], state[:, X] = h, 0.4 * h, 160.0
    state[:, Y] = foot - FOOT * h + np.array([0.0, -3.0, 3.0]) * h  # one on the floor, one above, one below
    limits = limits_seen_from(FLOOR, mount_of(calibration, geometry.height), geometry.height)
    assert list(is_within(state, limits_px(geometry.height, limits))) == [True, False, False]


@pytest.mark.parametrize("pitch_deg", [-90.0, 90.0])
@pytest.mark.parametrize("height_m", [0.05, 5.0])
def test_a_camera_that_looks_straight_up_or_down_has_its_horizon_far_away(pitch_deg, height_m):
    mount = mount_of(camera(height_m, pitch_deg).calibration, 240)
    assert abs(mount.horizon_px) == 24000.0
    assert math.copysign(1.0, mount.horizon_px) == -math.copysign(1.0, pitch_deg)  # below it when looking up
    tracker = make_tracker("contour")
    calibrations = {"thermal": camera(height_m, pitch_deg).calibration}
    for tick in range(3):
        images = {"thermal": np.full((240, 320), 40, np.uint8)}
        assert tracker.update(Frame(images=images, calibrations=calibrations, time_s=tick / 15)) == ()
