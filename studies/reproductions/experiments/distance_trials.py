"""Repeat the paper's experiments: distance by general and personal models, position with the filter."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.reproductions.image_errors import ImageErrors
from peopleboy.studies.training.distance import (
    TRAINING_SHARE,
    Backpropagation,
    DistanceSamples,
    block_split,
    fit_distances,
    walks,
)
from peopleboy.tracker.reproductions.panoramic.position_filter import (
    PRINTED,
    STEP_S,
    PositionFilter,
    estimate_noise,
)

Floats = NDArray[np.float64]
Rows = NDArray[np.int64]
Tested = list[tuple[Rows, Floats]]

PAPER_SQUARE_M2: Final = 0.154**2 + 0.094**2
"""Mean squared error of a position in the paper before it is filtered [m2] (section 6.2)."""


def random_split(count: int, rng: np.random.Generator) -> tuple[Rows, Rows]:
    """Split images at random, 30 to 70, as in the paper; neighbours in time are correlated."""
    order = rng.permutation(count)
    cut = round(TRAINING_SHARE * count)
    return np.sort(order[:cut]), np.sort(order[cut:])


SPLITS = {"random": random_split, "blocks": block_split}


@dataclass(frozen=True, slots=True, kw_only=True)
class SplitTrial:
    """How the images of a clip are split into training and test images.

    Attributes:
        split: one of `SPLITS`.
        repeats: number of splits; the paper has 10 (section 6.1).
        settings: training settings of the networks.
    """

    split: str
    repeats: int = 10
    settings: Backpropagation = field(default_factory=Backpropagation)

    def parts(self, count: int, repeat: int) -> tuple[Rows, Rows, np.random.Generator]:
        """Return training images, test images, and the random generator for the training."""
        rng = np.random.default_rng((0, repeat))
        return *SPLITS[self.split](count, rng), rng


def general_networks(run: DistanceSamples, trial: SplitTrial) -> list[tuple[Rows, Floats]]:
    """Train one network for all people in each split.

    Returns:
        For each split, the test images (N,), and the distances [m] that the network estimates in all images
        of the clip.
    """
    found = []
    for repeat in range(trial.repeats):
        training, rest, rng = trial.parts(len(run.cues), repeat)
        found.append((rest, _predict(run, training, trial.settings, rng)))
    return found


def general_trials(run: DistanceSamples, taught: Sequence[tuple[Rows, Floats]]) -> ImageErrors:
    """Test the networks of `general_networks` on the images that they were not trained on.

    Source: OMNIVIS 2003, section 6.1.
    """
    tested = [(rest, np.abs(predicted[rest] - run.distance_m[rest])) for rest, predicted in taught]
    return ImageErrors.of(tested, len(run.cues))


def personal_trials(run: DistanceSamples, trial: SplitTrial) -> dict[tuple[int, int], ImageErrors]:
    """Train a network for each person, and test it on all people; results by tested and training person.

    Each person's images are split, and the same 70 % of them test all networks.

    Source: OMNIVIS 2003, section 6.1.
    """
    people = np.unique(run.person).tolist()
    tested: dict[tuple[int, int], Tested] = {(one, other): [] for one in people for other in people}
    for repeat in range(trial.repeats):
        whose = {one: np.flatnonzero(run.person == one) for one in people}
        rng = np.random.default_rng((0, repeat))
        parts = {one: SPLITS[trial.split](len(rows), rng) for one, rows in whose.items()}
        for taught in people:
            predicted = _predict(run, whose[taught][parts[taught][0]], trial.settings, rng)
            for one in people:
                rest = whose[one][parts[one][1]]
                tested[one, taught].append((rest, np.abs(predicted[rest] - run.distance_m[rest])))
    return {pair: ImageErrors.of(parts, len(run.cues)) for pair, parts in tested.items()}


MODEL_ALONE, KALMAN = "appearance model", "with Kalman filter"
FILTERS = {
    MODEL_ALONE: None,
    KALMAN: ("printed", True),
    "printed Q and R, u = 0": ("printed", False),
    "own Q and R, u = last step": ("own", True),
    "own Q and R, u = 0": ("own", False),
}
"""Position estimators: the noise covariances of the filter, and whether it predicts with a velocity.

In the paper "the estimated velocity" predicts: `KALMAN` uses the printed Q and R, and the last step.
"""


def position_trials(
    run: DistanceSamples, taught: Sequence[tuple[Rows, Floats]], *, is_noisy: bool = False
) -> dict[str, ImageErrors]:
    """Return position errors with and without the filter, which runs on all images; 70 % of them count.

    Own Q and R are those of the whole clip, so that they are as good as possible.

    Args:
        run: samples of the clip.
        taught: networks, from `general_networks`.
        is_noisy: whether measurements are made as noisy as the paper's (`as_noisy_as_printed`).

    Source: OMNIVIS 2003, section 6.2.
    """
    tested: dict[str, Tested] = {name: [] for name in FILTERS}
    for repeat, (rest, predicted) in enumerate(taught):
        measured = run.positions_at(predicted)
        if is_noisy:
            measured = as_noisy_as_printed(run, measured, np.random.default_rng((1, repeat)))
        for name, parts in tested.items():
            errors = np.linalg.norm(_positions(run, measured, name) - run.true_m, axis=1)
            parts.append((rest, errors[rest]))
    return {name: ImageErrors.of(parts, len(run.cues)) for name, parts in tested.items()}


def new_people_trials(
    taught: Sequence[DistanceSamples], tested: Sequence[DistanceSamples], settings: Backpropagation
) -> list[ImageErrors]:
    """Train one network on whole clips, and test it on clips with other people."""
    cues, distances = (np.concatenate(parts) for parts in zip(*map(_samples, taught), strict=True))
    network = fit_distances(cues, distances, np.random.default_rng(0), settings)
    return [
        ImageErrors.of(
            [(np.arange(len(run.cues)), np.abs(network.predict(run.cues) - run.distance_m))], len(run.cues)
        )
        for run in tested
    ]


def correlations(run: DistanceSamples, taught: Sequence[tuple[Rows, Floats]]) -> Floats:
    """Return the linear correlation (4,) with the true distance: of each cue, and of a network's estimate.

    The first network is tested on images that it was not trained on, the cues on all.

    Source: OMNIVIS 2003, figure 5.
    """
    rest, predicted = taught[0]
    cues = [np.corrcoef(cue, run.distance_m)[0, 1] for cue in run.cues.T]
    return np.array([*cues, np.corrcoef(predicted[rest], run.distance_m[rest])[0, 1]])


def predicted_in_turn(run: DistanceSamples, trial: SplitTrial) -> Floats:
    """Return the distances (N,) [m] of all images of a clip, each by a network not trained on it."""
    predicted, repeat = np.full(len(run.cues), np.nan), 0
    while np.isnan(predicted).any():
        training, rest, rng = trial.parts(len(run.cues), repeat)
        unpredicted = rest[np.isnan(predicted[rest])]
        predicted[unpredicted] = _predict(run, training, trial.settings, rng)[unpredicted]
        repeat += 1
    return predicted


def _samples(run: DistanceSamples) -> tuple[Floats, Floats]:
    return run.cues, run.distance_m


def _predict(
    run: DistanceSamples, training: Rows, settings: Backpropagation, rng: np.random.Generator
) -> Floats:
    """Train a network on some images, and return its distances (N,) [m] in all images."""
    return fit_distances(run.cues[training], run.distance_m[training], rng, settings).predict(run.cues)


def _positions(run: DistanceSamples, measured: Floats, name: str) -> Floats:
    way = FILTERS[name]
    if way is None:
        return measured
    whose, uses_velocity = way
    own = estimate_noise(walks(run, measured), uses_velocity=uses_velocity)
    return filtered(run, measured, PositionFilter(PRINTED if whose == "printed" else own, uses_velocity))


def filtered(run: DistanceSamples, measured: Floats, position_filter: PositionFilter) -> Floats:
    """Return filtered positions (N, 2) [m]; the filter is reset for each person."""
    predicted = [position_filter.start(measured[0])]
    for k in range(1, len(measured)):
        if run.person[k] != run.person[k - 1]:
            predicted.append(position_filter.start(measured[k]))
        else:
            steps = float(run.time_s[k] - run.time_s[k - 1]) / STEP_S
            predicted.append(position_filter.update(predicted[-1], measured[k], steps))
    return np.array([estimate.position_m for estimate in predicted])


def as_noisy_as_printed(run: DistanceSamples, measured: Floats, rng: np.random.Generator) -> Floats:
    """Add white noise to positions (N, 2) [m] until their mean squared error is the paper's.

    The noise has the shape of the printed R, scaled to the missing error; positions that are worse than the
    paper's are unchanged.
    """
    error = float(((measured - run.true_m) ** 2).sum(axis=1).mean())
    share = max(PAPER_SQUARE_M2 - error, 0.0) / float(np.trace(PRINTED.measurement_m2))
    noise = rng.multivariate_normal(np.zeros(2), share * PRINTED.measurement_m2, len(measured))
    return np.asarray(measured + noise, np.float64)
