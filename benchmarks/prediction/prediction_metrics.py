"""Metrics of predicted places: average and final displacement error, miss rate, and calibration."""

from typing import Final, NamedTuple

import numpy as np

from peopleboy.tracker.prediction import Floats, Forecast

STEP_S: Final = 0.2
"""Time between two predicted positions [s]."""
HORIZONS_S: Final = (1.0, 2.0, 3.0, 5.0)
"""Horizons that are scored [s]."""
TIMES_S: Final[Floats] = np.asarray(STEP_S * np.arange(1, round(HORIZONS_S[-1] / STEP_S) + 1), np.float64)
"""Times of the places over which the average displacement error is taken [s]."""
MISS_M: Final = 2.0
"""A prediction whose final error is greater than this is a miss, at every horizon (Argoverse 1)."""
ELLIPSE_95: Final = 5.991
"""Squared Mahalanobis distance within which 95 % of places lie: chi square with 2 degrees of freedom."""


class PredictionScore(NamedTuple):
    """Metrics at one horizon.

    Attributes:
        predictions: number of predictions.
        ade_m: mean error over all times up to the horizon [m].
        fde_m: mean error at the horizon [m].
        miss: share of predictions with an error at the horizon greater than `MISS_M`.
        inside: share of true places in the ellipse of 95 %.
    """

    predictions: int
    ade_m: float
    fde_m: float
    miss: float
    inside: float


def squared_mahalanobis(forecast: Forecast, true_m: Floats) -> Floats:
    """Return the squared Mahalanobis distances (K, T) of true places (K, T, 2) [m]."""
    off = (true_m - forecast.mean_m)[..., None]
    return np.asarray((off.swapaxes(2, 3) @ np.linalg.solve(forecast.covariance_m2, off))[..., 0, 0])


def score_predictions(error_m: Floats, mahalanobis2: Floats) -> dict[float, PredictionScore]:
    """Score predictions by horizon [s]; those of people who leave before a horizon do not count at it.

    Args:
        error_m: (N, T) [m] errors at `TIMES_S`; NaN where the person is absent.
        mahalanobis2: (N, T) squared Mahalanobis distances of the true places.
    """
    return {horizon_s: _score(error_m, mahalanobis2, horizon_s) for horizon_s in HORIZONS_S}


def _score(error_m: Floats, mahalanobis2: Floats, horizon_s: float) -> PredictionScore:
    last = round(horizon_s / STEP_S)
    is_known = np.isfinite(error_m[:, :last].sum(axis=1))
    if not is_known.any():
        return PredictionScore(0, np.nan, np.nan, np.nan, np.nan)
    errors, final = error_m[is_known, :last], error_m[is_known, last - 1]
    return PredictionScore(
        predictions=len(final),
        ade_m=float(errors.mean()),
        fde_m=float(final.mean()),
        miss=float((final > MISS_M).mean()),
        inside=float((mahalanobis2[is_known, last - 1] <= ELLIPSE_95).mean()),
    )
