import math

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.sim.cameras.kinds import affine_between
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.tracker.reproductions.contour.appearance.colour_view import ColourView
from peopleboy.tracker.reproductions.contour.appearance.regions import (
    aligned,
    alignment,
    part_rectangles,
    pixel_bounds,
)
from peopleboy.tracker.reproductions.contour.colour_config import (
    FAR_AFFINE,
    REPRESENTATIONS,
    ROBOT_PARALLAX,
    SPACES,
    THESIS_AFFINE,
    ColourDescriptorConfig,
)
from tests.helpers.calls.refused import refused

SHAPE = (240, 320)
SAME = (0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
HEAD, TORSO, LEGS = (40, 90, 200), (250, 30, 10), (5, 60, 120)


def person(x=160.0, y=125.0, w=13.0, h=35.0, d=0.0) -> np.ndarray:
    return np.array([[x, y, w, h, d, 0, 0, 0, 0]], np.float32)


def painted(state: np.ndarray, size: int = 1) -> np.ndarray:
    """A colour image, as large as the thermal one times `size`, of a person in three colours."""
    image = np.full((SHAPE[0] * size, SHAPE[1] * size, 3), 128, np.uint8)
    for rectangle, colour in zip(part_rectangles(state)[0], (HEAD, TORSO, LEGS), strict=True):
        left, top, right, bottom = pixel_bounds(((rectangle + 0.5) * size - 0.5)[None, None])[0]
        image[top:bottom, left:right] = colour
    return image


def place(matrix: np.ndarray, u: float, v: float, h: float = 0.0) -> np.ndarray:
    rectangle = np.array([[[u, v, u, v]]], np.float32)
    return aligned(matrix, rectangle, np.array([h], np.float32))[0, 0, :2]


@given(
    u=st.floats(0, 319),
    v=st.floats(0, 239),
    p1=st.floats(-0.3, 0.3),
    p3=st.floats(-0.2, 0.2),
    p4=st.floats(-0.3, 0.3),
)
def test_the_alignment_is_equation_6_1_in_shares_of_the_images(u, v, p1, p3, p4):
    x, y = place(alignment(SHAPE, (480, 640), (p1, 1.2, p3, p4, 0.05, 1.1), 0.0), u, v)
    share_u, share_v = (u + 0.5) / 320, (v + 0.5) / 240
    assert (x + 0.5) / 640 == pytest.approx(p1 + 1.2 * share_u + p3 * share_v, abs=1e-5)
    assert (y + 0.5) / 480 == pytest.approx(p4 + 0.05 * share_u + 1.1 * share_v, abs=1e-5)


def worst_shift(config: ColourDescriptorConfig, height_m: float = 1.72) -> float:
    """Largest distance [px] from the exact map, over people 3 to 10 m away and the whole image."""
    robot = RobotConfig()
    matrix = alignment(SHAPE, SHAPE, config.affine, config.parallax)
    worst = 0.0
    for depth in np.linspace(3, 10, 15):
        exact = affine_between(robot.cameras["thermal"].camera, robot.cameras["colour"].camera, depth)
        h = robot.cameras["thermal"].camera.focal_px * height_m / depth / 3.5
        for u, v in [(0, 0), (160, 120), (319, 239)]:
            worst = max(worst, math.dist(place(matrix, u, v, h), exact @ (u, v, 1)))
    return worst


def test_the_default_alignment_fits_the_robots_cameras_within_one_percent_of_the_image():
    assert worst_shift(ColourDescriptorConfig()) < 3.6


@pytest.mark.parametrize("height_m", [1.5, 1.72, 1.95])
def test_with_a_parallax_the_alignment_fits_people_of_any_height_at_every_distance(height_m):
    config = ColourDescriptorConfig(affine=FAR_AFFINE, parallax=ROBOT_PARALLAX)
    assert worst_shift(config, height_m) < 1.2


def test_the_thesis_alignment_belongs_to_other_cameras():
    assert worst_shift(ColourDescriptorConfig(affine=THESIS_AFFINE)) > 15


@pytest.mark.parametrize("size", [1, 2])
def test_every_part_is_described_by_its_own_colour_at_any_size_of_the_colour_image(size):
    state = person()
    view = ColourView.build(painted(state, size), SHAPE, ColourDescriptorConfig(affine=SAME))
    described = view.describe(state).reshape(3, 3, 3)
    assert described[:, :, 0] * 255 == pytest.approx(np.array([HEAD, TORSO, LEGS], float), abs=1e-3)
    assert np.all(described[:, :, 1:] == 0)


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize("representation", REPRESENTATIONS)
def test_every_way_to_describe_tells_the_right_place_from_a_wrong_one(representation, space):
    state = person()
    config = ColourDescriptorConfig(affine=SAME, representation=representation, space=space)
    features = ColourView.build(painted(state), SHAPE, config).describe(
        np.concatenate([state, state, person(x=190)])
    )
    assert features.shape == (3, 3 * SPACES[space] * (REPRESENTATIONS[representation] or 20))
    assert np.array_equal(features[0], features[1])
    assert np.linalg.norm(features[0] - features[2]) > 0.3


def test_red_on_both_sides_of_hue_zero_is_one_colour():
    hsv = np.full((*SHAPE, 3), 255, np.uint8)
    means = []
    for hue in (2, 253):
        hsv[..., 0] = hue
        view = ColourView.build(
            cv2.cvtColor(hsv, cv2.COLOR_HSV2RGB_FULL),
            SHAPE,
            ColourDescriptorConfig(space="hsv", representation="moments1"),
        )
        means.append(view.describe(person()))
    assert np.abs(means[0] - means[1]).max() < 0.06


def test_who_leaves_the_colour_image_becomes_unseen_part_by_part():
    states = np.concatenate([person(x=160), person(x=300), person(y=195)])
    view = ColourView.build(np.full((*SHAPE, 3), 99, np.uint8), SHAPE, ColourDescriptorConfig())
    is_unseen = np.isnan(view.describe(states)).reshape(3, 3, 9).all(axis=2)
    assert is_unseen.tolist() == [[False] * 3, [True] * 3, [False, False, True]]


def test_what_another_person_covers_can_be_left_out_or_described_alone():
    state = person()
    image = painted(state)
    rectangles = part_rectangles(state)
    hole = rectangles.copy()
    hole[..., 2] = 160
    image[:, :160] = 255
    view = ColourView.build(image, SHAPE, ColourDescriptorConfig(affine=SAME))
    visible = view.describe_rectangles(rectangles, state[:, 3], hole).reshape(3, 3, 3)
    covered = view.describe_rectangles(hole, state[:, 3]).reshape(3, 3, 3)
    assert visible[:, :, 0] * 255 == pytest.approx(np.array([HEAD, TORSO, LEGS], float), abs=1e-3)
    assert covered[:, :, 0] == pytest.approx(np.ones((3, 3)))


def test_stray_samples_are_described_as_unseen_and_break_nothing():
    states = np.concatenate([person(h=-5), person(w=-5), person(x=1e30), person(y=-1e9, h=1e12)])
    view = ColourView.build(np.zeros((*SHAPE, 3), np.uint8), SHAPE, ColourDescriptorConfig())
    assert view.describe(states).shape == (4, 27)


@pytest.mark.parametrize(
    ("setting", "right"),
    [
        ({"representation": "moment3"}, "moments3"),
        ({"space": "lab"}, "rgb, grey, hsv"),
        ({"affine": (0.0, 1.0, 0.0)}, "6 finite numbers"),
        ({"affine": (0.0, float("nan"), 0.0, 0.0, 0.0, 1.0)}, "6 finite numbers"),
        ({"affine": (0.0, -1.0, 0.0, 0.0, 0.0, 1.0)}, "positive"),
        ({"parallax": float("inf")}, "finite"),
        ({"frames": 0}, "positive"),
        ({"sharpness": -1.0}, "0 or more"),
    ],
)
def test_settings_that_cannot_be_are_refused(setting, right):
    with refused(*setting, right):
        ColourDescriptorConfig(**setting)
