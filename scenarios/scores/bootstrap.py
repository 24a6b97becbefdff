"""Estimate the confidence interval of a mean by the bootstrap."""

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
        return [None if math.isnan(value) else value for value in (self.mean, self.low, self.high)]


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
