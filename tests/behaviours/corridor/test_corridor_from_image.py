import math

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.behaviours.corridor.corridor_from_image import corridor_from_image
from peopleboy.behaviours.corridor.corridor_geometry import Corridor, Unknown
from tests.helpers.images.drawn_corridors import CAMERA, drawn_corridor


@pytest.mark.slow
@settings(deadline=None, max_examples=30)
@given(offset=st.floats(-0.5, 0.5), heading=st.floats(-0.12, 0.12), width=st.floats(2.2, 3.4))
def test_the_place_in_a_drawn_corridor_is_recovered(offset, heading, width):
    found = corridor_from_image(drawn_corridor(offset, heading, width), CAMERA)
    assert isinstance(found, Corridor), found
    assert abs(found.heading_rad - heading) < math.radians(0.5)
    assert abs(found.offset_m - offset) < 0.06
    assert abs(found.width_m - width) < 0.12


def test_half_the_light_changes_nothing():
    found = corridor_from_image(drawn_corridor(0.3, 0.05, 3.0, light=0.5), CAMERA)
    assert isinstance(found, Corridor)
    assert found.offset_m == pytest.approx(0.3, abs=0.06)


def test_in_the_dark_it_does_not_know():
    assert corridor_from_image(drawn_corridor(0.0, 0.0, 3.0, light=0.0), CAMERA) == Unknown("too dark")


def test_without_an_image_or_lines_it_does_not_know():
    assert corridor_from_image(None, CAMERA) == Unknown("no image")
    flat = np.full((240, 320, 3), 128, np.uint8)
    assert corridor_from_image(flat, CAMERA) == Unknown("too few lines")


def test_lines_that_run_anyhow_do_not_agree():
    rng = np.random.default_rng(0)
    image = np.full((240, 320, 3), 200, np.uint8)
    for _ in range(25):
        (a, b, c, d), grey = rng.integers(0, 240, 4), int(rng.integers(0, 150))
        cv2.line(image, (int(a), int(b)), (int(c), int(d)), (grey, grey, grey), 3)
    assert corridor_from_image(image, CAMERA) == Unknown("the lines do not meet")


def test_lines_far_from_where_the_robot_was_are_not_believed():
    expected = Corridor(offset_m=-0.9, heading_rad=0.0, width_m=3.0)
    found = corridor_from_image(drawn_corridor(0.3, 0.0, 3.0), CAMERA, expected)
    assert found == Unknown("the lines do not match the predicted pose")
