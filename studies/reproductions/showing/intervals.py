"""How large a difference is, and how sure: 95 % intervals, effect sizes, and margins to hold them against."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from peopleboy.studies.reproductions.experiments.experiment import FilmFigure
from peopleboy.studies.reproductions.experiments.learning import SHARE
from peopleboy.studies.reproductions.experiments.tracking import PAPER, THESIS
from peopleboy.studies.training.distance_learning.image_errors import ImageErrors
from peopleboy.studies.training.occlusion_learning.example_splits import TRAINING_SHARE

Floats = NDArray[np.float64]

PERCENT: Final = (*THESIS, *PAPER, SHARE)
"""Columns of rates, in percent."""
POINTS: Final = 2.0  # by which two rates may differ that are called alike
PART: Final = 0.1  # of the second figure, by which all others may
SOURCE_REPEATS: Final = 10  # over which the sources' deviations are (thesis, sections 4.4 and 7.4)

_RETESTED: Mapping[str, float] = {SHARE: (1.0 - TRAINING_SHARE) / TRAINING_SHARE}
"""Of columns whose repeats are splits of the same examples: those tested with, per one learned from."""


@dataclass(frozen=True, slots=True)
class Gap:
    """One figure less another.

    Attributes:
        by: the difference of the means.
        low, high: its 95 % interval; NaN where there is a single repeat, or none.
        effect: its size without a unit, in words; empty where that is unknown.
    """

    by: float
    low: float = math.nan
    high: float = math.nan
    effect: str = ""

    @property
    def is_sure(self) -> bool:
        """Whether there is an interval at all."""
        return not math.isnan(self.low + self.high)


def margin(column: str, reference: float) -> float:
    """Give the difference up to which figures of a column are called alike."""
    return POINTS if column in PERCENT else PART * abs(reference)


def paired(column: str, one: Floats | FilmFigure, other: Floats | FilmFigure) -> Gap:
    """Compare figures (R,) of the same repeats by Student's interval, or those of a single one by films.

    Splits of one set of examples share most of it; the interval is that of Nadeau and Bengio, "Inference for
    the generalization error", Machine Learning 52, 2003, which is wider for that.
    """
    if isinstance(one, FilmFigure) and isinstance(other, FilmFigure):
        return _by_films(column, one, other)
    means = mean_of(one), mean_of(other)
    by = means[0] - means[1]
    if isinstance(one, FilmFigure) or isinstance(other, FilmFigure) or one.size != other.size or one.size < 2:
        return Gap(by, effect=_effect(column, *means, ()))
    away = one - other
    spread = float(away.std(ddof=1)) * math.sqrt(1.0 / away.size + _RETESTED.get(column, 0.0))
    half = _reach(away.size - 1) * spread
    return Gap(by, by - half, by + half, _effect(column, *means, (one, other)))


def _by_films(column: str, one: FilmFigure, other: FilmFigure) -> Gap:
    """Compare figures of a single repeat: film by film if both are of the same, else by Welch's interval."""
    values, others = one.by_film, other.by_film
    apart = [values - others] if one.films == other.films else [values, others]
    by, half = one.whole - other.whole, _welch(_over_films(part) for part in apart)
    return Gap(by, by - half, by + half, _effect(column, one.whole, other.whole, ()))


def to_source(column: str, ours: Floats | FilmFigure, source: float, deviation: float | None) -> Gap:
    """Compare figures (R,) with a printed one; its deviation, if there is one, is that of ten repeats."""
    mean = mean_of(ours)
    by = mean - source
    if isinstance(ours, FilmFigure):
        half = _welch([_over_films(ours.by_film)])
        return Gap(by, by - half, by + half, _effect(column, mean, source, ()))
    count = ours.size
    if count < 2:
        return Gap(by, effect=_effect(column, mean, source, ()))
    parts = [(float(ours.var(ddof=1)) * (1.0 / count + _RETESTED.get(column, 0.0)), count - 1)]
    if deviation is not None:
        theirs = deviation**2 * (1.0 / SOURCE_REPEATS + _RETESTED.get(column, 0.0))
        parts.append((theirs, SOURCE_REPEATS - 1))
    half = _welch(parts)
    return Gap(by, by - half, by + half, _effect(column, mean, source, (ours,), deviation))


def mean_of(figures: Floats | FilmFigure) -> float:
    """Give what is shown of figures: the mean over repeats (R,), or that of the single one."""
    return figures.whole if isinstance(figures, FilmFigure) else float(figures.mean())


def by_stretches(one: ImageErrors, other: ImageErrors) -> Gap:
    """Compare mean errors of images; the interval is over the stretches of time that both were tested on."""
    away = one.block_means - other.block_means
    away = away[np.isfinite(away)]
    by = one.all.mean - other.all.mean
    if away.size < 2:
        return Gap(by)
    half = _reach(away.size - 1) * float(away.std(ddof=1)) / math.sqrt(away.size)
    middle = float(away.mean())
    return Gap(by, middle - half, middle + half)


def cohens_h(one: float, other: float) -> float:
    """Give the effect size of two rates [%]: 0.2 is called small, 0.5 medium, 0.8 large.

    Source: Cohen, "Statistical power analysis for the behavioral sciences", 1988, section 6.2.
    """
    angles = [2.0 * math.asin(math.sqrt(min(max(rate / 100.0, 0.0), 1.0))) for rate in (one, other)]
    return angles[0] - angles[1]


def hedges_g(by: float, deviations: tuple[float, ...], count: int) -> float:
    """Give a difference in pooled deviations, corrected for few values; NaN without any deviation.

    So it is with a single degree of freedom, for which the correction is nought.

    Source: Hedges, "Distribution theory for Glass's estimator of effect size", J. Educ. Stat. 6, 1981.
    """
    spread = math.sqrt(sum(one**2 for one in deviations) / len(deviations))
    freedom = len(deviations) * (count - 1)
    if spread == 0 or freedom < 2:
        return math.nan
    return by / spread * (1.0 - 3.0 / (4.0 * freedom - 1.0))


def _effect(
    column: str, one: float, other: float, samples: tuple[Floats, ...], deviation: float | None = None
) -> str:
    """Write Cohen's h of rates, and Hedges' g of all else."""
    if math.isnan(one + other):
        return ""
    if column in PERCENT:
        return f"h = {cohens_h(one, other):+.2f}"
    spreads = [float(values.std(ddof=1)) for values in samples]
    known = tuple(spreads if deviation is None else [*spreads, deviation])
    g = hedges_g(one - other, known, samples[0].size) if known else math.nan
    return "" if math.isnan(g) else f"g = {g:+.2f}"


def _over_films(values: Floats) -> tuple[float, int]:
    """Give the variance of the mean of values (F,), and its degrees of freedom."""
    return float(values.var(ddof=1)) / values.size, values.size - 1


def _welch(parts: Iterable[tuple[float, int]]) -> float:
    """Give half of the 95 % interval of a sum, from variances and their degrees of freedom.

    Source: Welch, "The generalization of Student's problem", Biometrika 34, 1947.
    """
    known = list(parts)
    total = sum(variance for variance, _ in known)
    if not total > 0:
        return total
    return _reach(total**2 / sum(v**2 / df for v, df in known)) * math.sqrt(total)


def _reach(freedom: float) -> float:
    """Give the deviations that hold 95 % with so many degrees of freedom."""
    return float(student.ppf(0.975, freedom))
