"""The paper's experiments again: distance by a general and by personal models, position with the filter."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.scenarios.studies.distance_learning.distance_examples import Examples
from peopleboy.tracker.panoramic.paper.distance_network import Lessons, teach
from peopleboy.tracker.panoramic.paper.position_filter import PRINTED, STEP_S, PositionFilter, estimate_noise

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]

REPEATS = 10
TRAINING_SHARE = 0.3
"""How many splits, and how much of the examples is learned from (sections 4.4 and 6.1)."""

BLOCKS = 20
"""Into how many stretches of time a run is cut where neighbouring images must not be on both sides."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorSummary:
    """Absolute errors of one split: number, mean and standard deviation, in the errors' unit."""

    count: int
    mean: float
    deviation: float

    @classmethod
    def of(cls, errors: Floats) -> ErrorSummary:
        """Summarise errors (N,)."""
        return cls(count=len(errors), mean=float(errors.mean()), deviation=float(errors.std()))


def random_split(count: int, rng: np.random.Generator) -> tuple[Rows, Rows]:
    """Split so many images at random, 30 to 70, as the paper does; neighbours in time are much alike."""
    order = rng.permutation(count)
    cut = round(TRAINING_SHARE * count)
    return np.sort(order[:cut]), np.sort(order[cut:])


def block_split(count: int, rng: np.random.Generator) -> tuple[Rows, Rows]:
    """Split so many images by whole stretches of time, 30 to 70."""
    block = np.arange(count) * BLOCKS // count
    is_training = np.isin(block, rng.permutation(BLOCKS)[: round(TRAINING_SHARE * BLOCKS)])
    return np.flatnonzero(is_training), np.flatnonzero(~is_training)


SPLITS = {"random": random_split, "blocks": block_split}


def general_trials(run: Examples, split: str, lessons: Lessons, *, seed: int = 0) -> Iterator[ErrorSummary]:
    """Teach one network on 30 % of a run's images and test it on the rest, in as many splits as the paper.

    Source: OMNIVIS 2003, section 6.1.
    """
    for repeat in range(REPEATS):
        rng = np.random.default_rng((seed, repeat))
        training, rest = SPLITS[split](len(run.cues), rng)
        yield ErrorSummary.of(np.abs(_told(run, training, lessons, rng)[rest] - run.distance_m[rest]))


def personal_trials(
    run: Examples, split: str, lessons: Lessons, *, seed: int = 0
) -> dict[tuple[int, int], list[ErrorSummary]]:
    """Teach each person's own network, and test it on everybody, by person tested and person taught.

    Each person's images are split, and the same 70 % of them test all networks.

    Source: OMNIVIS 2003, section 6.1.
    """
    people = np.unique(run.person).tolist()
    found: dict[tuple[int, int], list[ErrorSummary]] = {}
    for repeat in range(REPEATS):
        rng = np.random.default_rng((seed, repeat))
        whose = {one: np.flatnonzero(run.person == one) for one in people}
        parts = {one: SPLITS[split](len(rows), rng) for one, rows in whose.items()}
        for taught in people:
            told = _told(run, whose[taught][parts[taught][0]], lessons, rng)
            for tested in people:
                rest = whose[tested][parts[tested][1]]
                errors = ErrorSummary.of(np.abs(told[rest] - run.distance_m[rest]))
                found.setdefault((tested, taught), []).append(errors)
    return found


FILTERS = {
    "appearance model": None,
    "Kalman filter, printed Q and R, u = 0": ("printed", False),
    "Kalman filter, printed Q and R, u = last step": ("printed", True),
    "Kalman filter, own Q and R, u = 0": ("own", False),
    "Kalman filter, own Q and R, u = last step": ("own", True),
}
"""Ways to tell a position: whose noise is believed, and whether the filter predicts by a velocity."""


def position_trials(
    run: Examples, split: str, lessons: Lessons, *, seed: int = 0
) -> dict[str, list[ErrorSummary]]:
    """Tell positions with and without the filter, which sees all images in their order; 70 % of them count.

    Own Q and R are those of the whole run, so that they are as good as they can be.

    Source: OMNIVIS 2003, section 6.2.
    """
    found: dict[str, list[ErrorSummary]] = {name: [] for name in FILTERS}
    for repeat in range(REPEATS):
        rng = np.random.default_rng((seed, repeat))
        training, rest = SPLITS[split](len(run.cues), rng)
        measured = run.seen_at(_told(run, training, lessons, rng))
        for name in FILTERS:
            errors = np.linalg.norm(_positions(run, measured, name) - run.true_m, axis=1)
            found[name].append(ErrorSummary.of(errors[rest]))
    return found


def walks(run: Examples, measured: Floats) -> list[tuple[Floats, Floats]]:
    """Cut a run where the person changes or an image is missing: true and measured positions (N, 2) [m]."""
    is_cut = (np.diff(run.person) != 0) | (np.diff(run.time_s) > 1.5 * STEP_S)
    cuts = np.flatnonzero(is_cut) + 1
    pieces = zip(np.split(run.true_m, cuts), np.split(measured, cuts), strict=True)
    return [(true, seen) for true, seen in pieces if len(true) > 2]


def correlations(runs: Sequence[Examples]) -> Floats:
    """Give the linear correlation (3,) of each cue with the true distance (figure 5)."""
    cues = np.concatenate([run.cues for run in runs])
    distances = np.concatenate([run.distance_m for run in runs])
    return np.array([np.corrcoef(cue, distances)[0, 1] for cue in cues.T])


def _told(run: Examples, training: Rows, lessons: Lessons, rng: np.random.Generator) -> Floats:
    """Teach a network on some images, and let it tell the distances (N,) in all."""
    return teach(run.cues[training], run.distance_m[training], rng, lessons).distance(run.cues)


def _positions(run: Examples, measured: Floats, name: str) -> Floats:
    way = FILTERS[name]
    if way is None:
        return measured
    whose, uses_velocity = way
    own = estimate_noise(walks(run, measured), uses_velocity=uses_velocity)
    return _filtered(run, measured, PositionFilter(PRINTED if whose == "printed" else own, uses_velocity))


def _filtered(run: Examples, measured: Floats, position_filter: PositionFilter) -> Floats:
    """Filter positions (N, 2); the filter starts anew with each person."""
    told = [position_filter.start(measured[0])]
    for k in range(1, len(measured)):
        if run.person[k] != run.person[k - 1]:
            told.append(position_filter.start(measured[k]))
        else:
            steps = float(run.time_s[k] - run.time_s[k - 1]) / STEP_S
            told.append(position_filter.update(told[-1], measured[k], steps))
    return np.array([estimate.position_m for estimate in told])
