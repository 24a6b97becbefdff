from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import jax
import numpy as np
import pytest

from peopleboy.studies.training.detector.crop_samples import CropSamples, first_weights, versions
from peopleboy.studies.training.detector.train_rescoring import (
    RescoringTraining,
    with_log_odds,
)
from peopleboy.studies.training.detector.world_sequences import ThermalImage, load_images
from peopleboy.tracker.sensors.thermal.detector.crops import CHANNELS, FEATURES, SCORES, normalise_crops
from peopleboy.tracker.sensors.thermal.detector.rescoring import RescoringNetwork
from tests.helpers.calls.refused import refused
from tests.helpers.images.drawn_crops import drawn_crops, drawn_weights, loss_of
from tests.helpers.images.drawn_films import drawn_film

loss = jax.jit(partial(loss_of, RescoringTraining()))


@pytest.fixture(scope="module")
def shots(tmp_path_factory: pytest.TempPathFactory) -> list[ThermalImage]:
    path = Path(tmp_path_factory.mktemp("films")) / "film.npz"
    drawn_film(0, 4).save(path)
    return load_images([path])


def looked(shots: list[ThermalImage], *, varies: bool, seed: int = 0) -> CropSamples:
    drawn = versions(shots, np.random.default_rng(seed), 2 if varies else 0)
    parts = [RescoringTraining().sample(one, augments=varies) for one in drawn]
    return CropSamples.join([CropSamples.empty(RescoringNetwork.ARCHITECTURE.crop, 4), *parts])


def test_what_is_proposed_is_told_with_whom_it_shows(shots: list[ThermalImage]) -> None:
    looks = looked(shots, varies=False)
    assert looks.crops.shape[1:3] == RescoringNetwork.ARCHITECTURE.crop[:2]
    assert len({len(each) for each in looks.arrays().values()}) == 1
    assert looks.overlap.max() > 0.4
    someone = looks.overlap > 0.4
    # Drawn people are wider than torsos.
    assert np.abs(looks.offsets[someone, 3] - 0.3).max() < 0.15


def test_the_same_random_numbers_give_the_same_examples(shots: list[ThermalImage]) -> None:
    one, same, other = (looked(shots, varies=True, seed=seed) for seed in (1, 1, 2))
    for a, b in zip(one.arrays().values(), same.arrays().values(), strict=True):
        np.testing.assert_array_equal(a, b, strict=True)
    assert one.crops.shape != other.crops.shape or not np.array_equal(one.crops, other.crops)


def test_a_mirror_s_mirror_shows_the_same(shots: list[ThermalImage]) -> None:
    looks = looked(shots, varies=False)
    for a, b in zip(looks.mirror().mirror().arrays().values(), looks.arrays().values(), strict=True):
        np.testing.assert_array_equal(a, b)
    np.testing.assert_array_equal(looks.mirror().features[:, 4], looks.features[:, 5])
    np.testing.assert_array_equal(looks.mirror().offsets[:, 0], -looks.offsets[:, 0])


def test_no_images_give_no_examples() -> None:
    none = looked([], varies=True)
    assert none.features.shape == (0, FEATURES)


def test_the_loss_is_that_of_log_odds_and_huber_s_of_places() -> None:
    looks, weights = (
        drawn_crops(RescoringNetwork.ARCHITECTURE, 6),
        drawn_weights(RescoringNetwork.ARCHITECTURE),
    )
    planes = normalise_crops(looks.crops)
    ours = RescoringNetwork(weights | {"line": np.array([1.0, 0.0], np.float32)}).predict(
        planes, looks.features
    )
    is_person = looks.overlap > 0.5
    off = np.abs((ours[:, 1:] - looks.offsets) / RescoringNetwork.SCALES[1:]) * is_person[:, None]
    bent = np.where(off < 2.0, off**2 / 2.0, 2.0 * off - 2.0)
    expected = np.log1p(np.exp(np.where(is_person, -ours[:, 0], ours[:, 0]))).mean() + 0.5 * bent.mean()
    assert float(loss(weights, planes, looks)[0]) == pytest.approx(expected, rel=1e-3)


@pytest.mark.usefixtures("small")
def test_who_is_neither_somebody_nor_nobody_does_not_count() -> None:
    looks, weights = (
        drawn_crops(RescoringNetwork.ARCHITECTURE, 4),
        drawn_weights(RescoringNetwork.ARCHITECTURE),
    )
    planes, between = normalise_crops(looks.crops), replace(looks, overlap=np.full(4, 0.3, np.float32))
    slopes = jax.jit(jax.grad(lambda w: loss_of(RescoringTraining(), w, planes, between)[0]))(weights)
    assert all(not np.asarray(slope).any() for slope in slopes.values())


@pytest.mark.parametrize(
    ("overlap", "told"), [([0.9, 0.8, 0.3], "2 of 2"), ([0.0, 0.1], "0 of 2"), ([], "0 of 0")]
)
def test_people_alone_or_none_are_refused(overlap: list[float], told: str) -> None:
    none = CropSamples.empty(RescoringNetwork.ARCHITECTURE.crop, 4)
    with refused(f"{told} validation detections are people", "use more sequences"):
        RescoringTraining().check(replace(none, overlap=np.array(overlap, np.float32)))


@pytest.mark.usefixtures("small")
def test_scores_become_log_odds() -> None:
    # A network that says nothing new, of a first look that is four times too sure.
    rng = np.random.default_rng(0)
    true = rng.normal(0.0, 1.5, 4000)
    is_person = rng.random(4000) < 1.0 / (1.0 + np.exp(-true))
    features = np.zeros((4000, FEATURES), np.float32)
    features[:, 0] = 4.0 * true / SCORES
    crops = np.broadcast_to(np.uint8(0), (4000, *RescoringNetwork.ARCHITECTURE.crop[:2], CHANNELS))
    looks = CropSamples(crops, features, is_person.astype(np.float32), np.zeros((4000, 4), np.float32))
    weights = first_weights(RescoringNetwork.ARCHITECTURE, rng)
    weights["last"][:] = 0.0
    network = with_log_odds(RescoringNetwork(weights | {"line": np.array([1.0, 0.0], np.float32)}), looks)
    gain, offset = network.weights["line"].tolist()
    assert gain == pytest.approx(0.25, abs=0.03)
    assert offset == pytest.approx(0.0, abs=0.1)
    told = network.predict(normalise_crops(crops[:5]), features[:5])[:, 0]
    np.testing.assert_allclose(told, gain * 4.0 * true[:5] + offset, rtol=1e-4, atol=1e-4)
