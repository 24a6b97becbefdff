import numpy as np

from peopleboy.tracker.reproductions.panoramic.position_filter import (
    PRINTED,
    MotionNoise,
    PositionFilter,
    estimate_noise,
)

Q, R = PRINTED.step_m2, PRINTED.measurement_m2
STILL = PositionFilter(PRINTED, uses_velocity=False)


def walk(count, seed=0, q=Q, r=R):
    rng = np.random.default_rng(seed)
    true = np.cumsum(rng.multivariate_normal((0, 0), q, count), axis=0)
    return true, true + rng.multivariate_normal((0, 0), r, count)


def filtered(position_filter, measured):
    estimates = [position_filter.start(measured[0])]
    for z in measured[1:]:
        estimates.append(position_filter.update(estimates[-1], z))
    return estimates


def test_without_velocity_its_last_estimate_is_that_of_least_squares_over_all_measurements_at_once():
    _, measured = walk(8)
    count = len(measured)
    information, right = np.zeros((2 * count, 2 * count)), np.zeros(2 * count)
    for k in range(count):
        here = slice(2 * k, 2 * k + 2)
        information[here, here] += np.linalg.inv(R)
        right[here] += np.linalg.inv(R) @ measured[k]
        if k:
            step = np.hstack([-np.eye(2), np.eye(2)])
            both = slice(2 * k - 2, 2 * k + 2)
            information[both, both] += step.T @ np.linalg.inv(Q) @ step
    last = filtered(STILL, measured)[-1]
    covariance = np.linalg.inv(information)
    np.testing.assert_allclose(last.position_m, (covariance @ right)[-2:], atol=1e-12)
    np.testing.assert_allclose(last.covariance_m2, covariance[-2:, -2:], atol=1e-12)


def test_the_covariance_settles_where_the_riccati_equation_says():
    last = filtered(STILL, walk(60)[1])[-1].covariance_m2
    prior = last + Q
    np.testing.assert_allclose(last, prior - prior @ np.linalg.inv(prior + R) @ prior, atol=1e-12)


def test_with_velocity_each_step_repeats_the_last_estimated_one():
    _, measured = walk(12)
    p, x, u = R, measured[0], np.zeros(2)
    moving = PositionFilter(PRINTED, uses_velocity=True)
    for z, reported in zip(measured[1:], filtered(moving, measured)[1:], strict=True):
        p = p + Q
        k = p @ np.linalg.inv(p + R)
        x, before = x + u + k @ (z - x - u), x
        u, p = x - before, p - k @ p
        np.testing.assert_allclose(reported.position_m, x)
        np.testing.assert_allclose(reported.covariance_m2, p)


def test_somebody_who_walks_evenly_is_followed_without_lag_by_velocity_alone():
    even = np.arange(60)[:, None] * np.array([0.3, -0.2])
    lag = {
        u: np.linalg.norm(filtered(PositionFilter(PRINTED, u), even)[-1].position_m - even[-1])
        for u in (False, True)
    }
    assert lag[True] < 1e-9
    assert lag[False] > 0.05


def test_on_walks_of_its_own_noise_it_is_better_than_the_measurements_and_knows_how_good():
    true, measured = walk(4000)
    estimates = filtered(STILL, measured)
    errors = np.array([e.position_m for e in estimates]) - true
    assert np.linalg.norm(errors, axis=1).mean() < 0.95 * np.linalg.norm(measured - true, axis=1).mean()
    np.testing.assert_allclose(np.cov(errors.T), estimates[-1].covariance_m2, atol=2e-3)


def test_predicting_twice_half_a_step_is_predicting_one():
    start = PositionFilter(PRINTED, uses_velocity=True).update(STILL.start(np.zeros(2)), np.ones(2))
    halves = STILL.predict(STILL.predict(start, 0.5), 0.5)
    whole = STILL.predict(start)
    np.testing.assert_allclose(halves.position_m, whole.position_m)
    np.testing.assert_allclose(halves.covariance_m2, whole.covariance_m2)


def test_estimated_noise_is_that_of_the_walks():
    q, r = np.array([[0.03, 0.01], [0.01, 0.02]]), np.array([[0.01, -0.002], [-0.002, 0.03]])
    noise = estimate_noise([walk(20000, 1, q, r), walk(20000, 2, q, r)], uses_velocity=False)
    np.testing.assert_allclose(noise.step_m2, q, atol=6e-4)
    np.testing.assert_allclose(noise.measurement_m2, r, atol=6e-4)


def test_with_velocity_an_even_walk_has_steps_without_noise():
    even = np.arange(50)[:, None] * np.array([0.3, -0.2])
    noise = estimate_noise([(even, even)], uses_velocity=True)
    np.testing.assert_allclose(noise.step_m2, np.zeros((2, 2)), atol=1e-15)


def test_the_noise_of_the_paper_is_symmetric_and_positive():
    for matrix in (PRINTED.step_m2, PRINTED.measurement_m2):
        assert np.array_equal(matrix, matrix.T)
        assert (np.linalg.eigvalsh(matrix) > 0).all()
    assert isinstance(PRINTED, MotionNoise)
