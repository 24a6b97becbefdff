"""Windows that a detector of humans looks at."""

from __future__ import annotations

import math

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.sensors.depth.human_windows import (
    SIZES,
    WindowRange,
    cut,
    cut_depth,
    depth_features,
    features,
    hog_descriptor,
    range_of,
    window_of,
)
from peopleboy.tracker.sensors.depth.pre_detection import PreDetection
from peopleboy.tracker.sensors.depth.v_disparity import HeightLine
from peopleboy.tracker.sensors.depth.window_model import feature_length
from tests.helpers.depth_scene import HEIGHT, make_view

FLOOR = HeightLine(0.0, 1.2)
BODY = PreDetection(
    box=(150.0, 86.0, 30.0, 124.0), x_m=0.0, z_m=4.0, width_m=0.4, height_m=1.65, depth_m=0.3, probability=1.0
)


def test_far_begins_where_feet_come_into_view() -> None:
    view = make_view()
    nearest_feet_m = 1.2 * view.focal_px / (HEIGHT / 2)  # Eq. 4.16, as a ratio of sides
    assert range_of(nearest_feet_m + 0.2, FLOOR, view, HEIGHT) is WindowRange.FAR
    assert range_of(nearest_feet_m, FLOOR, view, HEIGHT) is WindowRange.NEAR


def test_a_far_window_has_its_body_in_the_middle_104_of_128_rows() -> None:
    view = make_view()
    left, top, width, height = window_of(BODY.box, BODY.z_m, WindowRange.FAR, FLOOR, view)
    foot = float(FLOOR.rows(np.array([4.0]), view)[0])
    assert height == pytest.approx(max(foot - 86.0, 124.0) * 128 / 104)
    assert width == pytest.approx(height / 2)
    assert left + width / 2 == pytest.approx(165.0)
    assert 86.0 - top == pytest.approx(height * 12 / 128)


def test_a_near_window_is_a_square_about_head_and_shoulders() -> None:
    left, top, width, height = window_of(BODY.box, BODY.z_m, WindowRange.NEAR, FLOOR, make_view())
    assert width == height == pytest.approx(0.7 * 300.0 / 4.0)
    assert (left + width / 2, top) == pytest.approx((165.0, 86.0 - 0.12 * 52.5))


@pytest.mark.parametrize("kind", list(WindowRange))
@pytest.mark.parametrize(
    "window", [(-40.0, -40.0, 60.0, 90.0), (300.0, 200.0, 60.0, 90.0), (400.0, 10.0, 5.0, 5.0)]
)
def test_windows_beyond_the_border_go_on_as_the_image_ends(
    kind: WindowRange, window: tuple[float, ...]
) -> None:
    image = np.random.default_rng(0).integers(0, 255, (240, 320, 3)).astype(np.uint8)
    left, top, width, height = window
    patch = cut(image, (left, top, width, height), kind)
    assert patch.shape == (*SIZES[kind][::-1], 3)


@pytest.mark.parametrize("kind", list(WindowRange))
def test_a_depth_window_shows_a_body_grey_before_a_white_wall_and_a_white_hole(kind: WindowRange) -> None:
    depth = np.full((240, 320), 5000, np.uint16)
    depth[60:200, 140:180] = 3000
    depth[100:110, 150:160] = 0
    wide, tall = SIZES[kind]
    patch = cut_depth(depth, 3.0, (160.0 - wide / 2, 60.0, float(wide), float(tall)), kind)
    assert patch.shape == (tall, wide)
    body = np.zeros_like(depth, dtype=bool)
    body[60:200, 140:180], body[100:110, 150:160] = True, False
    shown = body[60 : 60 + tall, 160 - wide // 2 : 160 + wide // 2]
    assert (patch[shown] == 127).all()  # in the middle of what is shown
    assert (patch[~shown] == 255).all()


def test_what_is_a_wall_all_over_has_no_gradients_in_depth() -> None:
    depth = np.full((240, 320), 5000, np.uint16)
    assert not depth_features(depth, 5.0, (100.0, 50.0, 64.0, 128.0), WindowRange.FAR).any()


@pytest.mark.parametrize("kind", list(WindowRange))
def test_features_have_the_length_that_machines_expect(kind: WindowRange) -> None:
    image = np.random.default_rng(0).integers(0, 255, (240, 320, 3)).astype(np.uint8)
    assert features(image, (10.0, 10.0, 60.0, 120.0), kind).shape == (feature_length(kind),)


def test_the_opening_angle_of_the_image_decides_with_the_height() -> None:
    view, half = make_view(), math.atan(HEIGHT / 2 / 300.0)
    farthest = 1.2 * math.tan(math.pi / 2 - half)
    assert range_of(farthest + 0.11, FLOOR, view, HEIGHT) is WindowRange.FAR
    assert range_of(farthest + 0.09, FLOOR, view, HEIGHT) is WindowRange.NEAR


def test_without_hog_the_version_of_opencv_that_has_it_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr("cv2.HOGDescriptor")
    with pytest.raises(BadInput, match="opencv-python-headless<5"):
        hog_descriptor((8, 8))
