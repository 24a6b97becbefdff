"""Ours beside the source's: means over repeats, and whether the source's claims hold for us."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from peopleboy.studies.reproductions.experiments.experiment import Figures, FilmFigure, Line, Samples
from peopleboy.studies.reproductions.experiments.tracking import PAPER, THESIS
from peopleboy.studies.reproductions.showing.error_tests import (
    TTest,
    cohens_d,
    paired_by_blocks,
    unpaired,
)
from peopleboy.studies.reproductions.showing.intervals import Gap, by_stretches, margin, mean_of, paired
from peopleboy.studies.reproductions.showing.source import Claim
from peopleboy.studies.training.distance_learning.image_errors import ErrorSummary, ImageErrors

BLIND = 5.0  # [%] below which both figures say only that nobody is found
MUCH = 0.5  # of what the source gains, which a gain has to reach


class ClaimStatus(StrEnum):
    """How a claim fares."""

    HOLDS = "holds"
    WEAKER = "holds, but weaker"
    UNCLEAR = "undecided"
    FAILS = "does not hold"
    BLIND = "finds too few people to tell"
    UNKNOWN = "not measured"


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a claim of the source holds for one of our trackers.

    Attributes:
        who: which tracker.
        difference: of our figures of the two groups.
        outcome: how the claim fares.
        tests: of errors of images, by name, in words.
        times: the first figure over the second, where the claim is about that; None elsewhere.
    """

    who: str
    difference: Gap
    outcome: ClaimStatus
    tests: tuple[str, ...] = ()
    times: float | None = None


def judge(claim: Claim, samples: Samples) -> Iterator[Verdict]:
    """Check a claim for everybody who has figures in both of its groups."""
    first, second = claim.groups
    for line, figures in samples.items():
        other = samples.get(Line(second, line.who))
        if line.group == first and other is not None and claim.metric in figures:
            yield _verdict(claim, line.who, figures[claim.metric], other[claim.metric])


def _verdict(claim: Claim, who: str, one: Figures, other: Figures) -> Verdict:
    if isinstance(one, ImageErrors) and isinstance(other, ImageErrors):
        difference = by_stretches(one, other)
        return Verdict(
            who, difference, _outcome(claim, difference, other.all.mean), tuple(_tests(one, other))
        )
    assert not isinstance(one, ImageErrors)
    assert not isinstance(other, ImageErrors)  # a column has figures of one kind
    difference, second = paired(claim.metric, one, other), mean_of(other)
    if math.isnan(difference.by):
        outcome = ClaimStatus.UNKNOWN
    elif claim.metric in (*THESIS, *PAPER) and max(second, second + difference.by) < BLIND:
        outcome = ClaimStatus.BLIND
    else:
        outcome = _outcome(claim, difference, second)
    times = None if claim.times is None else mean_of(one) / second
    return Verdict(who, difference, outcome, times=times)


def _tests(one: ImageErrors, other: ImageErrors) -> Iterator[str]:
    paired_test = paired_by_blocks(one, other)
    if paired_test is not None:
        yield _words("paired by stretches of time", "d_z", paired_test)
    yield _words("as the source, all images of a film's splits unpaired", "d", unpaired(one, other))


def _words(name: str, effect: str, test: TTest) -> str:
    low, high = test.interval
    size = f"{effect} = {test.effect:.2f} ({low:.2f} to {high:.2f})"
    chance = "p < 0.001" if test.p < 0.001 else f"p = {test.p:.3f}"
    return f"{name}: t = {test.t:.2f}, n = {test.count}, {chance}, {size}"


def _outcome(claim: Claim, ours: Gap, second: float) -> ClaimStatus:
    """Hold the interval of a difference against what is claimed; without an interval nothing is decided."""
    if not ours.is_sure:
        return ClaimStatus.UNCLEAR
    if claim.expect in ("alike", "no less"):
        return _alike(ours, margin(claim.metric, second), either_way=claim.expect == "alike")
    least = MUCH * (abs(claim.by or 0.0) if claim.times is None else abs(claim.times - 1.0) * second)
    if claim.expect == "differs":
        is_far = ours.low > least or ours.high < -least
        is_near = -least <= ours.low and ours.high <= least
        return ClaimStatus.HOLDS if is_far else ClaimStatus.FAILS if is_near else ClaimStatus.UNCLEAR
    low, high = (ours.low, ours.high) if claim.expect == "more" else (-ours.high, -ours.low)
    if low > least:
        return ClaimStatus.HOLDS
    if high <= least:
        return ClaimStatus.WEAKER if low > 0 else ClaimStatus.FAILS
    return ClaimStatus.UNCLEAR


def _alike(ours: Gap, within: float, *, either_way: bool) -> ClaimStatus:
    """Tell whether the interval is within a margin, on either side or below alone."""
    if ours.low >= -within and (ours.high <= within or not either_way):
        return ClaimStatus.HOLDS
    is_apart = ours.high < -within or (either_way and ours.low > within)
    return ClaimStatus.FAILS if is_apart else ClaimStatus.UNCLEAR


def mean_and_spread(values: Figures) -> tuple[float, float | None]:
    """Give mean and standard deviation, over the repeats or of the images; None where there is one repeat."""
    if isinstance(values, ImageErrors):
        return values.all.mean, values.all.deviation
    if isinstance(values, FilmFigure):
        return values.whole, None
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
