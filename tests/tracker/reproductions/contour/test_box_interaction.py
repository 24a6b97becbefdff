import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.tracker.reproductions.contour.box_interaction import (
    PERSON_M,
    WIDEST_RAD,
    WIDTH_M,
    box_of,
    detector_factor,
    overlap_shares,
    person_factor,
    places_on_floor,
    regions_of,
    standing_box,
)
from peopleboy.tracker.reproductions.contour.contour_config import BoxConfig, InteractionConfig, TrackerConfig
from peopleboy.tracker.reproductions.contour.variants import PAPER, THESIS
from peopleboy.tracker.track import FloorPlace, Status

CONFIG = TrackerConfig()
FOCAL_PX, CAMERA_M = 400.0, (0.1, 0.0, 1.2)
FORWARD = np.array([[0.0, 0, 1, 0.1], [-1, 0, 0, 0], [0, -1, 0, 1.2], [0, 0, 0, 1]])
CAMERA = PinholeCalibration(
    intrinsics=np.array([[FOCAL_PX, 0, 159.5], [0, FOCAL_PX, 119.5], [0, 0, 1.0]]), robot_from_camera=FORWARD
)
TALL = np.array([100.0, 120.0, 12.0, 44.0, 3.0, 0.0, 0.0, 0.0, 0.0])


def state(x=100.0, y=120.0, w=10.0, h=30.0):
    return np.array([x, y, w, h, 0, 0, 0, 0, 0], dtype=np.float32)


def test_the_thesis_box_is_2_w_by_3_5_h_from_the_top_of_the_head():
    assert box_of(TALL, BoxConfig()) == pytest.approx((88, 120 - 44 - 20, 24, 154))
    assert THESIS.box.height_per_h == 3.5


def test_the_paper_box_is_3_h_high():
    assert box_of(TALL, PAPER.box)[3] == pytest.approx(132)


def test_hair_raises_the_top_of_the_box_and_nothing_else():
    bald, haired = (box_of(TALL, BoxConfig(hair_per_h=hair)) for hair in (0.0, 0.1))
    assert haired == pytest.approx((bald[0], bald[1] - 4.4, bald[2], bald[3]))


def test_the_region_is_the_box_that_is_shown():
    region = regions_of([state()], CONFIG)[0]
    box = box_of(state(), CONFIG.box)
    assert region == pytest.approx(box, rel=1e-6)


def test_a_sample_on_a_person_overlaps_it_wholly_and_one_beside_it_not_at_all():
    shares = overlap_shares(np.stack([state(), state(x=120.0)]), regions_of([state()], CONFIG), CONFIG)
    assert shares[:, 0] == pytest.approx([1.0, 0.0], abs=1e-6)


def test_half_a_width_aside_half_of_the_sample_overlaps():
    shares = overlap_shares(state(x=110.0)[None], regions_of([state()], CONFIG), CONFIG)
    assert shares[0, 0] == pytest.approx(0.5, abs=1e-5)


@settings(deadline=None, max_examples=30)
@given(
    st.lists(st.tuples(*[st.floats(5, 200)] * 4), min_size=1, max_size=5),
    st.lists(st.tuples(*[st.floats(5, 200)] * 4), min_size=1, max_size=5),
)
def test_overlaps_agree_with_counting_by_hand(samples, people):
    sample = np.array([state(*row) for row in samples])
    regions = regions_of([state(*row) for row in people], CONFIG)
    shares = overlap_shares(sample, regions, CONFIG)
    for i, (left, top, width, height) in enumerate(regions_of(list(sample), CONFIG).astype(float)):
        for j, (other_left, other_top, other_width, other_height) in enumerate(regions.astype(float)):
            across = min(left + width, other_left + other_width) - max(left, other_left)
            down = min(top + height, other_top + other_height) - max(top, other_top)
            assert shares[i, j] == pytest.approx(
                max(across, 0) * max(down, 0) / (width * height), rel=1e-3, abs=1e-4
            )


def test_a_persons_samples_are_penalised_once_by_the_overlap_that_costs_most():
    shares = np.array([[0.0, 0.0], [0.5, 0.25], [0.2, 1.0]], dtype=np.float32)
    factor = person_factor(shares, np.array([2.0, 0.5]))
    assert factor == pytest.approx(np.exp([0.0, -1.0, -0.5]), rel=1e-6)


def test_alone_nobody_is_penalised():
    assert (person_factor(np.zeros((4, 0), dtype=np.float32), np.zeros(0)) == 1).all()


@pytest.mark.parametrize("overlap", [0.0, 0.3])
def test_a_detectors_samples_are_penalised_once_however_many_they_overlap(overlap):
    config = TrackerConfig(interaction=InteractionConfig(detector_overlap=overlap))
    rng = np.random.default_rng(3)
    samples = np.array([state(*row) for row in rng.uniform([0, 0, 2, 5], [320, 240, 40, 90], (200, 4))])
    people = list(samples[:3] + rng.normal(0.0, 4.0, (3, 9)).astype(np.float32))
    regions = regions_of(people, config)
    ours = overlap_shares(samples, regions, config)
    drawn = regions_of(list(samples), config)
    theirs = np.stack([overlap_shares(each[None], drawn, config)[0] for each in people], axis=1)
    overlaps = (np.maximum(ours, theirs) > np.float32(overlap)).any(axis=1)
    factor = detector_factor(samples, regions, config)
    assert 0 < overlaps.sum() < len(samples)
    assert np.array_equal(factor, np.where(overlaps, np.float32(0.01), np.float32(1)))


@pytest.mark.parametrize("wrong", [{"penalty": -1.0}, {"detector_penalty": 1.5}, {"occluded_penalty": -0.1}])
def test_impossible_interactions_are_refused(wrong):
    with pytest.raises(BadInput, match=next(iter(wrong))):
        replace(InteractionConfig(), **wrong)


def standing(x, y):
    return standing_box(FloorPlace(position_m=(x, y), covariance_m2=(0.1, 0.0, 0.1)), CAMERA)


def test_who_stands_ahead_has_the_box_of_similar_triangles():
    left, top, width, height = standing(4.1, 0.0)
    assert height == pytest.approx(FOCAL_PX * PERSON_M / 4.0)
    assert width == pytest.approx(FOCAL_PX * WIDTH_M / 4.0)
    assert left + width / 2 == pytest.approx(159.5)
    assert top + height == pytest.approx(119.5 + FOCAL_PX * 1.2 / 4.0)


@given(st.floats(1.0, 8.0), st.floats(-1.0, 1.0))
def test_a_standing_box_has_its_middle_where_the_place_is(x, y):
    left, _, width, height = standing(x + 0.1, y)
    assert left + width / 2 == pytest.approx(159.5 - FOCAL_PX * y / x)
    assert height == pytest.approx(FOCAL_PX * PERSON_M / x)


@given(st.floats(1.5, 8.0), st.floats(-0.8, 0.8))
def test_the_place_that_a_standing_box_tells_is_that_of_who_stands_there(x, y):
    (place,) = places_on_floor([stretched(standing(x + 0.1, y))], [Status.TRACKED], CAMERA)
    assert place.position_m == pytest.approx((x + 0.1, y), rel=1e-6, abs=1e-6)


def stretched(box):
    """Boxes of the tracker end a little below the feet."""
    left, top, width, height = box
    return left, top, width, height / 0.98


@given(st.floats(-8.0, 8.0), st.floats(0.1, 8.0))
def test_who_is_aside_or_behind_is_outside_the_image_on_that_side(x, y):
    if abs(math.atan2(y, x - 0.1)) < math.radians(40):
        return
    left_side, right_side = standing(x, y), standing(x, -y)
    assert np.isfinite([*left_side, *right_side]).all()
    assert left_side[0] + left_side[2] / 2 < -0.5
    assert right_side[0] + right_side[2] / 2 > 319.5
    if abs(math.atan2(y, x - 0.1)) >= WIDEST_RAD:
        assert left_side[0] + left_side[2] / 2 == pytest.approx(159.5 - FOCAL_PX * math.tan(WIDEST_RAD))
