"""Tests of which of two ways to measure errs less: the 2003 paper's, and a paired one by blocks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm, ttest_ind_from_stats, ttest_rel

from peopleboy.studies.training.distance_learning.image_errors import ErrorSummary, ImageErrors

Interval = tuple[float, float]

_SURE = float(norm.ppf(0.975))  # deviations that hold 95 %


@dataclass(frozen=True, slots=True, kw_only=True)
class TTest:
    """A t-test.

    Attributes:
        t, p: its statistic, positive where the first errs more, and its two-sided p-value.
        count: of values on each side.
        effect: of Cohen, d or d_z.
        interval: 95 % confidence interval of the effect.
    """

    t: float
    p: float
    count: int
    effect: float
    interval: Interval


def paired_by_blocks(one: ImageErrors, other: ImageErrors) -> TTest | None:
    """Compare the mean errors of the same stretches of time; None with fewer than two of them.

    The effect is d_z, the mean difference in standard deviations of the differences.
    """
    first, second = one.block_means, other.block_means
    is_pair = np.isfinite(first) & np.isfinite(second)
    count = int(np.count_nonzero(is_pair))
    if count < 2 or np.ptp(first[is_pair] - second[is_pair]) == 0.0:
        return None
    found = ttest_rel(first[is_pair], second[is_pair])
    t = float(found.statistic)
    effect = t / math.sqrt(count)
    half = spread_of_effect(effect, count)
    return TTest(
        t=t, p=float(found.pvalue), count=count, effect=effect, interval=(effect - half, effect + half)
    )


def unpaired(one: ImageErrors, other: ImageErrors) -> TTest:
    """Compare the errors of all splits of one film as if all were independent, which they are not.

    Means and deviations are those of all films, the number of images is that of one of them: the 2003 paper
    has one film, and only its ten splits together give the significance that it reports. The effect is d.

    Source: OMNIVIS 2003, section 6, which names Student's test for unpaired samples.
    """
    first, second = one.all, other.all
    counts = [max(round(part.all.count / part.films), 2) for part in (one, other)]
    found = ttest_ind_from_stats(
        first.mean, first.deviation, counts[0], second.mean, second.deviation, counts[1]
    )
    effect, interval = cohens_d(first, second, min(counts))
    return TTest(
        t=float(found.statistic), p=float(found.pvalue), count=min(counts), effect=effect, interval=interval
    )


def cohens_d(one: ErrorSummary, other: ErrorSummary, count: int) -> tuple[float, Interval]:
    """Give two means' difference in pooled deviations, and its 95 % interval with so many on each side."""
    spread = math.sqrt((one.deviation**2 + other.deviation**2) / 2.0)
    if spread == 0.0:
        return math.nan, (math.nan, math.nan)
    d = (one.mean - other.mean) / spread
    half = _SURE * math.sqrt(2.0 / count + d**2 / (4.0 * count))
    return d, (d - half, d + half)


def spread_of_effect(d_z: float, count: int) -> float:
    """Give half the 95 % interval of an effect d_z of so many pairs, as it is for large samples."""
    return _SURE * math.sqrt(1.0 / count + d_z**2 / (2.0 * count))
