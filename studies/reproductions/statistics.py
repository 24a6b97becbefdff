"""Statistics of results: differences with 95 % intervals and effect sizes, t-tests, bootstrap."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

import numpy as np
from scipy.stats import bootstrap, norm, ttest_ind_from_stats, ttest_rel
from scipy.stats import t as student

from peopleboy.random_streams import stream
from peopleboy.studies.reproductions.experiment import Floats, Jackknife, Values
from peopleboy.studies.reproductions.image_errors import ErrorSummary, ImageErrors

T = TypeVar("T")
Interval = tuple[float, float]

THESIS: Final = ("CR", "CP", "CA", "AR", "AP", "AA")
PAPER: Final = ("OC", "DC", "OCR", "OCP", "OCA", "OAR", "BAP", "ADC")
SHARE: Final = "right [%]"
PERCENT: Final = (*THESIS, *PAPER, SHARE)
"""Columns of rates, in percent."""
POINTS: Final = 2.0  # margin for rates that are called alike
PART: Final = 0.1  # margin for all other values, as a share of the second value
SOURCE_REPEATS: Final = 10  # number of repeats of the sources' deviations (thesis, sections 4.4 and 7.4)

TRAINING_SHARE: Final = 0.6
"""Training share of the samples of overlapping people (thesis, section 7.4)."""
_DRAWS: Final = 2000
_RETESTED: Final[Mapping[str, float]] = {SHARE: (1.0 - TRAINING_SHARE) / TRAINING_SHARE}
"""Ratio of test to training samples, for columns whose repeats are splits of the same samples."""
_SURE: Final = float(norm.ppf(0.975))  # half width of a 95 % interval in standard deviations


@dataclass(frozen=True, slots=True)
class ResultDifference:
    """Difference between two values.

    Attributes:
        by: the difference of the means.
        low, high: its 95 % interval; NaN for a single repeat, or none.
        effect: its effect size, as text; empty if unknown.
    """

    by: float
    low: float = math.nan
    high: float = math.nan
    effect: str = ""

    @property
    def is_sure(self) -> bool:
        """Whether the interval is known."""
        return not math.isnan(self.low + self.high)


def margin(column: str, reference: float) -> float:
    """Return the difference up to which values of a column are called alike."""
    return POINTS if column in PERCENT else PART * abs(reference)


def mean_of(values: Floats | Jackknife) -> float:
    """Return the mean over repeats (R,), or the value of the single one."""
    return values.whole if isinstance(values, Jackknife) else float(values.mean())


def mean_and_spread(values: Values) -> tuple[float, float | None]:
    """Return mean and standard deviation, over repeats or images; the deviation is None for one repeat."""
    if isinstance(values, ImageErrors):
        return values.all.mean, values.all.deviation
    if isinstance(values, Jackknife) or values.size < 2:
        return mean_of(values), None
    return mean_of(values), float(values.std(ddof=1))


def paired(column: str, one: Floats | Jackknife, other: Floats | Jackknife) -> ResultDifference:
    """Compare values (R,) of the same repeats by Student's interval, or of a single repeat by sequences.

    Splits of one set of samples overlap; for them the interval is the wider one of Nadeau and Bengio,
    "Inference for the generalization error", Machine Learning 52, 2003.
    """
    means = mean_of(one), mean_of(other)
    if isinstance(one, Jackknife) and isinstance(other, Jackknife):
        parts = [one.by_sequence, other.by_sequence]
        # Equal sequences are compared pair by pair, others as two samples.
        apart = [parts[0] - parts[1]] if one.suites == other.suites else parts
        return _difference(column, *means, map(_variance_of_mean, apart))
    if isinstance(one, Jackknife) or isinstance(other, Jackknife) or one.size != other.size or one.size < 2:
        return _difference(column, *means)
    return _difference(column, *means, [_variance_of_mean(one - other, column)], (one, other))


def to_source(
    column: str, ours: Floats | Jackknife, source: float, deviation: float | None
) -> ResultDifference:
    """Compare values (R,) with a printed one, whose deviation, if printed, is that of ten repeats."""
    if isinstance(ours, Jackknife):
        return _difference(column, ours.whole, source, [_variance_of_mean(ours.by_sequence)])
    if ours.size < 2:
        return _difference(column, mean_of(ours), source)
    parts = [_variance_of_mean(ours, column)]
    if deviation is not None:
        theirs = deviation**2 * (1.0 / SOURCE_REPEATS + _RETESTED.get(column, 0.0))
        parts.append((theirs, SOURCE_REPEATS - 1))
    return _difference(column, mean_of(ours), source, parts, (ours,), deviation)


def _difference(
    column: str,
    one: float,
    other: float,
    variances: Iterable[tuple[float, int]] = (),
    samples: tuple[Floats, ...] = (),
    deviation: float | None = None,
) -> ResultDifference:
    """Return a difference of means with its effect size, and its interval if variances are known."""
    by, effect, parts = one - other, _effect(column, one, other, samples, deviation), list(variances)
    if not parts:
        return ResultDifference(by, effect=effect)
    half = _welch(parts)
    return ResultDifference(by, by - half, by + half, effect)


def by_stretches(one: ImageErrors, other: ImageErrors) -> ResultDifference:
    """Compare mean errors of images; the interval is over the blocks of time that both were tested on."""
    away = one.block_means - other.block_means
    away = away[np.isfinite(away)]
    by = one.all.mean - other.all.mean
    if away.size < 2:
        return ResultDifference(by)
    middle, half = float(away.mean()), _welch([_variance_of_mean(away)])
    return ResultDifference(by, middle - half, middle + half)


def bootstrap_interval(parts: Sequence[T], value: Callable[[Sequence[T]], float]) -> Interval:
    """Return the 95 % interval of a value of parts, such as seeds, by the percentile bootstrap.

    Resamples with the value NaN are omitted. The interval of a single part is NaN.

    Source: B. Efron, "Bootstrap methods: another look at the jackknife", Annals of Statistics 7, 1979.
    """
    if len(parts) < 2:
        return math.nan, math.nan
    found = bootstrap(
        (np.arange(len(parts)),),
        lambda drawn: value([parts[k] for k in drawn]),
        n_resamples=_DRAWS,
        vectorized=False,
        method="percentile",
        rng=stream(0, "depth_drives.interval"),
    )
    low, high = np.nanquantile(found.bootstrap_distribution, [0.025, 0.975]).tolist()
    return low, high


def cohens_h(one: float, other: float) -> float:
    """Return the effect size of two rates [%]: 0.2 is called small, 0.5 medium, 0.8 large.

    Source: Cohen, "Statistical power analysis for the behavioral sciences", 1988, section 6.2.
    """
    angles = [2.0 * math.asin(math.sqrt(min(max(rate / 100.0, 0.0), 1.0))) for rate in (one, other)]
    return angles[0] - angles[1]


def hedges_g(by: float, deviations: tuple[float, ...], count: int) -> float:
    """Return a difference in pooled deviations, corrected for few values; NaN without any deviation.

    It is also NaN for a single degree of freedom, for which the correction is 0.

    Source: Hedges, "Distribution theory for Glass's estimator of effect size", J. Educ. Stat. 6, 1981.
    """
    spread = math.sqrt(sum(one**2 for one in deviations) / len(deviations))
    freedom = len(deviations) * (count - 1)
    if spread == 0 or freedom < 2:
        return math.nan
    return by / spread * (1.0 - 3.0 / (4.0 * freedom - 1.0))


def _effect(
    column: str, one: float, other: float, samples: tuple[Floats, ...], deviation: float | None
) -> str:
    """Format the effect size: Cohen's h for rates, Hedges' g otherwise."""
    if math.isnan(one + other):
        return ""
    if column in PERCENT:
        return f"h = {cohens_h(one, other):+.2f}"
    spreads = [float(values.std(ddof=1)) for values in samples]
    known = tuple(spreads if deviation is None else [*spreads, deviation])
    g = hedges_g(one - other, known, samples[0].size) if known else math.nan
    return "" if math.isnan(g) else f"g = {g:+.2f}"


def _variance_of_mean(values: Floats, column: str = "") -> tuple[float, int]:
    """Return the variance of the mean of values (F,), and its degrees of freedom."""
    return float(values.var(ddof=1)) * (1.0 / values.size + _RETESTED.get(column, 0.0)), values.size - 1


def _welch(parts: Iterable[tuple[float, int]]) -> float:
    """Return half of the 95 % interval of a sum, from variances and their degrees of freedom.

    Source: Welch, "The generalization of Student's problem", Biometrika 34, 1947.
    """
    known = list(parts)
    total = sum(variance for variance, _ in known)
    if not total > 0:
        return total
    freedom = total**2 / sum(v**2 / df for v, df in known)
    return float(student.ppf(0.975, freedom)) * math.sqrt(total)


@dataclass(frozen=True, slots=True, kw_only=True)
class TTest:
    """A t-test.

    Attributes:
        t, p: its statistic, positive if the first has larger errors, and its two-sided p-value.
        count: number of values on each side.
        effect: Cohen's d or d_z.
        interval: 95 % confidence interval of the effect.
    """

    t: float
    p: float
    count: int
    effect: float
    interval: Interval


def paired_by_blocks(one: ImageErrors, other: ImageErrors) -> TTest | None:
    """Compare the mean errors of the same blocks of time; None with fewer than two of them.

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
    """Compare the errors of all splits of one run as if they were independent, which they are not.

    Means and deviations are those of all runs, the number of images is that of one run: the 2003 paper has
    one run, and only its ten splits combined give the significance that it reports. The effect is d.

    Source: OMNIVIS 2003, section 6, which names Student's test for unpaired samples.
    """
    first, second = one.all, other.all
    counts = [max(round(part.all.images / part.films), 2) for part in (one, other)]
    found = ttest_ind_from_stats(
        first.mean, first.deviation, counts[0], second.mean, second.deviation, counts[1]
    )
    effect, interval = cohens_d(first, second, min(counts))
    t, p = float(found.statistic), float(found.pvalue)
    return TTest(t=t, p=p, count=min(counts), effect=effect, interval=interval)


def cohens_d(one: ErrorSummary, other: ErrorSummary, count: int) -> tuple[float, Interval]:
    """Return a difference of means in pooled deviations, and its 95 % interval for equal sample sizes."""
    spread = math.sqrt((one.deviation**2 + other.deviation**2) / 2.0)
    if spread == 0.0:
        return math.nan, (math.nan, math.nan)
    d = (one.mean - other.mean) / spread
    half = _SURE * math.sqrt(2.0 / count + d**2 / (4.0 * count))
    return d, (d - half, d + half)


def spread_of_effect(d_z: float, count: int) -> float:
    """Return half the 95 % interval of an effect d_z, in the approximation for large samples."""
    return _SURE * math.sqrt(1.0 / count + d_z**2 / (2.0 * count))
