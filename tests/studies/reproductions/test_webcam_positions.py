"""Places by webcams: closed forms, calibration from a wrong guess, and the whole measurement."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.studies.reproductions.experiments.webcam_positions import (
    bearings,
    calibrate,
    check_views,
    hat_column,
    measure_webcams,
    triangulate,
)
from tests.helpers.calls.refused import refused

WIDTH = 320
CORNERS = [(0.1, -2.4), (9.9, -2.4), (9.9, 2.4), (0.1, 2.4)]
WEBCAMS = np.array([(x, y, math.atan2(-y, 5.0 - x), math.radians(60.0)) for x, y in CORNERS])


def columns_of(places: np.ndarray) -> np.ndarray:
    """Where in the images (T, 4) [px] hats at places (T, 2) are: a pinhole; NaN outside the image."""
    dx, dy = places[:, None, 0] - WEBCAMS[:, 0], places[:, None, 1] - WEBCAMS[:, 1]
    cosine, sine = np.cos(WEBCAMS[:, 2]), np.sin(WEBCAMS[:, 2])
    ahead, left = dx * cosine + dy * sine, dy * cosine - dx * sine
    focal = WIDTH / 2.0 / np.tan(WEBCAMS[:, 3] / 2.0)
    column = (WIDTH - 1) / 2.0 - focal * left / ahead
    return np.where((ahead > 0.0) & (np.abs(column - 159.5) < 159.0), column, np.nan)


@given(st.lists(st.tuples(st.floats(3.0, 7.0), st.floats(-1.2, 1.2)), min_size=1, max_size=5))
def test_lines_of_sight_meet_where_the_hat_is(places):
    there = np.array(places)
    found = triangulate(bearings(columns_of(there), WEBCAMS, WIDTH), WEBCAMS)
    assert found == pytest.approx(there, abs=1e-9)


def test_one_webcam_alone_tells_no_place():
    columns = np.array([[160.0, np.nan, np.nan, np.nan]])
    assert np.isnan(triangulate(bearings(columns, WEBCAMS, WIDTH), WEBCAMS)).all()


def test_sixteen_numbers_are_found_again_from_known_places():
    rng = np.random.default_rng(1)
    known, new = rng.uniform((2.5, -1.3), (7.5, 1.3), (2, 14, 2))
    guess = WEBCAMS + rng.uniform(-1.0, 1.0, (4, 4)) * (0.2, 0.2, 0.09, 0.05)
    fitted = calibrate(columns_of(known), known, guess, WIDTH)
    found = triangulate(bearings(columns_of(new), fitted, WIDTH), fitted)
    assert np.hypot(*(found - new).T).max() < 1e-4


def test_a_webcam_that_sees_nobody_is_refused():
    known = np.array([[4.0, 0.0], [5.0, 1.0], [6.0, -1.0], [5.0, 0.5], [4.5, -0.5]])
    columns = columns_of(known)
    columns[:, 2] = np.nan
    with refused("webcam 3", "0 known positions", "4 are needed"):
        calibrate(columns, known, WEBCAMS, WIDTH)


def test_webcams_that_look_past_the_known_places_are_refused_before_the_film():
    places = np.array([[4.0, 0.0], [5.0, 1.0], [6.0, -1.0], [5.0, 0.5]])
    check_views(WEBCAMS, places)
    turned = WEBCAMS + np.array([0.0, 0.0, math.pi, 0.0]) * (np.arange(4) == 1)[:, None]
    with refused("webcam 2", "0 of the known positions", "4 are needed"):
        check_views(turned, places)


def test_the_hat_is_found_by_its_colour_and_only_whole():
    image = np.full((240, 320, 3), 170, np.uint8)
    image[100:140, 60:90] = (90, 140, 210)  # a light blue shirt
    cv2.circle(image, (75, 90), 6, (10, 150, 40), -1)
    assert hat_column(image) == pytest.approx(75.0, abs=0.1)
    assert hat_column(np.roll(image, -75, axis=1)) is None
    assert hat_column(np.full((240, 320, 3), 170, np.uint8)) is None


@pytest.mark.heavy
def test_the_measurement_is_as_exact_as_the_paper_says_and_a_skew_spoils_it():
    errors = measure_webcams(0)
    assert errors["in_sample_m"] < 0.01
    assert errors["new_m"] < 0.02
    assert errors["walking_m"] < 0.02
    assert errors["skewed_m"] > 3.0 * errors["walking_m"]
    assert errors["skewed_bearing_deg"] > 3.0 * errors["bearing_deg"]
    assert errors["panorama_truth"].mean < 0.5
    assert errors["panorama_at_once"].mean < 0.5
    assert errors["panorama_skewed"].mean > 2.0 * errors["panorama_truth"].mean
    assert errors["panorama_late"].mean == pytest.approx(2.01, abs=0.4)
