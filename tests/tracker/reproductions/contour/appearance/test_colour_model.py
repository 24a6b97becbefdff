import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.tracker.reproductions.contour.appearance.appearance_model import (
    ColourModel,
    likelihood,
    squared_distances,
)
from peopleboy.tracker.reproductions.contour.colour_config import ColourDescriptorConfig

CONFIG = ColourDescriptorConfig()
NAN = np.float32(np.nan)
vectors = st.lists(st.floats(-3, 3, width=32), min_size=4, max_size=4).map(lambda v: np.array(v, np.float32))


@given(st.lists(vectors, min_size=1, max_size=25))
def test_the_model_is_the_mean_of_the_last_n_k_descriptions(descriptions):
    model = ColourModel.begin(descriptions[0], CONFIG)
    for features in descriptions[1:]:
        model = model.updated(features)
    assert model.mean == pytest.approx(np.mean(descriptions[-CONFIG.frames :], axis=0), abs=1e-5)


def test_new_colours_are_learned_completely_in_n_k_frames():
    old, new = np.zeros(27, np.float32), np.ones(27, np.float32)
    model = ColourModel.begin(old, CONFIG)
    for _ in range(30):
        model = model.updated(old)
    levels = []
    for _ in range(CONFIG.frames):
        model = model.updated(new)
        levels.append(model.mean[0])
    assert levels == pytest.approx(np.arange(1, 11) / 10)


def test_updating_makes_a_new_model_and_leaves_the_old_one():
    model = ColourModel.begin(np.zeros(3, np.float32), CONFIG)
    model.updated(np.ones(3, np.float32))
    assert model.mean.tolist() == [0, 0, 0]
    with pytest.raises(ValueError, match="read-only"):
        model.recent[0, 0] = 1


def test_an_unseen_part_keeps_what_is_known_of_it_and_learns_nothing():
    model = ColourModel.begin(np.array([0.2, 0.8, NAN], np.float32), CONFIG)
    for _ in range(20):
        model = model.updated(np.array([0.4, NAN, NAN], np.float32))
    assert model.mean[:2] == pytest.approx([0.4, 0.8])
    assert np.isnan(model.mean[2])
    assert model.updated(np.full(3, NAN)) is model
    assert model.updated(np.array([0.4, 0.8, 0.6], np.float32)).mean[2] == pytest.approx(0.6)


def test_a_model_that_never_saw_anything_says_so():
    empty = ColourModel.begin(np.full(3, NAN), CONFIG)
    assert np.isnan(empty.mean).all()
    assert empty.updated(np.array([0.1, NAN, NAN], np.float32)).mean[0] == np.float32(0.1)


@settings(deadline=None)
@given(vectors, vectors, st.floats(0, 100))
def test_the_likelihood_is_equation_6_4(features, mean, sharpness):
    config = ColourDescriptorConfig(sharpness=sharpness)
    model = ColourModel.begin(mean, config)
    expected = np.exp(-sharpness * np.sum((features.astype(float) - mean) ** 2))
    assert likelihood(features[None], model, config)[0] == pytest.approx(expected, rel=1e-2, abs=1e-6)


def test_unseen_features_count_as_the_seen_ones_do_on_average():
    model = ColourModel.begin(np.zeros(4, np.float32), CONFIG)
    features = np.array([[0.1, 0.3, NAN, NAN], [0.1, 0.3, 0.1, 0.3], [NAN] * 4], np.float32)
    distances = squared_distances(features, model)
    assert distances[:2] == pytest.approx([0.2, 0.2])
    assert np.isnan(distances[2])


def test_who_cannot_be_compared_is_neither_favoured_nor_punished():
    model = ColourModel.begin(np.zeros(2, np.float32), CONFIG)
    features = np.array([[0.0, 0.0], [0.2, 0.1], [NAN, NAN]], np.float32)
    chance = likelihood(features, model, CONFIG)
    assert chance[2] == pytest.approx((chance[0] + chance[1]) / 2)
    assert likelihood(features[2:], model, CONFIG).tolist() == [1.0]
