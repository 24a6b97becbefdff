import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.panoramic.people.floor_motion import FASTEST_M_S, FIRST_SPEED_SD_M_S, FloorMotion


def drawn_error(rng):
    half = rng.uniform(-0.2, 0.2, (2, 2))
    return half @ half.T + 0.01 * np.eye(2)


def batch(places, errors, times):
    """Least squares over all places at once, at a velocity that does not change: state at the end."""
    until = times[-1]
    normal, reported = np.zeros((4, 4)), np.zeros(4)
    # What is believed of the speed at first; velocity is constant, so it is also that at the end.
    normal[2:, 2:] += np.eye(2) / FIRST_SPEED_SD_M_S**2
    for place, error, time in zip(places, errors, times, strict=True):
        row = np.hstack([np.eye(2), (time - until) * np.eye(2)])
        normal += row.T @ np.linalg.solve(error, row)
        reported += row.T @ np.linalg.solve(error, place)
    covariance = np.linalg.inv(normal)
    return covariance @ reported, covariance


@pytest.mark.parametrize("seed", range(5))
def test_of_somebody_who_walks_straight_it_believes_what_least_squares_say(seed):
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.05, 0.4, 12))
    errors = [drawn_error(rng) for _ in times]
    places = [
        np.array([1.0, -2.0]) + time * np.array([0.4, 0.3]) + rng.multivariate_normal(np.zeros(2), error)
        for time, error in zip(times, errors, strict=True)
    ]
    motion = FloorMotion.begin(places[0], errors[0])
    for k in range(1, len(times)):
        motion = motion.later(times[k] - times[k - 1], 0.0).corrected(places[k], errors[k])
    state, covariance = batch(places, errors, times)
    np.testing.assert_allclose(motion.state, state, rtol=1e-8)
    np.testing.assert_allclose(motion.covariance, covariance, atol=1e-9)


@given(st.floats(0.0, 1.5), st.floats(0.0, 1.5), st.floats(0.0, 3.0))
def test_two_steps_are_one_of_their_sum_so_that_the_rate_of_images_does_not_matter(one_s, other_s, density):
    motion = FloorMotion(np.array([1.0, 2.0, 0.5, -0.3]), np.diag([0.02, 0.03, 0.4, 0.5]))
    twice, once = motion.later(one_s, density).later(other_s, density), motion.later(one_s + other_s, density)
    np.testing.assert_allclose(twice.state, once.state, atol=1e-12)
    np.testing.assert_allclose(twice.covariance, once.covariance, atol=1e-12)


def test_it_keeps_as_well_as_white_accelerations_let_it():
    """Against the spread of many walks."""
    rng, density, steps = np.random.default_rng(0), 0.8, 200
    dt = 1.0 / steps
    kicks = rng.normal(0.0, np.sqrt(density * dt), (4000, steps))
    speed = np.cumsum(kicks, axis=1)
    place = speed.sum(axis=1) * dt
    covariance = FloorMotion(np.zeros(4), np.zeros((4, 4))).later(1.0, density).covariance
    assert covariance[0, 0] == pytest.approx(place.var(), rel=0.06)
    assert covariance[2, 2] == pytest.approx(speed[:, -1].var(), rel=0.06)
    assert covariance[0, 2] == pytest.approx((place * speed[:, -1]).mean(), rel=0.06)


@given(st.integers(0, 1000))
def test_it_never_gets_less_sure_by_looking_nor_faster_than_people_are(seed):
    rng = np.random.default_rng(seed)
    motion = FloorMotion.begin(rng.uniform(-3, 3, 2), drawn_error(rng))
    for _ in range(10):
        ahead = motion.later(0.2, 1.0)
        motion = ahead.corrected(rng.uniform(-4, 4, 2), drawn_error(rng))
        assert np.linalg.eigvalsh(ahead.covariance - motion.covariance).min() > -1e-9
        assert np.linalg.eigvalsh(motion.covariance).min() > 0
        assert np.array_equal(motion.covariance, motion.covariance.T)
        assert np.hypot(*motion.state[2:]) <= FASTEST_M_S + 1e-9


def test_who_is_not_seen_comes_to_a_stop_within_a_bounded_way():
    motion = FloorMotion(np.array([0.0, 0.0, 1.0, 0.0]), np.eye(4))
    for _ in range(200):
        motion = motion.later(0.1, 0.0).slowed(0.1, 1.0)
    assert motion.state[2] == pytest.approx(0.0, abs=1e-6)
    assert motion.state[0] == pytest.approx(1.0, rel=0.1)
