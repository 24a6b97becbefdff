"""What training of rescoring and of box refinement share: samples, augmentation of crops, the fit."""

from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, ClassVar, Final, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.studies.training.detector.augmentation import Version, versions
from peopleboy.studies.training.detector.boosting import in_threads
from peopleboy.studies.training.detector.world_sequences import load_images, render_task
from peopleboy.studies.training.detector.worlds import LATER, seeds_of
from peopleboy.studies.training.optimiser import Optimiser, Weights, he_weights, shuffled
from peopleboy.studies.training.samples import Arrays, SampleTask, Split, Tasks
from peopleboy.studies.training.specification import Specification, report
from peopleboy.tracker.boxes import Floats, iou
from peopleboy.tracker.detector.box_regression import OFFSETS, decode_boxes
from peopleboy.tracker.detector.crops import (
    FEATURES,
    Crops,
    Planes,
    crop_features,
    cut_crops,
    normalise_crops,
)
from peopleboy.tracker.detector.detections import Detections
from peopleboy.tracker.networks.inference import CHANNELS, Architecture, CropNetwork, CropSize

Array = jax.Array | Planes

BATCH: Final = 64
_RATE: Final = 1.5e-3
_WARM_UP: Final = 300  # batches
_DECAY: Final = 0.02  # of kernels, in a batch, of the rate
_REPORTED: Final = 200  # batches
_LAST: Final = 0.1  # first weights of the last layer, relative to He's
_HELD_BACK: Final = 10  # of so many worlds one is not trained on
_AT_ONCE: Final = 256  # crops


@jax.tree_util.register_dataclass
@dataclass(frozen=True, slots=True, eq=False)
class CropSamples(Arrays):
    """Crops of images, with the people that they show.

    Attributes:
        crops: (N, rows, columns, 3) uint8.
        features: (N, 9), see `crop_features`.
        overlap: (N,) IoU with a person that is visible, at most.
        offsets: (N, 4) of that person, see `encode_boxes`; 0 if there is none.
    """

    crops: Crops
    features: Planes
    overlap: NDArray[np.float32]
    offsets: Planes

    @classmethod
    def empty(cls, size: CropSize) -> "CropSamples":
        """Return no samples with crops of a size."""
        none = (size.rows, size.columns, CHANNELS), (FEATURES,), (), (OFFSETS,)
        kinds = (np.uint8, np.float32, np.float32, np.float32)
        return cls(*(np.empty((0, *shape), kind) for shape, kind in zip(none, kinds, strict=True)))

    @classmethod
    def cut(
        cls, version: Version, found: Detections, overlap: Floats, offsets: Floats, size: CropSize
    ) -> "CropSamples":
        """Cut detections out of an image."""
        image, mount, _ = version
        crops = cut_crops(image.grey, image.change, found.box, size)
        features = crop_features(found, crops, (image.grey.shape[0], image.grey.shape[1]), mount)
        return cls(crops, features, overlap.astype(np.float32), offsets.astype(np.float32))

    def mirror(self) -> "CropSamples":
        """Swap left and right."""
        features, offset = self.features.copy(), self.offsets.copy()
        features[:, 4:6] = self.features[:, [5, 4]]
        offset[:, 0] *= -1.0
        return CropSamples(self.crops[:, :, ::-1], features, self.overlap, offset)


CropLoss = Callable[[jax.Array, CropSamples], tuple[jax.Array, dict[str, jax.Array]]]
"""Of the outputs (N, outputs) of a network, and the samples: what is minimised, and results to report."""


class CropData(NamedTuple):
    """Tasks of sequences, and the samples of all."""

    tasks: Tasks
    samples: Split[CropSamples]


@dataclass(frozen=True, slots=True, kw_only=True)
class CropTraining(Specification[CropData]):
    """Base of the training of networks on crops, on worlds that the cascade was not trained on.

    The cascade would be surer in worlds that it knows. A tenth of the worlds is held back for validation.
    """

    NETWORK: ClassVar[type[CropNetwork]]
    EPOCHS: ClassVar[int]
    DROPOUT: ClassVar[float]
    VERSIONS: ClassVar[int]
    """Of each image to train on."""

    sequences: Annotated[
        int, Field(ge=5, le=2000, alias="seeds", description="Number of random worlds to train on.")
    ] = 600

    def default_folder(self, model: str) -> Path:  # noqa: ARG002
        """Return the folder that all models of the detector share."""
        return Path("runs/detector")

    @abstractmethod
    def sample(self, version: Version, *, augments: bool) -> CropSamples:
        """Collect the samples of an image; its random numbers draw how they are augmented."""

    @abstractmethod
    def check(self, others: CropSamples) -> None:
        """Refuse samples by which the network cannot be evaluated.

        Raises:
            BadInput: they cannot.
        """

    @abstractmethod
    def loss(self, outputs: jax.Array, batch: CropSamples) -> tuple[jax.Array, dict[str, jax.Array]]:
        """Return what is minimised for the outputs for a batch, and results to report."""

    def tasks(self, out: Path) -> Tasks:
        """Render worlds."""
        tasks = [render_task(out / "sequences", seed) for seed in later_seeds(self.sequences)]
        held = [task for task in tasks if seed_of(task) % _HELD_BACK == _HELD_BACK - 1] or tasks[-1:]
        return Split([task for task in tasks if task not in held], held)

    def load(self, tasks: Tasks) -> CropData:
        """Collect samples of the worlds."""
        samples = Split(self._samples(tasks.training, augments=True), self._samples(tasks.validation))
        report(
            f"{len(tasks.training)} sequences, {len(samples.training)} samples for training, "
            f"{len(samples.validation)} for validation"
        )
        self.check(samples.validation)
        return CropData(tasks, samples)

    def _samples(self, tasks: Iterable[SampleTask], *, augments: bool = False) -> CropSamples:
        parts = [CropSamples.empty(self.NETWORK.ARCHITECTURE.crop)]
        for task in tasks:
            images, rng = load_images([task.path]), np.random.default_rng(seed_of(task))
            drawn = versions(images, rng, self.VERSIONS if augments else 0)
            # Only augmented images have random numbers of their own.
            each = in_threads if augments else map
            parts += each(partial(self.sample, augments=augments), drawn)
        return CropSamples.join(parts)

    def fit(self, data: CropData) -> Mapping[str, CropNetwork]:
        """Train the network."""
        samples, architecture = data.samples.training, self.NETWORK.ARCHITECTURE
        weights = fit_crops(architecture, self.loss, samples, epochs=self.EPOCHS, dropout=self.DROPOUT)
        about = {"trained on": f"{len(data.tasks.training)} sequences, {len(samples)} samples"}
        return {f"{self.NETWORK.MODEL}.npz": self.NETWORK(weights, about)}


def later_seeds(worlds: int) -> list[int]:
    """Return the seeds of so many worlds that the cascade is not trained on."""
    return [seed + LATER for seed in seeds_of(worlds)]


def seed_of(task: SampleTask) -> int:
    """Return the seed of the world of a task."""
    return int(task.arguments[0])


def predictions(network: Any, samples: CropSamples) -> Floats:
    """Return what a network predicts (N, outputs) for samples."""
    parts = [
        network.predict(normalise_crops(samples.crops[k : k + _AT_ONCE]), samples.features[k : k + _AT_ONCE])
        for k in range(0, len(samples), _AT_ONCE)
    ]
    return np.concatenate([np.empty((0, network.ARCHITECTURE.outputs)), *parts])


def mean_overlaps(offsets: Floats, samples: CropSamples, rows: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the mean IoU of some samples as they were, and with predicted offsets (N, 4)."""
    window = np.tile([0.0, 0.0, 1.0, 1.0], (int(rows.sum()), 1))
    true = decode_boxes(window, samples.offsets[rows].astype(np.float64))
    overlap = iou(decode_boxes(window, offsets[rows]), true)
    return float(samples.overlap[rows].mean()), float(overlap.mean())


def first_weights(architecture: Architecture, rng: np.random.Generator) -> dict[str, Planes]:
    """Draw an untrained network."""
    weights: dict[str, Planes] = {}
    for name, shape in architecture.shapes().items():
        weights[name] = he_weights(rng, shape, shape[0]) if len(shape) > 1 else np.zeros(shape, np.float32)
    weights["last"] *= np.float32(_LAST)
    return weights


def fit_crops(
    architecture: Architecture, loss: CropLoss, samples: CropSamples, *, epochs: int, dropout: float
) -> dict[str, Planes]:
    """Train a network; half of the batches are mirrored.

    Args:
        architecture: of the network.
        loss: to minimise.
        samples: to train on.
        epochs: how often each is seen.
        dropout: share of units that are left out, others in each batch (Srivastava et al., JMLR 2014).

    Returns:
        The average of the weights of the last batches.

    Raises:
        BadInput: there are too few samples.
    """
    rng, count = np.random.default_rng(0), epochs * (len(samples) // BATCH)
    if not count:
        raise BadInput(f"{len(samples)} samples, at least {BATCH} are needed; take more sequences")

    def augmented_loss(
        weights: Weights, inputs: tuple[Planes, CropSamples], key: jax.Array
    ) -> tuple[jax.Array, dict[str, jax.Array]]:
        planes, batch = inputs
        for_crops, for_units = jax.random.split(key)
        shape = (len(planes), architecture.units)
        kept = (jax.random.uniform(for_units, shape) >= dropout) / (1.0 - dropout)
        varied = augment_crops(jnp.asarray(planes), for_crops)
        return loss(network_outputs(architecture, weights, varied, batch.features, kept), batch)

    optimiser = Optimiser(
        augmented_loss,
        first_weights(architecture, rng),
        seed=int(rng.integers(2**31)),
        decay=_DECAY,
        averages=True,
    )
    rate = optax.warmup_cosine_decay_schedule(0.0, _RATE, min(_WARM_UP, count // 2), count)
    left = ((batch, float(rate(number))) for number, batch in enumerate(_batches(samples, rng, epochs)))
    while some := list(islice(left, _REPORTED)):
        means = ", ".join(f"{name} {value:.3f}" for name, value in optimiser.run(some).items())
        report(f"{optimiser.steps} of {count} batches: {means}")
    return optimiser.weights


def _batches(
    samples: CropSamples, rng: np.random.Generator, epochs: int
) -> Iterator[tuple[Planes, CropSamples]]:
    for _ in range(epochs):
        for rows in shuffled(len(samples), BATCH, rng):
            batch = samples.take(np.sort(rows))
            batch = batch.mirror() if rng.random() < 0.5 else batch
            yield normalise_crops(batch.crops), batch


def network_outputs(
    architecture: Architecture, weights: Weights, planes: Array, features: Array, kept: Array | float = 1.0
) -> jax.Array:
    """Return the outputs (N, outputs) of the last layer, as `CropNetwork.outputs` does.

    Args:
        architecture: of the network.
        weights: of it.
        planes: (N, rows, columns, 3) crops.
        features: (N, 9) of the detections, of which it gets the last ones.
        kept: (N, units) by what units are multiplied, for dropout.
    """
    here = jnp.asarray(planes)
    for layer, (side, stride, depth) in enumerate(architecture.layers):
        edge = side // 2
        here = jax.lax.conv_general_dilated(
            here,
            weights[f"kernel{layer}"].reshape(side, side, -1, depth),
            (stride, stride),
            [(edge, edge), (edge, edge)],
            dimension_numbers=("NHWC", "HWIO", "NHWC"),
        )
        here = jax.nn.relu(here + weights[f"bias{layer}"])
    flat = jnp.concatenate([here.reshape(len(here), -1), features[:, -architecture.features :]], axis=1)
    units = kept * jax.nn.relu(flat @ weights["all"] + weights["all_bias"])
    return jnp.asarray(units @ weights["last"] + weights["last_bias"])


_STILL: Final = 0.15  # of crops, without motion
_MOTION: Final = 0.2  # deviation of the logarithm of the gain of motion
_NOISY: Final = 0.5  # of crops
_MOST_NOISE: Final = 0.25  # of deviations of the crop
_SLOPE: Final = 0.25  # deviation of greys that rise from one side to the other
_COVERED: Final = 0.2  # of crops, in part
_TALL: Final = (0.1, 0.5)  # shares of the crop that are covered
_WIDE: Final = (0.1, 0.6)


def augment_crops(planes: jax.Array, key: jax.Array) -> jax.Array:
    """Augment crops (N, rows, columns, 3) by motion, noise and slopes of greys; cover parts of some."""
    keys = iter(jax.random.split(key, 8))
    count, rows, columns, _ = planes.shape
    grey, change, inside = planes[..., :1], planes[..., 1:2], planes[..., 2:]

    def share(*more: int) -> jax.Array:
        return jax.random.uniform(next(keys), (count, *(more or (1,)), 1, 1))

    def deviates(*shape: int) -> jax.Array:
        return jax.random.normal(next(keys), (count, *shape))

    moving = jnp.where(share() < _STILL, 0.0, change * jnp.exp(_MOTION * deviates(1, 1, 1)))
    drawn = share(2)[..., None]
    noise = jnp.where(drawn[:, 0] < _NOISY, _MOST_NOISE * drawn[:, 1], 0.0) * deviates(rows, columns, 1)
    slope = _SLOPE * deviates(2, 1, 1, 1)
    down, right = jnp.linspace(-1.0, 1.0, rows)[:, None, None], jnp.linspace(-1.0, 1.0, columns)[:, None]
    other = grey + (noise + slope[:, 0] * down + slope[:, 1] * right) * inside
    is_covered = _cover(share(5)[..., None], rows, columns)
    other = jnp.where(is_covered, deviates(1, 1, 1) * inside, other)
    return jnp.concatenate([other, jnp.where(is_covered, 0.0, moving), inside], axis=3)


def _cover(drawn: jax.Array, rows: int, columns: int) -> jax.Array:
    """Tell which pixels (N, rows, columns, 1) are covered, by random numbers (N, 5, 1, 1, 1) from 0 to 1."""
    high, wide = (
        size * (least + (most - least) * drawn[:, k])
        for k, (size, (least, most)) in enumerate(((rows, _TALL), (columns, _WIDE)))
    )
    off_row = jnp.abs(jnp.arange(rows)[:, None, None] - rows * drawn[:, 2])
    off_column = jnp.abs(jnp.arange(columns)[:, None] - columns * drawn[:, 3])
    return (off_row < 0.5 * high) & (off_column < 0.5 * wide) & (drawn[:, 4] < _COVERED)
