"""Statistics of metrics over runs: bootstrap intervals of means, and a paired test."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RESAMPLES = 2000
LEVEL = 0.95


@dataclass(frozen=True, slots=True)
class Interval:
    """A mean and its 95 % confidence interval.

    All values are NaN without measurements; the bounds are NaN for a single measurement.
    """

    mean: float
    low: float
    high: float

    @property
    def is_known(self) -> bool:
        """Whether the interval has bounds."""
        return not math.isnan(self.low)

    def to_json(self) -> list[float | None]:
        """Return mean and bounds, None for undefined ones."""
        return [none_for_nan(value) for value in (self.mean, self.low, self.high)]


@dataclass(frozen=True, slots=True)
class PairedDifference:
    """Difference of a metric between two trackers, over runs of the same scenes.

    Attributes:
        interval: mean difference and its interval.
        p: p-value of the two-sided test that the differences are symmetric about 0; NaN for fewer than two.
    """

    interval: Interval
    p: float


def none_for_nan(value: float) -> float | None:
    """Return a value for JSON, which has no NaN."""
    return None if math.isnan(value) else value


def compare_pairs(differences: Sequence[float]) -> PairedDifference:
    """Return mean, interval and p-value of paired differences; NaN is ignored.

    The same differences give the same interval, whatever else is compared.

    Source: F. Wilcoxon, Individual comparisons by ranking methods, Biometrics Bulletin 1, 1945.
    """
    return PairedDifference(bootstrap(differences, np.random.default_rng(0)), _wilcoxon(differences))


def _wilcoxon(differences: Sequence[float]) -> float:
    known = [value for value in differences if not math.isnan(value)]
    if len(known) < 2:
        return math.nan
    if not any(known):  # no rank to sum, and no difference
        return 1.0
    from scipy import stats  # here, as SciPy's statistics load slowly

    return float(stats.wilcoxon(known).pvalue)


def bootstrap(values: Sequence[float], rng: np.random.Generator) -> Interval:
    """Return the mean of some values and its percentile interval; NaN is ignored.

    Source: B. Efron, Bootstrap methods: another look at the jackknife, Annals of Statistics 7, 1979.
    """
    known = np.array([value for value in values if not math.isnan(value)])
    if known.size == 0:
        return Interval(math.nan, math.nan, math.nan)
    if known.size == 1:
        return Interval(float(known[0]), math.nan, math.nan)
    from scipy import stats  # here, as SciPy's statistics load slowly

    found = stats.bootstrap(
        (known,), np.mean, n_resamples=RESAMPLES, confidence_level=LEVEL, method="percentile", rng=rng
    )
    return Interval(float(known.mean()), *map(float, found.confidence_interval))
