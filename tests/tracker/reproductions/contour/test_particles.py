import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from peopleboy.tracker.reproductions.contour.particles import (
    Particles,
    equally_weighted,
    estimated,
    mean_state,
    normalised,
    resample,
    uncertainty_px2,
)
from peopleboy.tracker.reproductions.contour.weights import systematic_rows

weights = arrays(np.float32, st.integers(1, 60), elements=st.floats(0, 1, width=32)).filter(
    lambda w: w.sum() > 1e-3
)


def cloud(count: int, seed: int = 0) -> Particles:
    rng = np.random.default_rng(seed)
    state = rng.normal(50, 10, (count, 9)).astype(np.float32)
    return Particles(state, normalised(rng.random(count, dtype=np.float32)))


@settings(deadline=None)
@given(weight=weights, count=st.integers(1, 200), offset=st.floats(0, 1, exclude_max=True))
def test_systematic_resampling_takes_each_row_floor_or_ceil_of_its_share(weight, count, offset):
    expected = count * (weight.astype(float) / weight.astype(float).sum())
    taken = np.bincount(systematic_rows(weight, count, offset), minlength=len(weight))
    assert taken.sum() == count
    assert np.all(taken >= np.floor(expected - 1e-6))
    assert np.all(taken <= np.ceil(expected + 1e-6))


@settings(deadline=None)
@given(weight=weights, offset=st.floats(0, 1, exclude_max=True))
def test_a_row_without_weight_is_never_taken(weight, offset):
    assert np.all(weight[systematic_rows(weight, 50, offset)] > 0)


def test_resampling_uses_one_random_number():
    rng, same = np.random.default_rng(3), np.random.default_rng(3)
    resample(cloud(100), 100, rng)
    same.random()
    assert rng.random() == same.random()


def test_equal_weights_come_back_once_each():
    particles = equally_weighted(cloud(100).state)
    assert np.array_equal(resample(particles, 100, np.random.default_rng(0)), np.arange(100))


def test_mean_and_uncertainty_equal_their_closed_forms():
    particles = cloud(500)
    weight, state = particles.weight.astype(float), particles.state.astype(float)
    mean = np.average(state, axis=0, weights=weight)
    spread = np.average(((state[:, :2] - mean[:2]) ** 2).sum(axis=1), weights=weight)
    assert np.allclose(mean_state(particles), mean, rtol=1e-6)
    assert np.isclose(uncertainty_px2(particles), spread, rtol=1e-5)


def test_weights_that_are_all_zero_become_equal():
    assert np.allclose(normalised(np.zeros(8, dtype=np.float32)), 1 / 8)


def test_the_core_is_the_best_share_of_the_particles_and_the_estimate_its_mean():
    particles, chance = cloud(100), np.random.default_rng(1).random(100, dtype=np.float32)
    is_inside = np.random.default_rng(2).random(100) < 0.7
    state, weight, mean, confidence, spread = estimated(
        particles.state, particles.weight, chance, is_inside, (0.3, np.inf)
    )
    core = Particles(state, weight)
    best = np.sort(np.argsort(particles.weight)[-30:])
    assert np.array_equal(core.state, particles.state[best])
    assert np.allclose(core.weight, normalised(particles.weight[best]))
    assert np.array_equal(mean, mean_state(core))
    assert confidence == pytest.approx(np.average((chance * is_inside)[best], weights=core.weight), rel=1e-6)
    assert spread == uncertainty_px2(core)


def test_the_core_leaves_out_particles_on_another_person():
    state = np.tile(np.array([100, 100, 10, 25, 0, 0, 0, 0, 0], dtype=np.float32), (20, 1))
    state[10:, 0] = 200
    weight = np.full(20, 0.05, dtype=np.float32)
    weight[3] = 0.1
    core, _, mean, *_ = estimated(state, normalised(weight), weight, np.ones(20, bool), (1.0, 0.7))
    assert len(core) == 10
    assert mean[0] == pytest.approx(100)
