import math

import numpy as np
import pytest

from peopleboy.tracker.reproductions.contour.contour_config import MotionConfig
from peopleboy.tracker.reproductions.contour.particles import camera_turn, noise_per_step, predict, turned

DT = 1 / 15
STILL = camera_turn(0.0, 1.0, 0.0)
STATE = np.array([120, 110, 12, 30, 2, 15, -9, 3, -6], dtype=np.float32)


def transition(dt_s):
    """Build the matrix A (9, 9) of equation 4.8."""
    matrix = np.eye(9)
    matrix[:4, 5:] = dt_s * np.eye(4)
    return matrix


def moved_on(state, size, config, rng, turn=STILL):
    return predict(state, np.arange(len(state)), DT, turn, size, config, rng)


def test_without_noise_the_prediction_is_the_matrix_of_equation_4_8():
    still = MotionConfig(noise_x=0, noise_y=0, noise_w=0, noise_h=0, noise_d=0)
    state = np.random.default_rng(0).normal(50, 20, (40, 9)).astype(np.float32)
    moved = moved_on(state, 1.0, still, np.random.default_rng(0))
    assert np.allclose(moved, state @ transition(DT).T, rtol=1e-5, atol=1e-4)


@pytest.mark.parametrize("size", [1.0, 2.0])
def test_the_random_walk_has_the_mean_and_spread_of_equation_4_7(size):
    config = MotionConfig()
    moved = moved_on(np.tile(STATE, (40_000, 1)), size, config, np.random.default_rng(1)).astype(float)
    spread = np.zeros(9)
    spread[4:] = size * np.array([60 * DT, 30, 30, 22, 22])
    assert np.allclose(moved.mean(axis=0), transition(DT) @ STATE, atol=5 * spread.max() / 200)
    assert np.allclose(moved.std(axis=0), spread, rtol=0.02, atol=1e-3)


def test_with_noise_by_height_a_person_twice_as_tall_moves_twice_as_much():
    config = MotionConfig(noise_by_height=15.0)
    moved = moved_on(np.tile(STATE, (40_000, 1)), 1.0, config, np.random.default_rng(1))
    assert np.isclose(moved[:, 5].std(), 2 * noise_per_step(DT, 1.0, config)[1], rtol=0.02)


def test_memory_is_the_share_of_the_velocity_that_lasts():
    config = MotionConfig(noise_x=0, noise_y=0, noise_w=0, noise_h=0, place_memory=0.5, size_memory=0.0)
    moved = moved_on(STATE[None], 1.0, config, np.random.default_rng(0))
    assert np.allclose(moved[0, 5:], [7.5, -4.5, 0, 0])


def test_those_that_go_on_move_as_they_would_by_themselves():
    state = np.random.default_rng(0).normal(50, 20, (40, 9)).astype(np.float32)
    rows = np.sort(np.random.default_rng(1).integers(0, 40, 60))
    config, turn = MotionConfig(noise_by_height=15.0), camera_turn(0.1, 297.0, 159.5)
    moved = predict(state, rows, DT, turn, 1.0, config, np.random.default_rng(2))
    assert np.array_equal(moved, moved_on(state[rows], 1.0, config, np.random.default_rng(2), turn))


def test_a_left_turn_moves_the_image_right_by_the_pinhole_rule():
    focal, centre = 297.0, 159.5
    left, right = camera_turn(0.1, focal, centre), camera_turn(-0.1, focal, centre)
    for angle in np.radians([-20.0, 0.0, 15.0]):
        column = centre + focal * math.tan(angle)
        assert turned(column, left) == pytest.approx(centre + focal * math.tan(angle + 0.1))
        assert turned(turned(column, left), right) == pytest.approx(column)
    assert turned(centre, camera_turn(math.radians(5), focal, centre)) > centre


def test_samples_turn_as_single_columns_do_and_in_nothing_else():
    state = np.random.default_rng(0).normal(150, 60, (500, 9)).astype(np.float32)
    turn = camera_turn(0.07, 297.3, 159.5)
    straight = moved_on(state, 1.0, MotionConfig(), np.random.default_rng(1), camera_turn(0.0, 297.3, 159.5))
    moved = moved_on(state, 1.0, MotionConfig(), np.random.default_rng(1), turn)
    expected = [turned(float(x), turn) for x in straight[:, 0]]
    np.testing.assert_allclose(moved[:, 0], expected, rtol=1e-5, atol=1e-3)
    assert np.array_equal(moved[:, 1:], straight[:, 1:])
