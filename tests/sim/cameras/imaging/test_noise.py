from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from peopleboy.random_streams import stream
from peopleboy.sim.cameras.camera_config import ThermalConfig
from peopleboy.sim.cameras.imaging.noise import PIXEL_SHARE, SMOOTH_SHARE, Drift, gaussian
from peopleboy.sim.cameras.kinds import THERMAL_PRESETS
from peopleboy.sim.cameras.thermal import make_detector
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from tests.helpers.worlds.small_worlds import SMALL, config, person, robot


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


DRIFTING = ThermalConfig(camera=SMALL, offset_drift_k_per_min=0.5)
SHUTTER = replace(DRIFTING, shutter_every_s=1.0, shutter_lasts_s=0.3, column_noise_k=0.2)


def offset(settings: ThermalConfig, time_s: float, seed: int = 0) -> np.ndarray:
    found = Drift(settings, "thermal", seed).offset_k(time_s)
    assert found is not None
    return found


def seen_by(thermal: ThermalConfig) -> WorldConfig:
    anna = person("anna", (4.0, -1.0), (4.0, 1.0))
    return config(anna, robot=robot(thermal=thermal))


def shots(thermal: ThermalConfig, asked: set[int], count: int = 30) -> dict[int, tuple[bytes, bytes]]:
    """What a turning robot's camera gives at the instants at which it is asked."""
    found = {}
    with SimulatedWorld(seen_by(thermal)) as world:
        for k in range(count):
            images = world.observe().images
            if k in asked:
                found[k] = images["thermal"].tobytes(), images["thermal_c"].tobytes()
            world.step(0.0, 0.4 if k > 10 else 0.0)
    return found


def test_drift_grows_with_the_time_and_with_its_deviation() -> None:
    late = np.array([offset(DRIFTING, 120.0, seed) for seed in range(60)])
    assert late.std() == pytest.approx(2 * 0.5 * math.hypot(1.0, SMOOTH_SHARE, PIXEL_SHARE), rel=0.25)
    assert np.std([one.mean() for one in late]) == pytest.approx(1.0, rel=0.3)
    assert offset(DRIFTING, 60.0) == pytest.approx(offset(DRIFTING, 120.0) / 2.0, abs=1e-5)
    assert not offset(DRIFTING, 0.0).any()


def test_calibration_takes_all_drift_away_and_another_begins() -> None:
    before, after, later = (offset(SHUTTER, t) for t in (0.99, 1.3, 1.9))
    columns = offset(SHUTTER, 0.0)[:1]
    assert columns.std() == pytest.approx(0.2, rel=0.2)
    assert (before - columns).std() > 0.0
    assert np.ptp(after, axis=0) == pytest.approx(np.zeros(160), abs=1e-6)
    assert not np.allclose(after[0], columns)
    rates = [(before - columns) / 0.99, (later - after) / 0.6]
    assert abs(np.corrcoef(rates[0].ravel(), rates[1].ravel())[0, 1]) < 0.9


def test_the_offsets_depend_on_the_time_alone() -> None:
    one, other = (Drift(SHUTTER, "thermal", 3) for _ in range(2))
    for t in (0.2, 1.4, 2.6):
        one.offset_k(t)
    assert np.array_equal(one.offset_k(3.5), other.offset_k(3.5))
    assert not np.array_equal(one.offset_k(3.5), Drift(SHUTTER, "rear", 3).offset_k(3.5))


def test_without_drift_there_is_none() -> None:
    assert Drift(ThermalConfig(), "thermal", 0).offset_k(10.0) is None


def test_the_shutter_freezes_the_image_exactly_and_for_its_time() -> None:
    seen = shots(SHUTTER, set(range(30)), 24)
    frozen = [k for k in range(1, 24) if seen[k] == seen[k - 1]]
    assert frozen == [15, 16, 17, 18, 19]  # 1.0 s up to 1.3 s at 15 Hz


@pytest.mark.slow
@pytest.mark.parametrize(
    "thermal",
    [
        replace(SHUTTER, gain="plateau"),
        ThermalConfig(camera=SMALL, gain="percentile"),
        replace(DRIFTING, gain="percentile", gain_follows_s=0.0),
        replace(THERMAL_PRESETS["uncooled_film"], camera=SMALL, shutter_every_s=1.0),
    ],
    ids=["plateau and shutter", "percentile", "drift", "preset"],
)
def test_images_that_nobody_asks_for_change_no_later_ones(thermal: ThermalConfig) -> None:
    every = shots(thermal, set(range(30)))
    few = shots(thermal, {3, 17, 18, 29})
    assert few == {k: every[k] for k in few}


def test_only_what_remembers_is_made_before_it_is_asked_for() -> None:
    assert not any(one.remembers for one in (ThermalConfig(), DRIFTING))
    assert not ThermalConfig(gain="plateau", gain_follows_s=0.0).remembers
    assert SHUTTER.remembers
    assert ThermalConfig(gain="percentile").remembers


def test_corners_are_warmer_by_vignetting_and_the_middle_is_not() -> None:
    settings = ThermalConfig(camera=Pinhole(width=41, height=31), fixed_pattern_k=0.0, vignetting_k=0.6)
    added = make_detector(settings, np.random.default_rng(0)).offset_k
    assert added[[0, 0, -1, -1], [0, -1, 0, -1]] == pytest.approx(np.full(4, 0.6))
    assert added[15, 20] == pytest.approx(0.0)
    assert added[15, 0] == pytest.approx(0.3)
