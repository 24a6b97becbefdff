"""Common parts of training rescoring and box refinement: samples, augmentation of crops, and the fit."""

from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
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
from peopleboy.studies.training.detector.augmentation import Draw, augment, cut_off
from peopleboy.studies.training.detector.boosting import in_threads
from peopleboy.studies.training.detector.electronics import simulate_electronics
from peopleboy.studies.training.detector.world_sequences import ThermalImage, load_images, render_task
from peopleboy.studies.training.detector.worlds import LATER, seeds_of
from peopleboy.studies.training.optimiser import Optimiser, Weights, he_weights, shuffled
from peopleboy.studies.training.samples import Arrays, SampleTask, Split, Tasks
from peopleboy.studies.training.specification import Specification, report
from peopleboy.tracker.boxes import Floats, iou
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.networks.inference import CHANNELS, Architecture, CropNetwork, CropSize
from peopleboy.tracker.sensors.detections import Detections
from peopleboy.tracker.sensors.thermal.detector.box_regression import OFFSETS, decode_boxes
from peopleboy.tracker.sensors.thermal.detector.crops import (
    FEATURES,
    Crops,
    Planes,
    crop_features,
    cut_crops,
    normalise_crops,
)

Array = jax.Array | Planes

BATCH: Final = 64
_RATE: Final = 1.5e-3
_FINE_RATE: Final = 7e-4
_WARM_UP: Final = 300  # batches
_DECAY: Final = 0.02  # weight decay of kernels per batch, relative to the learning rate
_REPORTED: Final = 200  # batches between two progress lines
_LAST: Final = 0.1  # first weights of the last layer, relative to He's
_HELD_BACK: Final = 10  # one in so many worlds is held out
_AT_ONCE: Final = 256  # crops per prediction batch


_AS_RENDERED: Final = 0.25
_CUT: Final = 0.25
_MOUNT_KNOWN: Final = 0.6


class Version(NamedTuple):
    """An image to take crops of.

    Attributes:
        image: the image.
        mount: mount of the camera, if known.
        rng: random generator for further draws.
    """

    image: ThermalImage
    mount: Mount | None
    rng: Draw


def versions(images: Sequence[ThermalImage], rng: Draw, count: int) -> Iterator[Version]:
    """Yield `count` augmented versions of each image; for 0, the unchanged image with its mount."""
    for image in images:
        if count == 0:
            yield Version(image, image.mount, rng)
        for _ in range(count):
            own = np.random.default_rng(rng.integers(2**63))
            varied = image if own.random() < _AS_RENDERED else simulate_electronics(augment(image, own), own)
            shown = cut_off(varied, own) if own.random() < _CUT else varied
            yield Version(shown, shown.mount if own.random() < _MOUNT_KNOWN else None, own)


@jax.tree_util.register_dataclass
@dataclass(frozen=True, slots=True, eq=False)
class CropSamples(Arrays):
    """Crops of images, labelled with the people in them.

    Attributes:
        crops: (N, rows, columns, 3) uint8.
        features: (N, 9), see `crop_features`.
        overlap: (N,) largest IoU with a visible person.
        offsets: (N, 4) offsets to that person, see `encode_boxes`; 0 without a person. For networks that
            predict edges, (N, 6) with those of `encode_edges`; NaN where unknown.
    """

    crops: Crops
    features: Planes
    overlap: NDArray[np.float32]
    offsets: Planes

    @classmethod
    def empty(cls, size: CropSize, offsets: int) -> "CropSamples":
        """Return empty samples with crops of a given size and a number of offsets."""
        none = (size.rows, size.columns, CHANNELS), (FEATURES,), (), (offsets,)
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
        offset[:, OFFSETS:] = -offset[:, : OFFSETS - 1 : -1]
        return CropSamples(self.crops[:, :, ::-1], features, self.overlap, offset)


CropLoss = Callable[[jax.Array, CropSamples], tuple[jax.Array, dict[str, jax.Array]]]
"""Function of the outputs (N, outputs) and the samples that returns the loss, and results to report."""


class CropData(NamedTuple):
    """Tasks, one per sequence, and the samples of all of them."""

    tasks: Tasks
    samples: Split[CropSamples]


@dataclass(frozen=True, slots=True, kw_only=True)
class CropTraining(Specification[CropData]):
    """Base class for training networks on crops, in worlds on which the cascade was not trained.

    The cascade's scores are too high in its own training worlds. A tenth of the worlds is held out for
    validation.
    """

    NETWORK: ClassVar[type[CropNetwork]]
    DROPOUT: ClassVar[float]
    VERSIONS: ClassVar[int]
    """Number of augmented versions of each training image."""
    TARGETS: ClassVar[int] = OFFSETS
    """Number of offsets of each sample."""

    sequences: Annotated[
        int, Field(ge=5, le=2000, alias="seeds", description="Number of random worlds to train on.")
    ] = 600
    epochs: Annotated[int, Field(ge=1, description="Number of passes through the samples.")] = 4
    fine_tune: Annotated[bool, Field(description="Start from the shipped weights.")] = False

    def default_folder(self, model: str) -> Path:  # noqa: ARG002
        """Return the folder that all models of the detector share."""
        return Path("runs/detector")

    @abstractmethod
    def sample(self, version: Version, *, augments: bool) -> CropSamples:
        """Collect the samples of an image, augmented by its random generator."""

    @abstractmethod
    def check(self, others: CropSamples) -> None:
        """Check that the network can be evaluated on samples.

        Raises:
            BadInput: it cannot.
        """

    @abstractmethod
    def loss(self, outputs: jax.Array, batch: CropSamples) -> tuple[jax.Array, dict[str, jax.Array]]:
        """Return the loss of the outputs for a batch, and results to report."""

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
        parts = [CropSamples.empty(self.NETWORK.ARCHITECTURE.crop, self.TARGETS)]
        for task in tasks:
            images, rng = load_images([task.path]), np.random.default_rng(seed_of(task))
            drawn = versions(images, rng, self.VERSIONS if augments else 0)
            # Only augmented images have a random generator.
            each = in_threads if augments else map
            parts += each(partial(self.sample, augments=augments), drawn)
        return CropSamples.join(parts)

    def fit(self, data: CropData) -> Mapping[str, CropNetwork]:
        """Train the network."""
        samples, architecture = data.samples.training, self.NETWORK.ARCHITECTURE
        first = self.NETWORK.shipped().weights if self.fine_tune else None
        weights = fit_crops(
            architecture, self.loss, samples, epochs=self.epochs, dropout=self.DROPOUT, first=first
        )
        about = {"trained on": f"{len(data.tasks.training)} sequences, {len(samples)} samples"}
        if self.fine_tune:
            about["trained on"] += ", starting from the weights shipped before"
        return {f"{self.NETWORK.MODEL}.npz": self.NETWORK(weights, about)}


def later_seeds(worlds: int) -> list[int]:
    """Return the seeds of a number of worlds that are not used for training the cascade."""
    return [seed + LATER for seed in seeds_of(worlds)]


def seed_of(task: SampleTask) -> int:
    """Return the seed of the world of a task."""
    return int(task.arguments[0])


def predictions(network: Any, samples: CropSamples) -> Floats:
    """Return a network's outputs (N, outputs) for samples."""
    parts = [
        network.predict(normalise_crops(samples.crops[k : k + _AT_ONCE]), samples.features[k : k + _AT_ONCE])
        for k in range(0, len(samples), _AT_ONCE)
    ]
    return np.concatenate([np.empty((0, network.ARCHITECTURE.outputs)), *parts])


def mean_overlaps(offsets: Floats, samples: CropSamples, rows: NDArray[np.bool_]) -> tuple[float, float]:
    """Return the mean IoU of selected samples before and after applying predicted offsets (N, 4 or more)."""
    window = np.tile([0.0, 0.0, 1.0, 1.0], (int(rows.sum()), 1))
    true = decode_boxes(window, samples.offsets[rows, :OFFSETS].astype(np.float64))
    overlap = iou(decode_boxes(window, offsets[rows, :OFFSETS]), true)
    return float(samples.overlap[rows].mean()), float(overlap.mean())


def first_weights(architecture: Architecture, rng: np.random.Generator) -> dict[str, Planes]:
    """Initialise a network."""
    weights: dict[str, Planes] = {}
    for name, shape in architecture.shapes().items():
        weights[name] = he_weights(rng, shape, shape[0]) if len(shape) > 1 else np.zeros(shape, np.float32)
    weights["last"] *= np.float32(_LAST)
    return weights


def fit_crops(
    architecture: Architecture,
    loss: CropLoss,
    samples: CropSamples,
    *,
    epochs: int,
    dropout: float,
    first: Mapping[str, Planes] | None = None,
) -> dict[str, Planes]:
    """Train a network; half of the batches are mirrored.

    Args:
        architecture: architecture of the network.
        loss: loss to minimise.
        samples: training samples.
        epochs: number of passes through the samples.
        dropout: dropout rate (Srivastava et al., JMLR 2014).
        first: initial weights; random ones by default. From given weights, the learning rate is half as high.

    Returns:
        The average of the weights over the last batches.

    Raises:
        BadInput: there are too few samples.
    """
    rng, count, shapes = np.random.default_rng(0), epochs * (len(samples) // BATCH), architecture.shapes()
    if not count:
        raise BadInput(f"{len(samples)} samples, at least {BATCH} are needed; use more sequences")

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
        first_weights(architecture, rng) if first is None else {name: first[name] for name in shapes},
        seed=int(rng.integers(2**31)),
        decay=_DECAY,
        averages=True,
    )
    peak = _RATE if first is None else _FINE_RATE
    rate = optax.warmup_cosine_decay_schedule(0.0, peak, min(_WARM_UP, count // 2), count)
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
        architecture: architecture of the network.
        weights: its weights.
        planes: (N, rows, columns, 3) crops.
        features: (N, 9) features of the detections; the network uses the last ones.
        kept: (N, units) factors of the hidden units, for dropout.
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


_STILL: Final = 0.15  # share of crops without motion
_MOTION: Final = 0.2  # standard deviation of the logarithm of the motion's gain
_NOISY: Final = 0.5  # share of crops with noise
_MOST_NOISE: Final = 0.25  # largest noise, in standard deviations of the crop
_SLOPE: Final = 0.25  # standard deviation of the grey gradient across the crop
_COVERED: Final = 0.2  # share of crops that are covered in part
_TALL: Final = (0.1, 0.5)  # covered share of the crop
_WIDE: Final = (0.1, 0.6)


def augment_crops(planes: jax.Array, key: jax.Array) -> jax.Array:
    """Augment crops (N, rows, columns, 3) with motion, noise, grey gradients, and covered parts."""
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
    """Return which pixels (N, rows, columns, 1) are covered, from random numbers (N, 5, 1, 1, 1) in 0..1."""
    high, wide = (
        size * (least + (most - least) * drawn[:, k])
        for k, (size, (least, most)) in enumerate(((rows, _TALL), (columns, _WIDE)))
    )
    off_row = jnp.abs(jnp.arange(rows)[:, None, None] - rows * drawn[:, 2])
    off_column = jnp.abs(jnp.arange(columns)[:, None] - columns * drawn[:, 3])
    return (off_row < 0.5 * high) & (off_column < 0.5 * wide) & (drawn[:, 4] < _COVERED)
