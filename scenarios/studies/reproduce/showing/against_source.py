"""Ours beside the source's: means over repeats, and whether the source's claims hold for us."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.stats import ttest_rel

from peopleboy.scenarios.studies.distance_learning.image_errors import ErrorSummary, ImageErrors
from peopleboy.scenarios.studies.reproduce.experiments.experiment import Figures, Line, Samples
from peopleboy.scenarios.studies.reproduce.experiments.tracking import PAPER, THESIS
from peopleboy.scenarios.studies.reproduce.showing.error_tests import (
    TTest,
    cohens_d,
    paired_by_blocks,
    unpaired,
)
from peopleboy.scenarios.studies.reproduce.showing.source import Claim

SIGNIFICANT = 0.01
ALIKE = 2.0  # [points] within which two figures are called alike, where the source has no test
BLIND = 5.0  # [%] below which both figures say only that nobody is found

Floats = NDArray[np.float64]


class ClaimStatus(StrEnum):
    """How a claim fares."""

    HOLDS = "holds"
    UNCLEAR = "undecided"
    FAILS = "does not hold"
    BLIND = "finds too few people to tell"
    UNKNOWN = "not measured"


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a claim of the source holds for one of our trackers.

    Attributes:
        who: which tracker.
        first, second: our means of the two groups.
        p: of the paired t-test over the repeats, or over stretches of time; NaN where there is none.
        outcome: how the claim fares.
        tests: of errors of images, by name, in words.
    """

    who: str
    first: float
    second: float
    p: float
    outcome: ClaimStatus
    tests: tuple[str, ...] = ()

    @property
    def by(self) -> float:
        """Difference of the means."""
        return self.first - self.second


def paired_t_test(one: Floats, other: Floats) -> float:
    """Give the p-value of Student's t-test for paired samples (R,), two-sided.

    NaN with fewer than two repeats; 1 where all pairs are equal, 0 where all differ by the same.
    """
    if one.shape != other.shape or one.size < 2 or np.isnan(one).any() or np.isnan(other).any():
        return float("nan")
    away = one - other
    if np.ptp(away) < 1e-12:
        return 1.0 if abs(away[0]) < 1e-12 else 0.0
    return float(ttest_rel(one, other).pvalue)


def judge(claim: Claim, samples: Samples) -> Iterator[Verdict]:
    """Check a claim for everybody who has figures in both of its groups."""
    first, second = claim.groups
    for line, figures in samples.items():
        other = samples.get(Line(second, line.who))
        if line.group == first and other is not None and claim.metric in figures:
            yield _verdict(claim, line.who, figures[claim.metric], other[claim.metric])


def _verdict(claim: Claim, who: str, one: Figures, other: Figures) -> Verdict:
    if isinstance(one, ImageErrors) and isinstance(other, ImageErrors):
        return _verdict_on_images(claim, who, one, other)
    assert not isinstance(one, ImageErrors)
    assert not isinstance(other, ImageErrors)  # a column has figures of one kind
    p = paired_t_test(one, other)
    first, second = float(one.mean()), float(other.mean())
    if np.isnan(first - second):
        outcome = ClaimStatus.UNKNOWN
    elif claim.metric in (*THESIS, *PAPER) and max(first, second) < BLIND:
        outcome = ClaimStatus.BLIND
    else:
        outcome = _outcome(claim, first - second, p)
    return Verdict(who, first, second, p, outcome)


def _verdict_on_images(claim: Claim, who: str, one: ImageErrors, other: ImageErrors) -> Verdict:
    first, second = one.all.mean, other.all.mean
    paired = paired_by_blocks(one, other)
    p = float("nan") if paired is None else paired.p
    told = () if paired is None else (_words("paired by stretches of time", "d_z", paired),)
    tests = (
        *told,
        _words("as the source, all images of a film's splits unpaired", "d", unpaired(one, other)),
    )
    return Verdict(who, first, second, p, _outcome(claim, first - second, p), tests)


def _words(name: str, effect: str, test: TTest) -> str:
    low, high = test.interval
    size = f"{effect} = {test.effect:.2f} ({low:.2f} to {high:.2f})"
    return f"{name}: t = {test.t:.2f}, n = {test.count}, {chance(test.p)}, {size}"


def chance(p: float) -> str:
    """Write a p-value."""
    if math.isnan(p):
        return "no test"
    return "p < 0.001" if p < 0.001 else f"p = {p:.3f}"


def _outcome(claim: Claim, by: float, p: float) -> ClaimStatus:
    """Compare a difference with a claim; where the source tests, ours has to be significant as well."""
    is_clear = p < SIGNIFICANT or not claim.tested
    if claim.expect in ("alike", "no less"):
        if by >= -ALIKE and (by <= ALIKE or claim.expect == "no less"):
            return ClaimStatus.HOLDS
        return ClaimStatus.UNCLEAR if claim.tested and p >= SIGNIFICANT else ClaimStatus.FAILS
    ways = {"more": by > 0, "less": by < 0, "differs": by != 0}
    if not ways[claim.expect]:
        return ClaimStatus.FAILS
    return ClaimStatus.HOLDS if is_clear else ClaimStatus.UNCLEAR


def mean_and_spread(values: Figures) -> tuple[float, float | None]:
    """Give mean and standard deviation, over the repeats or of the images; None where there is one repeat."""
    if isinstance(values, ImageErrors):
        return values.all.mean, values.all.deviation
    spread = float(values.std(ddof=1)) if values.size > 1 else None
    return float(values.mean()), spread


def effect_to_source(ours: ImageErrors, source: tuple[float, float | None]) -> str:
    """Say how far our errors are from the source's: Cohen's d, its 95 % interval for a split's images.

    Empty where the source gives no deviation.
    """
    mean, deviation = source
    if deviation is None:
        return ""
    count = ours.splits[0].count
    d, (low, high) = cohens_d(ours.all, ErrorSummary(count=count, mean=mean, deviation=deviation), count)
    return f"{d:+.2f} ({low:+.2f} to {high:+.2f})"
