"""Tests of people's paths in metres."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.by_detection.config import PathConfig
from peopleboy.tracker.by_detection.paths import advanced, begun, boxes_of, corrected, distances
from peopleboy.tracker.by_detection.viewpoint import Viewpoint
from peopleboy.tracker.frame import Odometry
from tests.tracker.by_detection.test_viewpoint import SHAPE, calibration

VIEW = Viewpoint.of(calibration(0.0, 1.2), SHAPE)
CONFIG = PathConfig()
RATIO = np.array([0.27])


def box_at(feet: np.ndarray, build: float = 0.0) -> np.ndarray:
    """Give the box (1, 4) of somebody with these feet."""
    column, head, foot = VIEW.seen(feet[None], np.array([build]))[0]
    height = foot - head
    return np.array([[column - 0.135 * height, foot - height, 0.27 * height, height]])


def test_who_walks_evenly_is_expected_where_he_is() -> None:
    feet, walk = np.array([-1.0, 1.2, 6.0]), np.array([0.8, 0.0, -0.3])
    paths = begun(box_at(feet), VIEW, CONFIG)
    for number in range(1, 60):
        paths = advanced(paths, 1 / 15, Odometry(), CONFIG)
        paths = corrected(paths, box_at(feet + walk * number / 15), VIEW, CONFIG)
    later = advanced(paths, 1.0, Odometry(), CONFIG)
    assert later.mean[0, :3] == pytest.approx(feet + walk * (59 / 15 + 1.0), abs=0.05)
    assert paths.mean[0, 3:6] == pytest.approx(walk, abs=0.02)


@given(st.floats(-0.2, 0.2), st.floats(-0.1, 0.3), st.floats(-0.1, 0.1))
def test_the_robots_own_motion_moves_nobody_in_the_world(turn: float, ahead: float, aside: float) -> None:
    feet = np.array([0.7, 1.2, 5.0])
    paths = begun(box_at(feet), VIEW, CONFIG)
    moved = advanced(paths, 1e-6, Odometry(advance_m=ahead, aside_m=aside, turn_rad=turn), CONFIG)
    # The same in the robot's frame: x ahead, y to the left.
    x, y = 5.0 - ahead, -0.7 - aside
    forward = np.cos(turn) * x + np.sin(turn) * y
    left = -np.sin(turn) * x + np.cos(turn) * y
    assert moved.mean[0, :3] == pytest.approx([-left, 1.2, forward], abs=1e-4)


def test_covariances_stay_symmetric_and_positive() -> None:
    feet = np.array([0.5, 1.2, 4.0])
    paths = begun(box_at(feet), VIEW, CONFIG)
    for _ in range(30):
        paths = advanced(paths, 1 / 15, Odometry(turn_rad=0.02), CONFIG)
        paths = corrected(paths, box_at(feet), VIEW, CONFIG)
    covariance = paths.covariance[0]
    assert covariance == pytest.approx(covariance.T, abs=1e-9)
    assert np.linalg.eigvalsh(covariance).min() > 0.0


def test_a_path_has_the_box_that_it_was_begun_with() -> None:
    box = box_at(np.array([0.5, 1.2, 4.0]))
    assert boxes_of(begun(box, VIEW, CONFIG), VIEW, RATIO) == pytest.approx(box, abs=1e-6)


def test_the_farther_a_proposal_lies_the_greater_is_its_distance() -> None:
    box = box_at(np.array([0.5, 1.2, 4.0]))
    paths = begun(box, VIEW, CONFIG)
    there = np.concatenate([box, box + np.array([10.0, 0, 0, 0]), box + np.array([30.0, 0, 0, 0])])
    own, near, far = distances(paths, there, VIEW, CONFIG)[0]
    assert own == pytest.approx(0.0, abs=1e-6)
    assert 0.5 < near < far


def test_who_is_short_is_told_from_who_is_far_where_the_floor_is_known() -> None:
    feet, build = np.array([0.5, 1.2, 4.0]), -0.1
    paths = begun(box_at(feet, build), VIEW, CONFIG)
    for _ in range(60):
        paths = advanced(paths, 1 / 15, Odometry(), CONFIG)
        paths = corrected(paths, box_at(feet, build), VIEW, CONFIG)
    assert paths.mean[0, :3] == pytest.approx(feet, abs=0.1)
    assert paths.mean[0, 6] == pytest.approx(build, abs=0.02)
