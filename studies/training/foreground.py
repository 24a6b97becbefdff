"""Train the network that separates people from background in panoramas."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Final

import cv2
import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.geometry.camera_calibration import Calibration
from peopleboy.studies.training.optimiser import Optimiser, Weights, he_weights
from peopleboy.studies.training.panorama_sequences import (
    CAMERA_HELP,
    PanoramaSequence,
    render_task,
    scene_calibration,
    training_view,
)
from peopleboy.studies.training.random_scenes import FIRST_SEED
from peopleboy.studies.training.samples import Split, Tasks
from peopleboy.studies.training.specification import Specification, report
from peopleboy.tracker.networks.mask_network import BLOCK, DILATIONS, INPUTS, OUTPUTS, MaskNetwork
from peopleboy.tracker.sensors.panorama.panorama_view import PanoramaName
from peopleboy.tracker.sensors.panorama.people_foreground import FILES, Foreground, ForegroundModel

Linear = NDArray[np.float32]
Floats = NDArray[np.float64]
Sample = tuple[NDArray[np.float16], NDArray[np.bool_]]
"""The network's input (R, WIDE, INPUTS), and which pixels are people (R, WIDE, OUTPUTS)."""

UNITS: Final = 24
EVERY: Final = 4
"""Images of a sequence that are used for training; the network runs on all of them."""
WIDE: Final = 40
"""Width of a sample in columns of squares. Most of an image is background, so samples are excerpts."""
BATCH: Final = 8
RATES: Final = (4e-3, 1e-4)
"""Learning rate at the beginning and at the end; it decays by the same factor in each round."""
NEAREST_M: Final = 1.2
FARTHEST_M: Final = 6.0
"""Distances between which people are evaluated individually."""

_SEQUENCES_A_ROUND: Final = 100  # whose samples are in memory at a time
_RARE: Final = -3.0  # initial bias of the last layer, since few pixels are people
_LEAST_PX: Final = 12  # visible pixels from which on a person is evaluated
_REACH_PX: Final = 6  # margin around a person within which foreground counts as that person's


@dataclass(frozen=True, slots=True, kw_only=True)
class ForegroundTraining(Specification[Tasks]):
    """The training data are panoramas of random scenes.

    In each round, the current network runs on a hundred scenes. As in a tracker, the background model in its
    input therefore depends on its own output.
    """

    sequences: Annotated[
        int, Field(ge=1, le=100_000, alias="seeds", description="Number of random scenes to train on.")
    ] = 400
    validation: Annotated[int, Field(ge=0, description="Number of further scenes for validation.")] = 20
    rounds: Annotated[
        int, Field(ge=1, description="Number of training rounds, each on a hundred of the scenes.")
    ] = 12

    camera: Annotated[PanoramaName, Field(description=CAMERA_HELP)] = "mirror"

    def tasks(self, out: Path) -> Tasks:
        """Render the scenes. They do not all fit into memory, so each file is read when it is needed."""
        seeds = range(FIRST_SEED, FIRST_SEED + self.sequences), range(self.validation)
        folder = out / f"sequences-{self.camera}"
        return Split(*([render_task(folder, seed, self.camera) for seed in part] for part in seeds))

    def fit(self, data: Tasks) -> Mapping[str, ForegroundModel]:
        """Train in rounds, and print the loss of each."""
        scenes = [(task.path, scene_calibration(task)) for task in data.training]
        view, rng = training_view(self.camera), np.random.default_rng(0)
        optimiser = Optimiser(mask_loss, first_weights(view.height_px // BLOCK, rng))
        rates = np.geomspace(*RATES, self.rounds + 1).tolist()
        for number, (first, last) in enumerate(pairwise(rates), 1):
            chosen = [scenes[k] for k in rng.permutation(len(scenes))[:_SEQUENCES_A_ROUND]]
            model = ForegroundModel(network=MaskNetwork(**optimiser.weights), view=view)
            samples = [one for path, camera in chosen for one in collect_samples(path, camera, model, rng)]
            for ends in ((first, last), (last, last)):
                loss = optimiser.run(batches(samples, rng, ends))["entropy"]
            report(f"round {number} of {self.rounds}: {loss:.4f} nat per pixel")
        about = {
            "trained on": f"{len(scenes)} random scenes, seeds from {FIRST_SEED}",
            "training": f"{self.rounds} rounds, {optimiser.steps} steps",
        }
        network = MaskNetwork(**optimiser.weights)
        return {FILES[self.camera]: ForegroundModel(network=network, view=view, about=about)}

    def evaluate(self, model: ForegroundModel, data: Tasks) -> Mapping[str, str]:
        """Measure overlap and errors per person, for a standing and for a driving robot."""
        sums = {"a standing robot": MaskScores(), "a driving robot": MaskScores()}
        for task in data.validation:
            sequence = PanoramaSequence.load(task.path)
            robot = "a driving robot" if sequence.is_driven else "a standing robot"
            score_masks(sequence, segment(sequence, model, scene_calibration(task)), sums[robot])
        return {f"on other scenes, {robot}": str(scores) for robot, scores in sums.items() if scores.images}


def segment(sequence: PanoramaSequence, model: ForegroundModel, calibration: Calibration) -> Iterator[Linear]:
    """Yield the probability (H, W) that a pixel shows a person, for each image of a sequence."""
    foreground = Foreground(model)
    for k, image in enumerate(sequence.images):
        yield foreground.update(image, float(sequence.time_s[k]), sequence.odometry(k), calibration)


def collect_samples(
    path: Path, calibration: Calibration, model: ForegroundModel, rng: np.random.Generator
) -> Iterator[Sample]:
    """Run on an augmented sequence, and yield two excerpts of some images: at random, and around a person."""
    sequence = _augment(PanoramaSequence.load(path), rng)
    foreground, begin = Foreground(model), int(rng.integers(EVERY))
    for k, image in enumerate(sequence.images):
        foreground.update(image, float(sequence.time_s[k]), sequence.odometry(k), calibration)
        if k % EVERY != begin:
            continue
        squares, people = foreground.squares.transpose(1, 2, 0), _squares(sequence.person[k] > 0)
        yield _excerpt(squares, people, int(rng.integers(people.shape[1])))
        columns = np.flatnonzero(people.any(axis=(0, 2)))
        if len(columns) > 0:
            yield _excerpt(squares, people, int(rng.choice(columns)))


def batches(
    samples: Sequence[Sample], rng: np.random.Generator, rates: tuple[float, float]
) -> Iterator[tuple[tuple[Linear, Linear], float]]:
    """Yield all samples once, in batches, with a learning rate that changes from the first to the second."""
    order = rng.permutation(len(samples))
    for start in range(0, len(order), BATCH):
        batch = [samples[k] for k in order[start : start + BATCH]]
        squares, people = (np.stack(parts).astype(np.float32) for parts in zip(*batch, strict=True))
        yield (squares, people), rates[0] + start / len(order) * (rates[1] - rates[0])


def first_weights(rows: int, rng: np.random.Generator) -> Weights:
    """Initialise a network for images with a number of rows of squares."""
    layers = len(DILATIONS)
    return {
        "first": he_weights(rng, (INPUTS, UNITS), INPUTS),
        "rows": np.zeros((rows, UNITS), np.float32),
        "between": he_weights(rng, (layers, 9, UNITS, UNITS), 9 * UNITS) * np.float32(0.5),
        "biases": np.zeros((layers, UNITS), np.float32),
        "last": he_weights(rng, (UNITS + INPUTS, OUTPUTS), UNITS + INPUTS) * np.float32(0.1),
        "bias": np.full(OUTPUTS, _RARE, np.float32),
    }


def mask_loss(weights: Weights, batch: Any, key: jax.Array) -> tuple[jax.Array, dict[str, jax.Array]]:  # noqa: ARG001
    """Return the mean cross entropy [nat] of squares (N, R, C, INPUTS) and masks (N, R, C, OUTPUTS)."""
    squares, people = batch
    units = jax.nn.relu(squares @ weights["first"] + weights["rows"][:, None])
    for kernel, bias, dilation in zip(weights["between"], weights["biases"], DILATIONS, strict=True):
        # Columns wrap around; rows are padded with zeros.
        ring = jnp.pad(units, ((0, 0), (0, 0), (dilation, dilation), (0, 0)), mode="wrap")
        grown = jax.lax.conv_general_dilated(
            ring,
            kernel.reshape(3, 3, *kernel.shape[1:]),
            (1, 1),
            [(dilation, dilation), (0, 0)],
            rhs_dilation=(dilation, dilation),
            dimension_numbers=("NHWC", "HWIO", "NHWC"),
        )
        units += jax.nn.relu(grown + bias)
    evidence = jnp.concatenate([units, squares], axis=-1) @ weights["last"] + weights["bias"]
    entropy = (jnp.logaddexp(0.0, evidence) - people * evidence).mean()
    return entropy, {"entropy": entropy}


def _excerpt(squares: Linear, people: NDArray[np.bool_], middle: int) -> Sample:
    """Cut out the columns around a column, across the seam."""
    chosen = np.arange(middle - WIDE // 2, middle + WIDE // 2) % people.shape[1]
    return squares[:, chosen].astype(np.float16), people[:, chosen]


def _augment(sequence: PanoramaSequence, rng: np.random.Generator) -> PanoramaSequence:
    """Permute the colour channels, and mirror half of all sequences."""
    images = sequence.images[..., rng.permutation(3)]
    if rng.random() < 0.5:
        return replace(sequence, images=np.ascontiguousarray(images))
    return replace(
        sequence,
        images=np.ascontiguousarray(images[:, :, ::-1]),
        person=np.ascontiguousarray(sequence.person[:, :, ::-1]),
        motion=sequence.motion * (1.0, -1.0, -1.0),
        place_m=sequence.place_m * (1.0, -1.0),
    )


def _squares(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cut a mask (H, W) into squares (H / BLOCK, W / BLOCK, OUTPUTS), with the pixels in row order."""
    height, width = mask.shape
    pixels = mask.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK).transpose(0, 2, 1, 3)
    return pixels.reshape(height // BLOCK, width // BLOCK, OUTPUTS)


@dataclass(slots=True, kw_only=True)
class MaskScores:
    """Sums over images, and errors per person.

    Attributes:
        both, either: pixels in the intersection and in the union of true and predicted people.
        false_px: predicted pixels far from any person.
        images: number of images.
        foot_px: error of the lowest row per person, positive if too low [px].
        column_px: error of the mean column per person [px].
        found: per evaluated person, whether at least half of the silhouette was predicted.
    """

    both: int = 0
    either: int = 0
    false_px: int = 0
    images: int = 0
    foot_px: list[float] = field(default_factory=list)
    column_px: list[float] = field(default_factory=list)
    found: list[bool] = field(default_factory=list)

    def __str__(self) -> str:
        foot, column = _mean_size(self.foot_px), _mean_size(self.column_px)
        return (
            f"overlap {self.both / max(self.either, 1):.3f}, {_mean_size(self.found):.1%} of people found, "
            f"error of the lowest row {foot:.2f} px, of the middle column {column:.2f} px, "
            f"{self.false_px / max(self.images, 1):.1f} false pixels per image"
        )


def score_masks(sequence: PanoramaSequence, predicted: Iterable[Linear], sums: MaskScores) -> None:
    """Score the probabilities for each image of a sequence, and add them to the sums."""
    for k, probability in enumerate(predicted):
        _score_image(sums, sequence.person[k], probability > 0.5, np.hypot(*sequence.place_m[k].T))


def _score_image(
    sums: MaskScores, person: NDArray[np.uint8], mask: NDArray[np.bool_], away_m: Floats
) -> None:
    is_person = person > 0
    sums.images += 1
    sums.both += int((mask & is_person).sum())
    sums.either += int((mask | is_person).sum())
    sums.false_px += int((mask & ~_dilate(is_person)).sum())
    for k in np.flatnonzero((away_m >= NEAREST_M) & (away_m <= FARTHEST_M)).tolist():
        own = person == k + 1
        if own.sum() >= _LEAST_PX:
            _score_person(sums, own, mask & _dilate(own) & (own | ~is_person))


def _score_person(sums: MaskScores, own: NDArray[np.bool_], mask: NDArray[np.bool_]) -> None:
    sums.found.append(bool((mask & own).sum() >= 0.5 * own.sum()))
    if mask.any():
        sums.foot_px.append(float(_lowest(mask) - _lowest(own)))
        turn = np.angle(_mean_direction(mask) / _mean_direction(own))
        sums.column_px.append(float(turn / (2.0 * np.pi) * own.shape[1]))


def _mean_size(values: Sequence[float]) -> float:
    return float(np.abs(np.asarray(values, np.float64)).mean()) if values else math.nan


def _lowest(mask: NDArray[np.bool_]) -> int:
    """Return the lowest row with at least two pixels, or with one if no row has two."""
    counts = mask.sum(axis=1)
    return int(np.flatnonzero(counts >= min(2, counts.max()))[-1])


def _mean_direction(mask: NDArray[np.bool_]) -> complex:
    turns = np.arange(mask.shape[1]) / mask.shape[1]
    return complex(mask.sum(axis=0) @ np.exp(2j * np.pi * turns))


def _dilate(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Dilate a mask on all sides, across the seam."""
    ring = np.pad(mask.astype(np.uint8), ((0, 0), (_REACH_PX, _REACH_PX)), mode="wrap")
    size = 2 * _REACH_PX + 1
    return np.asarray(cv2.dilate(ring, np.ones((size, size), np.uint8))[:, _REACH_PX:-_REACH_PX], np.bool_)
