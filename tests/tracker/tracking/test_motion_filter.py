"""Tests of people's paths in metres."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.tracking.camera_motion import FrameMotion
from peopleboy.tracker.tracking.config import KalmanConfig
from peopleboy.tracker.tracking.measurement import BoxMeasurement
from peopleboy.tracker.tracking.motion_filter import (
    StateEstimates,
    floor_positions,
    predict,
    predicted_boxes,
)
from peopleboy.tracker.tracking.viewpoint import Viewpoint
from tests.tracker.tracking.test_viewpoint import SHAPE, calibration

VIEW = Viewpoint.of(calibration(0.0, 1.2), SHAPE)
CONFIG = KalmanConfig()
RATIO = np.array([0.27])


def box_at(feet: np.ndarray, build: float = 0.0) -> np.ndarray:
    """Give the box (1, 4) of somebody with these feet."""
    column, head, foot = VIEW.seen(feet[None], np.array([build]))[0]
    height = foot - head
    return np.array([[column - 0.135 * height, foot - height, 0.27 * height, height]])


def initiate(boxes: np.ndarray, view: Viewpoint, config: KalmanConfig) -> StateEstimates:
    return BoxMeasurement(boxes, view, config).initiate(range(len(boxes)))


def update_states(
    states: StateEstimates, boxes: np.ndarray, view: Viewpoint, config: KalmanConfig
) -> StateEstimates:
    return BoxMeasurement(boxes, view, config).update(states, range(len(boxes)))


def test_who_walks_evenly_is_expected_where_he_is() -> None:
    feet, walk = np.array([-1.0, 1.2, 6.0]), np.array([0.8, 0.0, -0.3])
    paths = initiate(box_at(feet), VIEW, CONFIG)
    for number in range(1, 60):
        paths = predict(paths, 1 / 15, FrameMotion.of(Odometry()), CONFIG)
        paths = update_states(paths, box_at(feet + walk * number / 15), VIEW, CONFIG)
    later = predict(paths, 1.0, FrameMotion.of(Odometry()), CONFIG)
    assert later.mean[0, :3] == pytest.approx(feet + walk * (59 / 15 + 1.0), abs=0.05)
    assert paths.mean[0, 3:6] == pytest.approx(walk, abs=0.02)


@given(st.floats(-0.2, 0.2), st.floats(-0.1, 0.3), st.floats(-0.1, 0.1))
def test_the_robots_own_motion_moves_nobody_in_the_world(turn: float, ahead: float, aside: float) -> None:
    feet = np.array([0.7, 1.2, 5.0])
    paths = initiate(box_at(feet), VIEW, CONFIG)
    moved = predict(
        paths, 1e-6, FrameMotion.of(Odometry(advance_m=ahead, aside_m=aside, turn_rad=turn)), CONFIG
    )
    # The same in the robot's frame: x ahead, y to the left.
    x, y = 5.0 - ahead, -0.7 - aside
    forward = np.cos(turn) * x + np.sin(turn) * y
    left = -np.sin(turn) * x + np.cos(turn) * y
    assert moved.mean[0, :3] == pytest.approx([-left, 1.2, forward], abs=1e-4)


@given(st.floats(1.5, 9.0), st.floats(-0.5, 0.5), st.floats(-0.3, 0.3), st.floats(-0.2, 0.2))
def test_places_on_the_floor_are_told_in_the_frame_of_the_robot(
    away: float, bearing: float, ahead: float, aside: float
) -> None:
    left = away * bearing
    paths = initiate(box_at(np.array([-left, 1.2, away])), VIEW, CONFIG)
    (place,) = floor_positions(paths, np.zeros((1, 2)), (ahead, aside, 1.2))
    assert place.position_m == pytest.approx((away + ahead, left + aside), abs=1e-3)
    robot_from_level = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
    xx, xy, yy = place.covariance_m2
    result = robot_from_level @ paths.covariance[0, :3, :3] @ robot_from_level.T
    assert np.array([[xx, xy], [xy, yy]]) == pytest.approx(result)
    assert xx > 0.0 < xx * yy - xy**2


def test_covariances_stay_symmetric_and_positive() -> None:
    feet = np.array([0.5, 1.2, 4.0])
    paths = initiate(box_at(feet), VIEW, CONFIG)
    rng = np.random.default_rng(0)
    for _ in range(600):
        paths = predict(paths, 1 / 15, FrameMotion.of(Odometry(turn_rad=rng.normal(0.0, 0.02))), CONFIG)
        paths = update_states(paths, box_at(feet) + rng.normal(0.0, 1.0, 4), VIEW, CONFIG)
    covariance = paths.covariance[0]
    assert covariance == pytest.approx(covariance.T, abs=1e-9)
    assert np.linalg.eigvalsh(covariance).min() > 0.0


def test_a_path_has_the_box_that_it_was_begun_with() -> None:
    box = box_at(np.array([0.5, 1.2, 4.0]))
    assert predicted_boxes(initiate(box, VIEW, CONFIG), VIEW, RATIO) == pytest.approx(box, abs=1e-6)


def test_the_farther_a_proposal_lies_the_greater_is_its_distance() -> None:
    box = box_at(np.array([0.5, 1.2, 4.0]))
    paths = initiate(box, VIEW, CONFIG)
    there = np.concatenate([box, box + np.array([10.0, 0, 0, 0]), box + np.array([30.0, 0, 0, 0])])
    own, near, far = BoxMeasurement(there, VIEW, CONFIG).distances(paths)[0]
    assert own == pytest.approx(0.0, abs=1e-6)
    assert 0.5 < near < far


def test_who_is_short_is_told_from_who_is_far_where_the_floor_is_known() -> None:
    feet, build = np.array([0.5, 1.2, 4.0]), -0.1
    paths = initiate(box_at(feet, build), VIEW, CONFIG)
    for _ in range(60):
        paths = predict(paths, 1 / 15, FrameMotion.of(Odometry()), CONFIG)
        paths = update_states(paths, box_at(feet, build), VIEW, CONFIG)
    assert paths.mean[0, :3] == pytest.approx(feet, abs=0.1)
    assert paths.mean[0, 6] == pytest.approx(build, abs=0.02)


def several(seed: int) -> StateEstimates:
    """Make some who have walked for a while."""
    rng = np.random.default_rng(seed)
    feet = rng.uniform([-2.0, 1.1, 2.0], [2.0, 1.3, 9.0], (4, 3))
    boxes = np.concatenate([box_at(one) for one in feet])
    return predict(initiate(boxes, VIEW, CONFIG), 0.4, FrameMotion.of(Odometry(turn_rad=0.05)), CONFIG)


def seen_from(paths: StateEstimates) -> tuple[np.ndarray, np.ndarray]:
    """Tell what is expected (K, 3), and the slopes (K, 3, 7) of that."""
    feet, build = paths.mean[:, :3], paths.mean[:, 6]
    slopes = np.zeros((len(paths), 3, 7))
    slopes[..., [0, 1, 2, 6]] = VIEW.slopes(feet, build)
    return VIEW.seen(feet, build), slopes


def ends_of(boxes: np.ndarray) -> np.ndarray:
    left, top, width, height = boxes.T
    return np.stack([left + width / 2.0, top, top + height], axis=1)


@given(st.integers(0, 1000), st.floats(0.01, 1.0), st.floats(-0.3, 0.3), st.floats(-0.2, 0.2))
def test_paths_are_carried_on_as_a_kalman_filter_does(
    seed: int, dt_s: float, turn: float, ahead: float
) -> None:
    paths = several(seed)
    ours = predict(paths, dt_s, FrameMotion.of(Odometry(advance_m=ahead, turn_rad=turn)), CONFIG)
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    step, whole, spread = np.eye(7), np.eye(7), np.zeros((7, 7))
    step[:3, 3:6] = dt_s * np.eye(3)
    whole[:6, :6] = np.kron(np.eye(2), rotation)
    grown = [[dt_s**3 / 3.0, dt_s**2 / 2.0], [dt_s**2 / 2.0, dt_s]]
    spread[:6, :6] = np.kron(grown, np.diag(np.square(CONFIG.acceleration_m_s2)))
    spread[6, 6] = CONFIG.posture**2 * dt_s
    shift = np.array([0.0, 0.0, ahead, 0.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(ours.mean, (paths.mean @ step.T - shift) @ whole.T, atol=1e-9)
    expected = whole @ (step @ paths.covariance @ step.T + spread) @ whole.T
    np.testing.assert_allclose(ours.covariance, expected, atol=1e-9)


@given(st.integers(0, 1000), st.floats(-9.0, 9.0))
def test_boxes_are_taken_in_and_told_apart_as_a_kalman_filter_does(seed: int, aside_px: float) -> None:
    paths = several(seed)
    view = replace(VIEW, floor_m=None)
    expected, slopes = seen_from(paths)
    boxes = predicted_boxes(paths, VIEW, np.full(4, 0.27)) + np.array([aside_px, 2.0, 0.0, 0.0])
    measured = BoxMeasurement(boxes, view, CONFIG)
    ours, far = measured.update(paths, range(4)), measured.distances(paths)
    parts = np.array([CONFIG.column, CONFIG.head, CONFIG.foot])
    for k in range(4):
        result, slope, covariance = ends_of(boxes), slopes[k], paths.covariance[k]
        spread = slope @ covariance @ slope.T + np.diag(np.square(parts * boxes[k, 3]))
        gain = covariance @ slope.T @ np.linalg.inv(spread)
        np.testing.assert_allclose(ours.mean[k], paths.mean[k] + gain @ (result[k] - expected[k]), atol=1e-9)
        np.testing.assert_allclose(ours.covariance[k], (np.eye(7) - gain @ slope) @ covariance, atol=1e-9)
        for m in range(4):
            gap = result[m] - expected[k]
            assert far[k, m] == pytest.approx(np.sqrt(gap @ np.linalg.solve(spread, gap)), rel=1e-6)


@given(st.integers(0, 1000), st.floats(0.3, 3.0), st.floats(0.1, 10.0), st.sampled_from([None, 1.2]))
def test_who_is_found_after_long_or_right_before_the_camera_is_believed_no_less(
    seed: int, away_m: float, lost_s: float, floor_m: float | None
) -> None:
    view, rng = replace(VIEW, floor_m=floor_m), np.random.default_rng(seed)
    paths = initiate(box_at(np.array([0.2, 1.2, away_m])), view, CONFIG)
    for _ in range(12):
        paths = predict(paths, lost_s, FrameMotion.of(Odometry(turn_rad=float(rng.normal(0.0, 0.3)))), CONFIG)
        seen = predicted_boxes(paths, view, RATIO) + rng.normal(0.0, 20.0, 4)
        paths = update_states(paths, np.maximum(seen, [-999.0, -999.0, 1.0, 4.0]), view, CONFIG)
        extent = np.linalg.eigvalsh(paths.covariance[0])
        assert extent.min() > -1e-9 * extent.max()
        assert np.isfinite(paths.mean).all()
