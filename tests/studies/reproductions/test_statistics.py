"""Intervals, effect sizes and tests against formulas of the textbook and simulated data."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import ttest_ind, ttest_ind_from_stats, ttest_rel

from peopleboy.studies.reproductions.experiment import Jackknife
from peopleboy.studies.reproductions.image_errors import BLOCKS, ErrorSummary, ImageErrors
from peopleboy.studies.reproductions.statistics import (
    SHARE,
    bootstrap_interval,
    by_stretches,
    cohens_d,
    cohens_h,
    hedges_g,
    margin,
    paired,
    paired_by_blocks,
    spread_of_effect,
    to_source,
    unpaired,
)

ONE, OTHER = np.array([72.1, 70.4, 71.9, 73.0, 71.2]), np.array([70.0, 70.1, 70.3, 71.9, 70.8])


def of_means(values: NDArray[np.float64], films: str = "dataset1") -> Jackknife:
    """Give the mean of films that weigh the same, and those without each of them."""
    without = (values.sum() - values) / (len(values) - 1)
    return Jackknife(float(values.mean()), without, (films,))


def test_of_a_mean_the_jackknife_gives_back_what_it_is_of() -> None:
    np.testing.assert_allclose(of_means(ONE).by_sequence, ONE)


def test_the_same_films_are_compared_one_by_one_and_others_as_two_samples() -> None:
    same, apart = (
        paired("AA", of_means(ONE), of_means(OTHER)),
        paired("AA", of_means(ONE), of_means(OTHER, "b")),
    )
    student = ttest_rel(ONE, OTHER).confidence_interval(0.95)
    welch = ttest_ind(ONE, OTHER, equal_var=False).confidence_interval(0.95)
    assert (same.low, same.high) == pytest.approx((student.low, student.high))
    assert (apart.low, apart.high) == pytest.approx((welch.low, welch.high))


def test_a_printed_figure_is_compared_with_all_films() -> None:
    found = to_source("AA", of_means(ONE), 70.0, None)
    student = ttest_rel(ONE, np.full(5, 70.0)).confidence_interval(0.95)
    assert (found.low, found.high) == pytest.approx((student.low, student.high))


def test_one_film_against_several_has_no_interval() -> None:
    assert not paired("AA", of_means(ONE), np.array([70.0])).is_sure


def test_the_interval_of_repeats_is_students() -> None:
    found, textbook = paired("AA", ONE, OTHER), ttest_rel(ONE, OTHER).confidence_interval(0.95)
    assert (found.low, found.high) == pytest.approx((textbook.low, textbook.high))
    assert found.by == pytest.approx((ONE - OTHER).mean())


def test_one_repeat_has_a_difference_and_no_interval() -> None:
    found = paired("AA", ONE[:1], OTHER[:1])
    assert found.by == pytest.approx(2.1)
    assert not found.is_sure
    assert not to_source("AA", ONE[:1], 70.0, None).is_sure


def test_splits_of_the_same_examples_have_a_wider_interval() -> None:
    plain, splits = paired("AA", ONE, OTHER), paired(SHARE, ONE, OTHER)
    ratio = (splits.high - splits.low) / (plain.high - plain.low)
    assert ratio == pytest.approx(np.sqrt((1 / 5 + 0.4 / 0.6) / (1 / 5)))


def test_a_printed_deviation_makes_the_interval_welchs() -> None:
    found = to_source("AA", ONE, 70.0, 2.0)
    welch = ttest_ind_from_stats(ONE.mean(), ONE.std(ddof=1), 5, 70.0, 2.0, 10, equal_var=False)
    half = (found.high - found.low) / 2
    assert found.by == pytest.approx(ONE.mean() - 70.0)
    spread = np.sqrt(ONE.var(ddof=1) / 5 + 2.0**2 / 10)
    assert welch.statistic == pytest.approx(found.by / spread)
    assert 1.96 * spread < half < 2.78 * spread


def test_of_intervals_of_simulated_repeats_95_of_100_hold_the_true_difference() -> None:
    rng = np.random.default_rng(0)
    held = [
        found.low <= 1.0 <= found.high
        for found in (paired("AA", rng.normal(61, 2, 10), rng.normal(60, 2, 10)) for _ in range(2000))
    ]
    assert np.mean(held) == pytest.approx(0.95, abs=0.015)


def test_effect_sizes_are_cohens_and_hedges() -> None:
    assert cohens_h(50.0, 50.0) == 0.0
    assert cohens_h(100.0, 0.0) == pytest.approx(np.pi)
    assert cohens_h(25.0, 21.0) == pytest.approx(0.095, abs=0.001)
    assert hedges_g(1.0, (2.0, 2.0), 10) == pytest.approx(0.5 * (1 - 3 / 71))
    assert np.isnan(hedges_g(1.0, (0.0, 0.0), 10))
    assert np.isnan(hedges_g(1.0, (2.0,), 2))  # the correction of a single degree of freedom is 0
    assert paired("AA", ONE, OTHER).effect.startswith("h = +")
    assert paired("m", ONE, OTHER).effect.startswith("g = +")


def test_rates_are_alike_within_points_and_all_else_within_a_share() -> None:
    assert margin("AA", 60.0) == 2.0
    assert margin("m", -0.5) == pytest.approx(0.05)


def test_errors_of_images_are_compared_by_stretches_of_time() -> None:
    rng = np.random.default_rng(1)
    errors = rng.exponential(0.1, 400)
    one, other = (ImageErrors.of([(np.arange(400), e)], 400) for e in (errors, errors + 0.02))
    found = by_stretches(one, other)
    assert (found.by, found.low, found.high) == pytest.approx((-0.02, -0.02, -0.02))


COUNT = 400


def film(errors: np.ndarray) -> ImageErrors:
    return ImageErrors.of([(np.arange(COUNT), errors)], COUNT)


@pytest.fixture(name="pair")
def two_ways() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    first = rng.exponential(0.1, COUNT)
    return first, np.abs(first + rng.normal(-0.01, 0.02, COUNT))


def test_blocks_are_compared_pair_by_pair(pair: tuple[np.ndarray, np.ndarray]) -> None:
    one, other = pair
    found = paired_by_blocks(film(one), film(other))
    means = [errors.reshape(BLOCKS, -1).mean(axis=1) for errors in pair]
    expected = ttest_rel(*means)
    away = means[0] - means[1]
    assert found is not None
    assert (found.t, found.p, found.count) == pytest.approx((expected.statistic, expected.pvalue, BLOCKS))
    assert found.effect == pytest.approx(away.mean() / away.std(ddof=1))
    low, high = found.interval
    assert low < found.effect < high


def test_blocks_in_which_one_way_was_not_tested_count_on_neither_side(
    pair: tuple[np.ndarray, np.ndarray],
) -> None:
    half = ImageErrors.of([(np.arange(COUNT // 2), pair[1][: COUNT // 2])], COUNT)
    found = paired_by_blocks(film(pair[0]), half)
    assert found is not None
    assert found.count == BLOCKS // 2
    assert paired_by_blocks(film(pair[0]), film(pair[0])) is None


def test_the_papers_test_takes_all_images_for_independent(pair: tuple[np.ndarray, np.ndarray]) -> None:
    found = unpaired(film(pair[0]), film(pair[1]))
    expected = ttest_ind(*pair)
    assert found.count == COUNT
    assert found.t == pytest.approx(expected.statistic, rel=0.01)
    two_films = [ImageErrors.joined([film(errors), film(errors)]) for errors in pair]
    assert unpaired(*two_films).t == pytest.approx(found.t)


def test_the_papers_own_figures_are_significant_only_with_ten_splits_in_one_heap() -> None:
    alone, filtered = (
        ImageErrors(splits=(ErrorSummary(images=479, mean=mean, deviation=deviation),))
        for mean, deviation in ((0.154, 0.094), (0.145, 0.092))
    )
    assert unpaired(alone, filtered).p > 0.1
    ten = [ImageErrors(splits=errors.splits * 10) for errors in (alone, filtered)]
    assert unpaired(*ten).t == pytest.approx(4.7, abs=0.1)
    assert unpaired(*ten).p < 0.01


def test_an_effect_s_interval_holds_the_true_effect_95_times_in_100() -> None:
    rng, true, inside = np.random.default_rng(1), 0.5, 0
    for _ in range(300):
        values = rng.normal(true, 1.0, 20)
        d_z = values.mean() / values.std(ddof=1)
        inside += abs(d_z - true) < spread_of_effect(d_z, 20)
    assert inside / 300 == pytest.approx(0.95, abs=0.035)


def test_d_is_in_pooled_deviations_and_its_interval_narrows_with_more_images() -> None:
    one, other = (ErrorSummary(images=9, mean=mean, deviation=2.0) for mean in (3.0, 2.0))
    d, (low, high) = cohens_d(one, other, 100)
    assert d == pytest.approx(0.5)
    assert (low + high) / 2 == pytest.approx(0.5)
    narrow = cohens_d(one, other, 400)[1]
    assert (narrow[1] - narrow[0]) == pytest.approx((high - low) / 2)


def test_the_bootstraps_interval_of_a_mean_is_about_students_and_the_same_again() -> None:
    values = np.random.default_rng(0).normal(10.0, 2.0, 40).tolist()
    low, high = bootstrap_interval(values, lambda drawn: float(np.mean(drawn)))
    textbook = ttest_rel(values, np.zeros(40)).confidence_interval(0.95)
    assert (low, high) == pytest.approx((textbook.low, textbook.high), abs=0.1)
    assert (low, high) == bootstrap_interval(values, lambda drawn: float(np.mean(drawn)))
    assert np.isnan(bootstrap_interval(values[:1], max)).all()
