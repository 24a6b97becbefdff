"""Errors on the floor: closed forms, and a second computation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.evaluation.evaluate import combine, evaluate
from peopleboy.tracker.evaluation.floor import (
    CHI2_95,
    NOWHERE,
    FloorErrors,
    Places,
    floor_squares,
)
from peopleboy.tracker.evaluation.table import to_json
from tests.helpers.calls.refused import refused
from tests.helpers.images.random_sequences import tracks_of, truth_of

BOX = (10, 10, 20, 60)
PEOPLE = truth_of([(1, 1, *BOX), (2, 1, *BOX), (2, 2, 200, 10, 20, 60)])
# Ids are the other way round, and one track lies on nobody.
TRACKS = tracks_of([(1, 7, *BOX), (2, 7, 200, 10, 20, 60), (2, 3, *BOX), (1, 9, 100, 10, 20, 60)])


def places(rows: list[tuple[float, ...]]) -> Places:
    table = np.array(rows, dtype=float)
    return Places(
        frame=table[:, 0].astype(int),
        id=table[:, 1].astype(int),
        position_m=table[:, 2:4],
        covariance_m2=table[:, 4:] if table.shape[1] > 4 else None,
    )


STANDING = places([(1, 1, 5.0, 0.0), (2, 1, 5.0, 1.0), (2, 2, 8.0, -1.0)])
ROUND = (0.04, 0.0, 0.04)
BELIEVED = places(
    [(1, 7, 5.3, 0.4, *ROUND), (2, 3, 5.0, 1.0, *ROUND), (2, 7, 8.0, -1.2, *ROUND), (1, 9, 0, 0, *ROUND)]
)


def test_errors_are_those_of_matched_pairs_alone():
    floor = evaluate(PEOPLE, TRACKS, standing=STANDING, believed=BELIEVED).floor
    assert len(floor) == 3
    assert sorted(np.hypot(*floor.offset_m.T)) == pytest.approx([0.0, 0.2, 0.5])
    assert floor.mean_m == pytest.approx(0.7 / 3.0)
    assert floor.median_m == pytest.approx(0.2)
    assert floor.p95_m == pytest.approx(0.2 + 0.9 * 0.3)
    assert floor.nees == pytest.approx((0.0 + 1.0 + 6.25) / 3.0)
    assert floor.inside == pytest.approx(200.0 / 3.0)


def test_what_nobody_says_is_not_scored():
    assert "floor" not in to_json(evaluate(PEOPLE, TRACKS))
    assert len(evaluate(PEOPLE, TRACKS, standing=STANDING).floor) == 0
    assert math.isnan(NOWHERE.mean_m)
    assert math.isnan(NOWHERE.nees)
    partly = places([(2, 3, 5.0, 1.5, *ROUND)])
    assert evaluate(PEOPLE, TRACKS, standing=STANDING, believed=partly).floor.mean_m == pytest.approx(0.5)


def test_sequences_are_taken_together_error_by_error():
    one = evaluate(PEOPLE, TRACKS, standing=STANDING, believed=BELIEVED)
    both = combine([one, evaluate(PEOPLE, TRACKS), one]).floor
    assert len(both) == 6
    assert both.p95_m == pytest.approx(0.5)


@given(st.floats(0.05, 2.0), st.floats(0.05, 2.0), st.floats(-0.95, 0.95), st.integers(0, 2**31))
def test_honest_covariances_are_found_to_be_honest(a, b, correlation, seed):
    xx, xy, yy = a * a, correlation * a * b, b * b
    errors = np.random.default_rng(seed).multivariate_normal((0, 0), [[xx, xy], [xy, yy]], 4000)
    floor = FloorErrors(errors, np.tile([xx, xy, yy], (4000, 1)))
    assert floor.nees == pytest.approx(2.0, abs=0.2)
    assert floor.inside == pytest.approx(95.0, abs=2.0)
    inverse = np.linalg.inv([[xx, xy], [xy, yy]])
    assert floor.nees == pytest.approx(np.mean([e @ inverse @ e for e in errors]), rel=1e-6)


def test_the_ellipse_is_that_of_95_percent():
    assert chi2.cdf(CHI2_95, 2) == pytest.approx(0.95, abs=1e-4)


def test_a_covariance_that_claims_to_know_all_is_left_out_of_honesty():
    floor = FloorErrors(np.array([[0.1, 0.0]]), np.zeros((1, 3)))
    assert floor.mean_m == pytest.approx(0.1)
    assert math.isnan(floor.nees)


def test_squares_on_the_floor_match_up_to_half_a_metre():
    here = floor_squares(np.array([3.0, 1.0]))
    assert iou(here, floor_squares(np.array([3.49, 1.0]))) > 0.5
    assert iou(here, floor_squares(np.array([3.0, 1.51]))) < 0.5


def test_columns_that_do_not_belong_together_are_refused():
    with refused("places", "(2,)", "(3, 2)"):
        Places(frame=np.array([1, 2]), id=np.array([1, 2]), position_m=np.zeros((3, 2)))
