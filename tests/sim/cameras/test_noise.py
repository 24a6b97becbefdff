import numpy as np
import pytest
from scipy import stats

from peopleboy.sim.cameras.noise import gaussian
from peopleboy.sim.random_streams import stream


def test_noise_has_the_moments_and_quantiles_of_the_normal_distribution() -> None:
    noise = gaussian((300, 400, 3), stream(0, "thermal.noise")).ravel()
    assert noise.mean() == pytest.approx(0.0, abs=0.01)
    assert noise.var() == pytest.approx(1.0, abs=0.01)
    assert stats.skew(noise) == pytest.approx(0.0, abs=0.02)
    assert stats.kurtosis(noise) == pytest.approx(0.0, abs=0.05)
    for share in (0.001, 0.05, 0.3, 0.5, 0.9, 0.999):
        assert np.quantile(noise, share) == pytest.approx(stats.norm.ppf(share), abs=0.08)


def test_values_of_one_image_and_of_two_images_are_independent() -> None:
    rng = stream(0, "thermal.noise")
    first, second = (gaussian((200, 200), rng) for _ in range(2))
    assert np.corrcoef(first.ravel(), second.ravel())[0, 1] == pytest.approx(0.0, abs=0.02)
    # Four values come from one random word: neighbours up to that far must not know of each other.
    for shift in (1, 2, 3, 4):
        beside = np.corrcoef(first[:, shift:].ravel(), first[:, :-shift].ravel())[0, 1]
        assert beside == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize("shape", [(1,), (3, 5), (2, 3, 3), (0, 4)])
def test_noise_has_the_shape_that_is_asked_for(shape: tuple[int, ...]) -> None:
    noise = gaussian(shape, stream(0, "x"))
    assert noise.shape == shape
    assert noise.dtype == np.float32


def test_streams_are_known_by_seed_and_name() -> None:
    draws = {
        (seed, name): tuple(stream(seed, name).random(3))
        for seed in (0, 1, 2)
        for name in ("thermal.noise", "colour.noise", "person.ann")
    }
    assert len(set(draws.values())) == 9
    assert draws[0, "thermal.noise"] == tuple(stream(0, "thermal.noise").random(3))
    # Numbers that must never change, or old runs could not be repeated.
    assert draws[0, "thermal.noise"] == pytest.approx((0.44418654, 0.83934663, 0.78600858))
