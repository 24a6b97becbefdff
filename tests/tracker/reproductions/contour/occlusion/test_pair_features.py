from types import SimpleNamespace

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.camera_mount import mount_of
from peopleboy.tracker.reproductions.contour.appearance.appearance_model import ColourModel
from peopleboy.tracker.reproductions.contour.appearance.colour_view import ColourView
from peopleboy.tracker.reproductions.contour.colour_config import ColourDescriptorConfig
from peopleboy.tracker.reproductions.contour.contour_config import ContourConfig
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel
from peopleboy.tracker.reproductions.contour.occlusion.learned_order import shipped_order
from peopleboy.tracker.reproductions.contour.occlusion.pair_features import (
    FEATURES,
    boxes,
    cut,
    overlapping_pairs,
    pair_features,
)
from peopleboy.tracker.reproductions.contour.particle_filter import FrameView


def people(*rows: tuple[float, float, float, float]) -> np.ndarray:
    state = np.zeros((len(rows), 9), np.float32)
    state[:, :4] = rows
    return state


def test_people_whose_boxes_share_nothing_are_no_pair():
    assert overlapping_pairs(people((100, 120, 15, 40), (110, 120, 8, 20), (200, 120, 15, 40))).tolist() == [
        [0, 1]
    ]
    assert overlapping_pairs(people((100, 120, 15, 40), (130.1, 120, 15, 40))).tolist() == []
    assert overlapping_pairs(np.zeros((0, 9))).shape == (0, 2)


def test_a_box_reaches_from_the_top_of_the_head_to_the_feet():
    left, top, right, bottom = boxes(people((100, 120, 15, 44)))[0]
    assert (left, right) == (85, 115)
    assert top == pytest.approx(120 - 44 - 20)
    assert bottom - top == pytest.approx(3.5 * 44, rel=0.01)


rectangles = st.tuples(*[st.floats(0, 50, width=32)] * 4).map(
    lambda r: np.array([r[0], r[1], r[0] + r[2], r[1] + r[3]], np.float32)
)


@given(rectangles, rectangles)
def test_a_cut_lies_inside_of_what_was_cut_and_is_empty_outside_of_the_other(one, other):
    part = cut(one, other)
    assert np.all(part[2:] >= part[:2])
    if np.prod(part[2:] - part[:2]) > 0:
        assert np.all(part[:2] >= np.maximum(one[:2], other[:2]))
        assert np.all(part[2:] <= np.minimum(one[2:], other[2:]))


NEAR, FAR = (150.0, 130.0, 16.0, 42.0), (164.0, 122.0, 10.0, 28.0)
ALONE = ColourDescriptorConfig(affine=(0.0, 1.0, 0.0, 0.0, 0.0, 1.0))


def surroundings(*drawn: int) -> FrameView:
    """A view of the given people, later ones painted over earlier ones: 0 near in red, 1 far in blue."""
    thermal, colour = np.full((240, 320), 10, np.uint8), np.full((240, 320, 3), 128, np.uint8)
    for number in drawn:
        x, y, w, h = (NEAR, FAR)[number]
        cv2.ellipse(thermal, (round(x), round(y)), (round(w), round(h)), 0, 0, 360, 160, cv2.FILLED)
        cv2.circle(thermal, (round(x), round(y - 1.23 * h)), round(0.2 * h), 160, cv2.FILLED)
        left, top, right, bottom = boxes(people((x, y, w, h)))[0].astype(int)
        colour[top:bottom, left:right] = ((200, 40, 40), (40, 40, 200))[number]
    model = ContourModel.build((240, 320), ContourConfig())
    mount = mount_of(None, 240)
    return FrameView(thermal, model, 1 / 15, 0.0, mount, colour=ColourView.build(colour, (240, 320), ALONE))


def known_colours() -> list[ColourModel]:
    return [
        ColourModel.begin(surroundings(number).colour.describe(people((NEAR, FAR)[number]))[0], ALONE)
        for number in (0, 1)
    ]


def test_the_one_in_front_looks_more_like_itself_where_the_two_overlap():
    features = pair_features(people(NEAR, FAR), known_colours(), np.array([[0, 1]]), surroundings(1, 0))[0]
    named = dict(zip(FEATURES, features, strict=True))
    assert named["colour"] > 0.1
    assert named["colour_o"] > 0.3
    assert abs(named["colour_no"]) < 0.05
    assert named["strength"] > 5
    assert named["top"] == pytest.approx((130 - 122 - 16 / 11 * (42 - 28)) / 240, abs=1e-3)
    assert named["bottom"] == pytest.approx((130 - 122 + 2.05 * (42 - 28)) / 240, abs=1e-3)


def test_the_mirrored_pair_has_the_same_features_with_the_sign_turned():
    there_and_back = np.array([[0, 1], [1, 0]])
    one, other = pair_features(people(NEAR, FAR), known_colours(), there_and_back, surroundings(0, 1))
    assert np.allclose(one, -other)
    assert np.all(one != 0)


@pytest.mark.parametrize("models", [[None, None], [None, "known"]])
def test_colours_that_nobody_knows_make_no_difference(models):
    known = known_colours()
    models = [None if model is None else known[1] for model in models]
    features = pair_features(people(NEAR, FAR), models, np.array([[0, 1]]), surroundings(1, 0))[0]
    assert np.all(features[3:] == 0)
    assert np.all(features[:3] != 0)


def test_everybody_is_compared_at_once_as_they_are_two_by_two():
    order = shipped_order("contour")
    models = known_colours()
    states = [NEAR, FAR, (290.0, 120.0, 9.0, 25.0)]
    figures = [
        SimpleNamespace(state=people(state)[0], person=SimpleNamespace(appearance=model, foot=foot))
        for state, model, foot in zip(states, [*models, None], [216.0, 179.0, 171.0], strict=True)
    ]
    view = surroundings(1, 0)
    leads = order(figures, view)
    assert np.array_equal(leads, -leads.T)
    assert leads[0, 1] == order(figures[:2], view)[0, 1] > 0
    assert np.all(leads[2] == 0)


def test_without_pairs_there_are_no_features():
    none = np.zeros((0, 2), np.int64)
    assert pair_features(people(NEAR), [None], none, surroundings(0)).shape == (0, 6)
