"""People's ways through the room: cut into walks, filtered, and made as noisy as the paper's."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.distance_learning.distance_examples import Examples
from peopleboy.tracker.panoramic.paper.position_filter import PRINTED, STEP_S, PositionFilter

Floats = NDArray[np.float64]

PAPER_SQUARE_M2: Final = 0.154**2 + 0.094**2
"""Mean squared error of a position in the paper before it is filtered [m2] (section 6.2)."""


def walks(run: Examples, measured: Floats) -> list[tuple[Floats, Floats]]:
    """Cut a run where the person changes or an image is missing: true and measured positions (N, 2) [m]."""
    is_cut = (np.diff(run.person) != 0) | (np.diff(run.time_s) > 1.5 * STEP_S)
    cuts = np.flatnonzero(is_cut) + 1
    pieces = zip(np.split(run.true_m, cuts), np.split(measured, cuts), strict=True)
    return [(true, seen) for true, seen in pieces if len(true) > 2]


def filtered(run: Examples, measured: Floats, position_filter: PositionFilter) -> Floats:
    """Filter positions (N, 2) [m]; the filter starts anew with each person."""
    told = [position_filter.start(measured[0])]
    for k in range(1, len(measured)):
        if run.person[k] != run.person[k - 1]:
            told.append(position_filter.start(measured[k]))
        else:
            steps = float(run.time_s[k] - run.time_s[k - 1]) / STEP_S
            told.append(position_filter.update(told[-1], measured[k], steps))
    return np.array([estimate.position_m for estimate in told])


def as_noisy_as_printed(run: Examples, measured: Floats, rng: np.random.Generator) -> Floats:
    """Add white noise to positions (N, 2) [m] until their mean squared error is the paper's.

    The noise has the shape of the printed R, and as much of it as is missing; positions that are worse than
    the paper's stay as they are.
    """
    error = float(((measured - run.true_m) ** 2).sum(axis=1).mean())
    share = max(PAPER_SQUARE_M2 - error, 0.0) / float(np.trace(PRINTED.measurement_m2))
    noise = rng.multivariate_normal(np.zeros(2), share * PRINTED.measurement_m2, len(measured))
    return np.asarray(measured + noise, np.float64)
