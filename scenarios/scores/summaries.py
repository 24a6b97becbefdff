"""Summaries of metrics over the runs of a tracker."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import stdev

import numpy as np

from peopleboy.scenarios.scores.bootstrap import Interval, bootstrap
from peopleboy.tracker.evaluation.evaluate import Scores, combine
from peopleboy.tracker.evaluation.table import FIGURES, Figure


@dataclass(frozen=True, slots=True)
class Summary:
    """One metric over several runs.

    Attributes:
        figure: the metric.
        whole: value over the frames of all runs together; NaN if undefined.
        interval: mean over the runs in which the metric is defined, with its 95 % bootstrap interval.
        sd: sample standard deviation over these runs; NaN for fewer than two.
        runs: number of these runs.
    """

    figure: Figure
    whole: float
    interval: Interval
    sd: float
    runs: int

    @property
    def mean(self) -> float:
        """Mean over the runs in which the metric is defined; NaN if there is none."""
        return self.interval.mean


def summarise(runs: Sequence[Scores], figures: Sequence[Figure] = FIGURES) -> list[Summary]:
    """Summarise metrics over runs. The same values give the same interval, whatever else is summarised.

    Raises:
        BadInput: there is no run.
    """
    whole = combine(runs)
    return [_summary(figure, figure.of(whole), [figure.of(scores) for scores in runs]) for figure in figures]


def _summary(figure: Figure, whole: float, values: Sequence[float]) -> Summary:
    known = [value for value in values if not math.isnan(value)]
    sd = stdev(known) if len(known) > 1 else math.nan
    return Summary(figure, whole, bootstrap(known, np.random.default_rng(0)), sd, len(known))
