import math

import numpy as np
import pytest

from peopleboy.tracker.thermal.config import MotionConfig
from peopleboy.tracker.thermal.particles import noise_per_step, predict, turned

DT = 1 / 15
STATE = np.array([120, 110, 12, 30, 2, 15, -9, 3, -6], dtype=np.float32)


def transition(dt_s):
    """Build the matrix A (9, 9) of equation 4.8."""
    matrix = np.eye(9)
    matrix[:4, 5:] = dt_s * np.eye(4)
    return matrix


def test_without_noise_the_prediction_is_the_matrix_of_equation_4_8():
    still = MotionConfig(noise_x=0, noise_y=0, noise_w=0, noise_h=0, noise_d=0)
    state = np.random.default_rng(0).normal(50, 20, (40, 9)).astype(np.float32)
    moved = predict(state, DT, 1.0, still, np.random.default_rng(0))
    assert np.allclose(moved, state @ transition(DT).T, rtol=1e-5, atol=1e-4)


@pytest.mark.parametrize("size", [1.0, 2.0])
def test_the_random_walk_has_the_mean_and_spread_of_equation_4_7(size):
    config = MotionConfig()
    moved = predict(np.tile(STATE, (40_000, 1)), DT, size, config, np.random.default_rng(1)).astype(float)
    spread = np.zeros(9)
    spread[4:] = size * np.array([60 * DT, 30, 30, 22, 22])
    assert np.allclose(moved.mean(axis=0), transition(DT) @ STATE, atol=5 * spread.max() / 200)
    assert np.allclose(moved.std(axis=0), spread, rtol=0.02, atol=1e-3)


def test_with_noise_by_height_a_person_twice_as_tall_moves_twice_as_much():
    config = MotionConfig(noise_by_height=15.0)
    moved = predict(np.tile(STATE, (40_000, 1)), DT, 1.0, config, np.random.default_rng(1))
    assert np.isclose(moved[:, 5].std(), 2 * noise_per_step(DT, 1.0, config)[1], rtol=0.02)


def test_memory_is_the_share_of_the_velocity_that_lasts():
    config = MotionConfig(noise_x=0, noise_y=0, noise_w=0, noise_h=0, place_memory=0.5, size_memory=0.0)
    moved = predict(STATE[None], DT, 1.0, config, np.random.default_rng(0))
    assert np.allclose(moved[0, 5:], [7.5, -4.5, 0, 0])


def test_a_left_turn_moves_the_image_right_by_the_pinhole_rule():
    focal, centre = 297.0, 159.5
    angle = np.radians([-20.0, 0.0, 15.0])
    columns = centre + focal * np.tan(angle)
    expected = centre + focal * np.tan(angle + 0.1)
    assert np.allclose(turned(columns, 0.1, focal, centre), expected)
    assert np.allclose(turned(turned(columns, 0.1, focal, centre), -0.1, focal, centre), columns)
    assert turned(np.array([centre]), math.radians(5), focal, centre)[0] > centre
