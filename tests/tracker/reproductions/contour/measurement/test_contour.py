from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.contour.contour_config import ContourConfig
from peopleboy.tracker.reproductions.contour.measurement.contour import (
    FEET,
    HEAD_ASPECT,
    HEAD_LEFT,
    HEAD_RIGHT,
    HEAD_TOP,
    NECK_DEG,
    SHOULDER_LEFT,
    SHOULDER_RIGHT,
    SIDE_LEFT,
    SIDE_RIGHT,
    body_points,
    build_probes,
    build_response,
    head_points,
    section_angles,
    section_weights,
)
from peopleboy.tracker.reproductions.contour.measurement.likelihood import (
    ContourModel,
    clutter_of,
    person_grey,
    pixels_under,
)
from peopleboy.tracker.reproductions.contour.particles import HEAD_DIVISOR
from peopleboy.tracker.reproductions.contour.variants import CONTOUR, THESIS
from tests.helpers.images.drawn_people import BACKGROUND, RADIATOR, WARM, blank, draw_person, fill_ellipse

LITERAL = ContourConfig()


def test_the_body_sections_cover_the_whole_ellipse_without_gap_or_overlap():
    angles = section_angles(LITERAL)
    arcs = [angles[s] for s in (SIDE_LEFT, SHOULDER_LEFT, SHOULDER_RIGHT, SIDE_RIGHT)]
    assert arcs[0][0] == pytest.approx(-np.pi)
    assert arcs[-1][1] == pytest.approx(np.pi)
    assert all(one[1] == pytest.approx(next_one[0]) for one, next_one in pairwise(arcs))


def test_the_head_sections_cover_its_ellipse_but_for_the_neck():
    angles = section_angles(LITERAL)
    assert angles[HEAD_LEFT][1] == pytest.approx(angles[HEAD_TOP][0])
    assert angles[HEAD_TOP][1] == pytest.approx(angles[HEAD_RIGHT][0])
    open_at_the_neck = 2 * np.pi - (angles[HEAD_RIGHT][1] - angles[HEAD_LEFT][0])
    assert open_at_the_neck == pytest.approx(np.radians(NECK_DEG))


def test_points_lie_on_their_ellipses():
    angle = np.linspace(-np.pi, np.pi, 50)
    mix = np.array([3.0, 12.0, 30.0, 1.0])  # d, w, h, 1
    body = body_points(angle, np.zeros(50), 0.0) @ mix
    assert np.allclose((body[:, 0] / 12) ** 2 + (body[:, 1] / 30) ** 2, 1, atol=1e-5)
    head = head_points(angle, np.zeros(50), 0.0) @ mix
    tall = 30 / 4.4
    assert np.allclose(
        ((head[:, 0] - 3) / (0.75 * tall)) ** 2 + ((head[:, 1] + 30 + tall) / tall) ** 2, 1, atol=1e-5
    )


def test_the_head_stands_on_top_of_the_body():
    bottom = head_points(np.array([np.pi]), np.zeros(1), 0.0) @ np.array([0, 12.0, 30.0, 1])
    assert np.allclose(bottom, [[0, -30]], atol=1e-5)


@pytest.mark.parametrize("config", [LITERAL, THESIS.contour, CONTOUR.contour])
def test_inner_points_lie_inside_and_outer_points_outside_of_the_contour(config):
    probes = build_probes(config, 1.0)
    mix = np.array([0.0, 20.0, 50.0, 1.0])
    for points, sign in ((probes.inner @ mix, -1), (probes.outer @ mix, 1)):
        on_body = np.isin(probes.section, (SHOULDER_LEFT, SHOULDER_RIGHT, SIDE_LEFT, SIDE_RIGHT))
        body = points[on_body]
        assert np.all(sign * ((body[:, 0] / 20) ** 2 + (body[:, 1] / 50) ** 2 - 1) > 0)


@pytest.mark.parametrize("x", [160.0, 4.0, np.nan, 1e20])
def test_the_pixels_under_a_contour_are_those_nearest_to_its_points(x):
    probes = build_probes(CONTOUR.contour, 1.0)
    state = np.array([x, 120, 12, 30, 3, 0, 0, 0, 0], np.float32)
    points = np.concatenate([probes.inner, probes.outer]) @ np.array([3.0, 12, 30, 1]) + (x, 120)
    inside = ((points >= -0.5) & (points < (319.5, 239.5))).all(axis=1)
    nearest = np.floor(np.where(inside[:, None], points, 0) + 0.5).astype(int)
    expected = np.where(inside, nearest @ (1, 320), -1)
    assert np.array_equal(pixels_under(state, probes, (240, 320)), expected)


def literal_difference(image, x, y, w, h, config, section):
    """Compute a section's mean difference by its definition, point by point."""
    start, end = section_angles(config)[section]
    tall = h / HEAD_DIVISOR
    is_head = section in (HEAD_LEFT, HEAD_TOP, HEAD_RIGHT)
    a, b = (HEAD_ASPECT * tall, tall) if is_head else (w, h)
    middle = y - h - tall if is_head else y
    differences = []
    for k in range(config.points):
        angle = start + (end - start) * (k + 0.5) / config.points
        grey = []
        for reach in (-config.reach_px, config.reach_px):
            u = x + (a + reach) * np.sin(angle)
            v = middle - (b + reach) * np.cos(angle)
            grey.append(int(image[int(np.floor(v + 0.5)), int(np.floor(u + 0.5))]))
        differences.append(grey[0] - grey[1])
    return np.mean(differences)


def test_section_differences_equal_their_definition_on_a_random_image():
    image = np.random.default_rng(0).integers(0, 256, (240, 320), dtype=np.uint8)
    state = np.array([[150.3, 118.7, 17.2, 41.9, 0, 0, 0, 0, 0]], dtype=np.float32)
    measured = ContourModel.build(image.shape, LITERAL).differences(image, state)[0]
    for section in range(FEET):
        expected = literal_difference(image, 150.3, 118.7, 17.2, 41.9, LITERAL, section)
        assert measured[section] == pytest.approx(expected, abs=1e-3)


def test_a_filled_contour_has_the_full_difference_in_every_section():
    image = blank()
    fill_ellipse(image, 150, 130, 20, 50)
    fill_ellipse(image, 150, 130 - 50 - 50 / 4.4, 0.75 * 50 / 4.4, 50 / 4.4)
    state = np.array([[150, 130, 20, 50, 0, 0, 0, 0, 0]], dtype=np.float32)
    measured = ContourModel.build(image.shape, LITERAL).differences(image, state)[0]
    # The lowest head points and the highest shoulder points look across the neck.
    assert np.all(measured[:FEET] > 0.7 * (WARM - BACKGROUND))


def test_the_feet_section_peaks_at_the_line_under_the_feet():
    image = blank()
    draw_person(image, 150, 110, 14, 36)
    h = np.linspace(28, 46, 37)
    state = np.zeros((len(h), 9), dtype=np.float32)
    # All samples share the top of the head.
    state[:, 0], state[:, 2], state[:, 3] = 150, 14, h
    state[:, 1] = 110 + (h - 36) * (1 + 2 / 4.4)
    feet = ContourModel.build(image.shape, CONTOUR.contour).differences(image, state)[:, FEET]
    assert h[feet > 0.9 * feet.max()].mean() == pytest.approx(36, rel=0.06)


def test_a_point_outside_the_image_counts_as_unseen():
    state = np.array([[-500, 120, 20, 50, 0, 0, 0, 0, 0]], dtype=np.float32)
    config = ContourConfig(unseen_response=0.25)
    assert np.allclose(ContourModel.build((240, 320), config).differences(blank(), state)[0, :FEET], 0.25)


def test_of_a_head_above_the_image_the_rest_speaks() -> None:
    image = blank()
    draw_person(image, 150, 40, 18, 44)
    state = np.array([[150, 40, 18, 44, 0, 0, 0, 0, 0]], dtype=np.float32)
    cut = replace(CONTOUR.contour, unseen_share=CONTOUR.contour.cut_share)
    weights = section_weights(cut)
    plain, filled = (
        float(ContourModel.build(image.shape, config).differences(image, state)[0] @ weights)
        for config in (CONTOUR.contour, cut)
    )
    assert plain < CONTOUR.likelihood.threshold + 0.1 < filled


def test_what_covers_without_weight_leaves_the_others_as_they_are() -> None:
    image = blank()
    draw_person(image, 150, 110, 18, 40)
    marked = image.copy()
    marked[:, 150:] = 0
    state = np.array([[150, 110, 18, 40, 0, 0, 0, 0, 0]], dtype=np.float32)
    model = ContourModel.build(image.shape, replace(CONTOUR.contour, feet_weight=0.0))
    whole = model.differences(np.maximum(image, 1), state)[0]
    half = model.differences(np.maximum(marked, (marked > 0).astype(np.uint8)), state, 0.0, 0.0)[0]
    assert half[SIDE_LEFT] == pytest.approx(whole[SIDE_LEFT], abs=1e-5)
    assert half @ model.weights == pytest.approx(whole @ model.weights, abs=0.1)


def test_clutter_is_what_most_pixels_differ_by_and_people_are_none() -> None:
    flat = blank()
    draw_person(flat, 150, 110, 18, 40)
    assert clutter_of(flat) == 0
    checked = np.where(np.indices((240, 320)).sum(axis=0) // 8 % 2, 30, 60).astype(np.uint8)
    assert clutter_of(checked) == 30


def test_in_clutter_the_response_bends_later_and_never_earlier() -> None:
    model = ContourModel.build((240, 320), CONTOUR.contour)
    assert model.amid(0.0) is model
    bent = model.amid(30.0).response[HEAD_TOP]
    assert (np.abs(bent) <= np.abs(model.response[HEAD_TOP])).all()
    assert bent[255 + 60] == pytest.approx(np.tanh(1.0))


def test_only_on_a_scale_that_shows_the_room_black_is_its_end_too_hot_for_people() -> None:
    config = ContourConfig(hottest_grey=250, dark_share=0.7)
    image = np.zeros((240, 320), np.uint8)
    image[100:120, 50:90] = 255
    assert not person_grey(image, config).any()
    warmer = np.maximum(image, 40)
    assert np.array_equal(person_grey(warmer, config), warmer)


def test_the_response_is_odd_for_the_head_and_saturates():
    response = build_response(ContourConfig(saturation_grey=18.0, cold_response=-0.3))
    assert np.allclose(response[HEAD_TOP], -response[HEAD_TOP][::-1])
    assert response[HEAD_TOP, -1] == pytest.approx(1)
    assert response[SIDE_LEFT, 0] == pytest.approx(0.3)
    assert response[FEET, 0] == pytest.approx(-1)


def test_section_weights_sum_to_one():
    assert section_weights(LITERAL).sum() == pytest.approx(1)
    assert section_weights(CONTOUR.contour).sum() == pytest.approx(1)
    assert np.allclose(section_weights(LITERAL)[:FEET], (0.18, 0.18, 0.18, 0.07, 0.07, 0.16, 0.16))


def test_what_is_too_hot_becomes_cold_with_a_margin_and_the_rest_stays():
    image = blank()
    image[100:120, 50:90] = RADIATOR
    image[100:120, 200:240] = WARM
    dark = person_grey(image, ContourConfig(hottest_grey=250, hot_margin_px=2))
    assert not dark[98:122, 48:92].any()
    assert np.array_equal(dark[:, 100:], image[:, 100:])
    assert dark[97, 60] == BACKGROUND


@pytest.mark.parametrize("bad", [{"points": 0}, {"feet_weight": -1.0}, {"reach_px": float("nan")}])
def test_a_contour_that_cannot_be_is_refused(bad):
    with pytest.raises(BadInput, match="ContourConfig"):
        ContourConfig(**bad)


def test_a_response_that_is_cut_off_is_linear_up_to_there_and_flat_beyond():
    response = build_response(ContourConfig(saturation_grey=40.0, is_cut_off=True))
    difference = np.arange(-255, 256)
    assert np.allclose(response[:, abs(difference) <= 40], difference[abs(difference) <= 40] / 40)
    assert np.all(response[:, difference > 40] == 1)
    assert np.all(response[:, difference < -40] == -1)
