"""Tests of errors against formulas of the textbook and simulated data."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import ttest_ind, ttest_rel

from peopleboy.studies.reproductions.showing.error_tests import (
    cohens_d,
    paired_by_blocks,
    spread_of_effect,
    unpaired,
)
from peopleboy.studies.training.distance_learning.image_errors import BLOCKS, ErrorSummary, ImageErrors

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
        ImageErrors(splits=(ErrorSummary(count=479, mean=mean, deviation=deviation),))
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
    one, other = (ErrorSummary(count=9, mean=mean, deviation=2.0) for mean in (3.0, 2.0))
    d, (low, high) = cohens_d(one, other, 100)
    assert d == pytest.approx(0.5)
    assert (low + high) / 2 == pytest.approx(0.5)
    narrow = cohens_d(one, other, 400)[1]
    assert (narrow[1] - narrow[0]) == pytest.approx((high - low) / 2)
