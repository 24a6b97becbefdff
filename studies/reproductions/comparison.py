"""Compare results with a source: whether its claims hold, and how each printed value compares."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from peopleboy.studies.reproductions.experiment import SOURCE, Claim, Experiment, Line, Samples, Values
from peopleboy.studies.reproductions.image_errors import ErrorSummary, ImageErrors
from peopleboy.studies.reproductions.statistics import (
    PAPER,
    PERCENT,
    THESIS,
    ResultDifference,
    TTest,
    by_stretches,
    cohens_d,
    margin,
    mean_of,
    paired,
    paired_by_blocks,
    to_source,
    unpaired,
)

BLIND: Final = 5.0  # [%] if both values are lower, too few people are found for a decision
MUCH: Final = 0.5  # share of the source's gain that a gain must reach
_SECONDS: Final = "s"
_COMPARED: Final = (*PERCENT, _SECONDS)
"""Columns whose values do not depend on the computer."""


class ClaimStatus(StrEnum):
    """Result of checking a claim."""

    HOLDS = "holds"
    WEAKER = "holds, but weaker"
    UNCLEAR = "undecided"
    FAILS = "does not hold"
    BLIND = "too few people found to decide"
    UNKNOWN = "not measured"


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether a claim of the source holds for a tracker.

    Attributes:
        method: the tracker.
        difference: difference between the values of the two groups.
        outcome: result of the check.
        tests: t-tests of image errors, by name, as text.
        times: ratio of the first value to the second, for claims about a ratio; else None.
    """

    method: str
    difference: ResultDifference
    outcome: ClaimStatus
    tests: tuple[str, ...] = ()
    times: float | None = None


def judge(claim: Claim, samples: Samples) -> Iterator[Verdict]:
    """Check a claim for every method that has values in both of its groups."""
    first, second = claim.groups
    for line, values in samples.items():
        other = samples.get(Line(second, line.method))
        if line.group == first and other is not None and claim.metric in values:
            yield _verdict(claim, line.method, values[claim.metric], other[claim.metric])


def _verdict(claim: Claim, method: str, one: Values, other: Values) -> Verdict:
    if isinstance(one, ImageErrors) and isinstance(other, ImageErrors):
        difference = by_stretches(one, other)
        tests = {"as in the source, all images of a sequence's splits unpaired": ("d", unpaired(one, other))}
        paired_test = paired_by_blocks(one, other)
        if paired_test is not None:
            tests = {"paired by stretches of time": ("d_z", paired_test)} | tests
        words = tuple(_in_words(name, *test) for name, test in tests.items())
        return Verdict(method, difference, _outcome(claim, difference, other.all.mean), words)
    assert not isinstance(one, ImageErrors)
    assert not isinstance(other, ImageErrors)  # all values of a column are of one kind
    difference, second = paired(claim.metric, one, other), mean_of(other)
    if math.isnan(difference.by):
        outcome = ClaimStatus.UNKNOWN
    elif claim.metric in (*THESIS, *PAPER) and max(second, second + difference.by) < BLIND:
        outcome = ClaimStatus.BLIND
    else:
        outcome = _outcome(claim, difference, second)
    times = None if claim.times is None else mean_of(one) / second
    return Verdict(method, difference, outcome, times=times)


def _in_words(name: str, effect: str, test: TTest) -> str:
    low, high = test.interval
    size = f"{effect} = {test.effect:.2f} ({low:.2f} to {high:.2f})"
    chance = "p < 0.001" if test.p < 0.001 else f"p = {test.p:.3f}"
    return f"{name}: t = {test.t:.2f}, n = {test.count}, {chance}, {size}"


def _outcome(claim: Claim, ours: ResultDifference, second: float) -> ClaimStatus:
    """Compare the interval of a difference with the claim; undecided without an interval."""
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


def _alike(ours: ResultDifference, within: float, *, either_way: bool) -> ClaimStatus:
    """Check whether the interval is within a margin, on both sides or only below."""
    if ours.low >= -within and (ours.high <= within or not either_way):
        return ClaimStatus.HOLDS
    is_apart = ours.high < -within or (either_way and ours.low > within)
    return ClaimStatus.FAILS if is_apart else ClaimStatus.UNCLEAR


class Standing(StrEnum):
    """How a measured value compares with the source's."""

    BETTER = "better"
    ALIKE = "equal"
    WORSE = "worse"
    UNCLEAR = "undecided"
    UNKNOWN = "not measured"


@dataclass(frozen=True, slots=True)
class Compared:
    """A printed value and a measured one.

    Attributes:
        group, column: place in the table.
        method: the tracker of the measured value.
        source, ours: printed and measured value.
        difference: measured less printed value.
        standing: conclusion from its interval.
    """

    group: str
    column: str
    method: str
    source: float
    ours: float
    difference: ResultDifference
    standing: Standing

    @property
    def is_below(self) -> bool:
        """Whether the measured value is worse, significantly or not."""
        return self.difference.by > 0 if self.column == _SECONDS else self.difference.by < 0


def compare(samples: Samples, experiment: Experiment) -> Iterator[Compared]:
    """Compare every printed value that does not depend on the computer with the measured values."""
    for printed in experiment.values:
        for column, (source, deviation) in printed.values.items():
            if printed.method != SOURCE or column not in _COMPARED:
                continue
            for line, values in samples.items():
                ours = values.get(column)
                if line.group != printed.group or ours is None or isinstance(ours, ImageErrors):
                    continue
                away = to_source(column, ours, source, deviation)
                standing = _standing(column, away, source)
                yield Compared(line.group, column, line.method, source, mean_of(ours), away, standing)


def _standing(column: str, away: ResultDifference, source: float) -> Standing:
    """Return the standing of an interval; it is alike if within the margin on both sides."""
    if math.isnan(away.by):
        return Standing.UNKNOWN
    within = margin(column, source)
    if -within <= away.low and away.high <= within:
        return Standing.ALIKE
    if away.low > 0:
        return Standing.WORSE if column == _SECONDS else Standing.BETTER
    if away.high < 0:
        return Standing.BETTER if column == _SECONDS else Standing.WORSE
    return Standing.UNCLEAR


def effects_to_source(samples: Samples, experiment: Experiment) -> Iterator[str]:
    """Return for each measured line Cohen's d to the source, with its 95 % interval for a split's images.

    The text is empty if image errors are unknown, or if the source prints no deviation.
    """
    printed = {line.group: line.values for line in experiment.values}
    for line, values in samples.items():
        words = ""
        for name, errors in values.items():
            mean, deviation = printed.get(line.group, {}).get(name, (math.nan, None))
            if isinstance(errors, ImageErrors) and deviation is not None:
                count = errors.splits[0].images
                source = ErrorSummary(images=count, mean=mean, deviation=deviation)
                d, (low, high) = cohens_d(errors.all, source, count)
                words += f"{d:+.2f} ({low:+.2f} to {high:+.2f})"
        yield words
