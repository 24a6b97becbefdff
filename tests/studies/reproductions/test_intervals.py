"""Intervals and effect sizes against formulas of the textbook and simulated data."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import ttest_ind_from_stats, ttest_rel

from peopleboy.studies.reproductions.experiments.experiment import Line
from peopleboy.studies.reproductions.showing.beside_source import Standing, compare
from peopleboy.studies.reproductions.showing.intervals import (
    SHARE,
    by_stretches,
    cohens_h,
    hedges_g,
    margin,
    paired,
    to_source,
)
from peopleboy.studies.reproductions.showing.source import SourceTable
from peopleboy.studies.training.distance_learning.image_errors import ImageErrors

ONE, OTHER = np.array([72.1, 70.4, 71.9, 73.0, 71.2]), np.array([70.0, 70.1, 70.3, 71.9, 70.8])


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


@pytest.mark.parametrize(
    ("column", "ours", "standing"),
    [
        ("AA", [60.5, 60.1, 60.3], Standing.ALIKE),
        ("AA", [70.5, 70.1, 70.3], Standing.BETTER),
        ("AA", [50.5, 50.1, 50.3], Standing.WORSE),
        ("AA", [50.5, 70.1, 62.3], Standing.UNCLEAR),
        ("AA", [70.0], Standing.UNCLEAR),
        ("AA", [np.nan, 1.0], Standing.UNKNOWN),
        ("s", [20.0, 20.1, 20.2], Standing.BETTER),
    ],
)
def test_a_figure_stands_where_its_interval_puts_it(
    column: str, ours: list[float], standing: Standing
) -> None:
    table = SourceTable.model_validate(
        {"title": "t", "source": "s", "values": [{"group": "a", "ms": 3, column: 60.0}]}
    )
    samples = {Line("a", "default"): {column: np.array(ours), "ms": np.array([1.0])}}
    (found,) = compare(samples, table)
    assert (found.column, found.who, found.standing) == (column, "default", standing)
