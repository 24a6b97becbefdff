import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.tracker.reproductions.contour.contour_config import (
    AppearanceConfig,
    DepthOrderConfig,
    FilterConfig,
    HeightConfig,
    LikelihoodConfig,
    LimitsConfig,
    MotionConfig,
    StayBehindConfig,
)
from peopleboy.tracker.reproductions.contour.measurement.likelihood import fitness, probability
from peopleboy.tracker.reproductions.contour.particle_filter import is_within, sample_weights
from peopleboy.tracker.reproductions.contour.particles import draw_prior, limits_px

THESIS = LikelihoodConfig()
ALPHA = np.array([0.18, 0.18, 0.18, 0.07, 0.07, 0.16, 0.16, 0.0])


@given(st.floats(-200, 200))
def test_the_probability_is_equation_4_4(f):
    k, t = 0.125, 22
    up, down = np.exp(k * (f - t)), np.exp(k * (t - f))
    assert probability(np.array([f], np.float32), THESIS)[0] == pytest.approx(up / (up + down), abs=1e-5)


def test_the_probability_is_one_half_at_the_threshold_and_never_overflows():
    with np.errstate(all="raise"):
        chance = probability(np.array([-1e6, 22, 1e6], np.float32), THESIS)
    assert np.allclose(chance, [0, 0.5, 1], atol=1e-6)


def test_the_thesis_fitness_is_the_weighted_sum_of_the_differences():
    differences = np.random.default_rng(0).normal(20, 15, (30, 8)).astype(np.float32)
    assert np.allclose(fitness(differences, ALPHA, THESIS), differences @ ALPHA, rtol=1e-4, atol=1e-4)


def test_the_paper_fitness_multiplies_the_sum_by_the_weight_of_the_strong_sections():
    differences = np.random.default_rng(0).normal(12, 15, (30, 8)).astype(np.float32)
    differences[:, 7] = 0
    expected = []
    for row in differences[:, :7]:
        weight = sum(a for a, value in zip(ALPHA, row, strict=False) if value >= 10)
        expected.append(weight * sum(row) / 7)
    assert np.allclose(fitness(differences, ALPHA, LikelihoodConfig(model="paper")), expected, atol=1e-3)


def test_the_weakest_section_pulls_the_fitness_down():
    differences = np.full((1, 8), 0.8, dtype=np.float32)
    differences[0, 2] = 0.1
    config = LikelihoodConfig(weakest_share=0.5)
    assert fitness(differences, ALPHA, config)[0] == pytest.approx(
        0.5 * (0.82 * 0.8 + 0.18 * 0.1) + 0.5 * 0.1
    )


@pytest.mark.parametrize(("model", "sharpness"), [("thesis", 0.0), ("thesis", 3.0), ("paper", 0.0)])
def test_weights_sum_to_one_and_grow_with_the_fitness(model, sharpness):
    fit = np.linspace(1, 40, 50).astype(np.float32)
    config = FilterConfig(sharpness=sharpness)
    weight = sample_weights(fit, probability(fit, THESIS), np.ones(50, bool), model, config)
    assert weight.sum() == pytest.approx(1, abs=1e-5)
    assert np.all(np.diff(weight) >= 0)


def test_a_sample_outside_the_limits_is_hardly_ever_chosen():
    fit = np.full(10, 30, np.float32)
    inside = np.arange(10) != 4
    weight = sample_weights(fit, probability(fit, THESIS), inside, "thesis", FilterConfig())
    assert weight[4] == pytest.approx(1e-6 / 9, rel=0.01)


@pytest.mark.parametrize(
    ("change", "is_right"),
    [
        ({}, True),
        ({2: 0.09 * 40}, False),
        ({2: 0.11 * 40}, True),
        ({2: 0.91 * 40}, False),
        ({4: 1.51 * 16}, False),
        ({4: -1.49 * 16}, True),
        ({1: 0.19 * 240}, False),
        ({1: 0.81 * 240}, False),
        ({2: 1.0, 3: 0.019 * 240}, False),
    ],
)
def test_the_limits_are_those_of_the_thesis(change, is_right):
    state = np.array([[160, 120, 16, 40, 0, 0, 0, 0, 0]], dtype=np.float32)
    for column, value in change.items():
        state[0, column] = value
    assert is_within(state, limits_px(240, LimitsConfig()))[0] == is_right


def test_people_on_the_floor_have_their_middle_just_below_the_horizon():
    limits = LimitsConfig(y_below_horizon=(-0.1, 0.9))
    state = np.zeros((3, 9), dtype=np.float32)
    state[:, 2], state[:, 3] = 8, 20
    state[:, 1] = [117, 130, 139]
    assert list(is_within(state, limits_px(240, limits))) == [False, True, False]


@pytest.mark.parametrize(
    "limits", [LimitsConfig(), LimitsConfig(y=(0.1, 0.8), h=(0.05, 0.5), y_below_horizon=(-0.1, 0.9))]
)
@pytest.mark.parametrize("log_uniform_h", [False, True])
def test_samples_from_the_prior_lie_within_the_limits(limits, log_uniform_h):
    config = FilterConfig(limits=limits, log_uniform_h=log_uniform_h)
    state = draw_prior(5000, (240, 320), MotionConfig(), config, np.random.default_rng(0))
    assert is_within(state, limits_px(240, limits)).mean() > 0.999
    assert state[:, 0].min() >= 0
    assert state[:, 0].max() <= 320


def test_samples_from_the_prior_have_the_speeds_they_are_given():
    motion = MotionConfig(fresh_speed=(60.0, 8.0, 2.0, 1.0))
    state = draw_prior(20000, (480, 640), motion, FilterConfig(), np.random.default_rng(0))
    assert np.allclose(state[:, 5:].std(axis=0), (120, 16, 4, 2), rtol=0.05)


@pytest.mark.parametrize(
    "make",
    [
        lambda: LimitsConfig(y=(0.8, 0.2)),
        lambda: LimitsConfig(h=(0.1, float("nan"))),
        lambda: LikelihoodConfig(model="best"),
        lambda: LikelihoodConfig(slope=0.0),
        lambda: FilterConfig(count=0),
        lambda: FilterConfig(fresh_share=1.5),
        lambda: MotionConfig(noise_x=-1.0),
        lambda: MotionConfig(place_memory=1.5),
        lambda: AppearanceConfig(grey_spread=(0.1, 0.0, 0.1)),
        lambda: DepthOrderConfig(order="height"),
        lambda: DepthOrderConfig(growth=0.0),
        lambda: HeightConfig(memory_s=0.0),
        lambda: HeightConfig(overlapped_spread=-0.1),
        lambda: StayBehindConfig(head_covered=1.5),
    ],
)
def test_settings_that_cannot_be_are_refused_in_one_line(make):
    with pytest.raises(BadInput) as error:
        make()
    assert "\n" not in str(error.value)
