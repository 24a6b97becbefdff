"""What has the size of a human."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.tracker.sensors.depth.pre_detection import PRINTED_SIZE, HumanSize, PreDetector
from peopleboy.tracker.sensors.depth.u_depth import UDepthConfig
from tests.helpers.depth_scene import Block, depth_of, make_view

DETECT = PreDetector(HumanSize(), UDepthConfig())


@settings(max_examples=20, deadline=None)
@given(x_m=st.floats(-0.8, 0.8), z_m=st.floats(3.4, 8.0), height_m=st.floats(1.5, 1.95))
def test_somebody_is_found_where_they_are_and_as_tall(x_m: float, z_m: float, height_m: float) -> None:
    (found,) = DETECT(depth_of([Block(x_m, z_m, height_m=height_m)]), make_view()).detections
    pixel_m = z_m / 300.0
    assert found.x_m == pytest.approx(x_m, abs=pixel_m)
    assert found.z_m == pytest.approx(z_m, abs=0.02)
    assert found.width_m == pytest.approx(0.45, abs=2.5 * pixel_m)
    assert found.height_m == pytest.approx(height_m, abs=0.12)


def test_nobody_is_found_in_an_empty_room() -> None:
    assert DETECT(depth_of(), make_view()).detections == ()


@pytest.mark.parametrize("thing", [Block(0.0, 4.0, width_m=1.6), Block(0.0, 4.0, height_m=0.5)])
def test_what_is_too_wide_or_too_low_is_no_human(thing: Block) -> None:
    assert DETECT(depth_of([thing]), make_view()).detections == ()


def test_two_people_are_told_apart_by_depth_though_their_columns_overlap() -> None:
    found = DETECT(depth_of([Block(0.0, 3.5), Block(0.5, 5.0)]), make_view()).detections
    assert [round(one.z_m, 1) for one in found] == [3.5, 5.0]


def test_who_is_cut_off_by_the_image_is_expected_to_be_no_taller_than_what_can_be_seen() -> None:
    (near,) = DETECT(depth_of([Block(0.0, 1.5)]), make_view()).detections
    assert near.probability > 0.3


def test_a_box_begins_at_a_head_behind_the_chest() -> None:
    leaning = [Block(0.0, 1.0 + 0.04 * step, height_m=1.4 + 0.06 * step) for step in range(5)]
    (found,) = DETECT(depth_of(leaning, height_m=1.5), make_view(1.5)).detections
    top = make_view(1.5).calibration.project(np.array([[1.16, 0.0, 1.64]]))[0, 1]
    assert found.box[1] == pytest.approx(top, abs=1.5)


def test_the_printed_size_rates_what_a_camera_sees_of_a_body_lower() -> None:
    seen = (0.45, 1.65, 0.33, 1.65)
    assert PRINTED_SIZE.probability(*seen) < HumanSize().probability(*seen) == pytest.approx(1.0, abs=0.01)
