"""Train the networks on patches of panoramas: presence of a person, position, and its uncertainty."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Final, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.run_folder.atomic_output import writing_to
from peopleboy.studies.training.optimiser import Optimiser, Weights, shuffled
from peopleboy.studies.training.panorama_sequences import (
    CAMERA_HELP,
    PanoramaSequence,
    panorama_calibration,
    render_panoramas,
    render_task,
    scenario_path,
    training_view,
)
from peopleboy.studies.training.random_scenes import FIRST_SEED
from peopleboy.studies.training.samples import Arrays, SampleTask, Split, Tasks, load_samples, sample_folder
from peopleboy.studies.training.specification import Specification
from peopleboy.tracker.networks.inference import DenseNetwork
from peopleboy.tracker.networks.weights_archive import SHIPPED
from peopleboy.tracker.sensors.panorama.figure_patch import PATCH, Map
from peopleboy.tracker.sensors.panorama.panorama_patches import PanoramaScene, promising_places
from peopleboy.tracker.sensors.panorama.panorama_view import PanoramaName, PanoramaView
from peopleboy.tracker.sensors.panorama.people_foreground import FILES as FOREGROUNDS
from peopleboy.tracker.sensors.panorama.people_foreground import Foreground, shipped_foreground
from peopleboy.tracker.sensors.panorama.place_model import FILES, PlaceModel, with_distance

Floats = NDArray[np.float64]

LIBRARY: Final = {"room_long": 12, "panoramic_crossing": 10, "panoramic_moving": 14}
"""Scenarios of the library that are used for training, too, with the number of seeds of each."""
VALIDATION: Final = 20
"""Number of scenes of the validation split, which have the first seeds."""

IMAGES: Final = 300
"""Largest number of sampled images per sequence, at most half of them; the tracker runs on all images."""

NEAREST_M: Final = 0.8
FARTHEST_M: Final = 8.0
LEAST_PX: Final = 10
BLIND_SHARE: Final = 0.7
"""People who are nearer, farther, smaller, or occluded more are neither positives nor negatives."""

NEAR_M: Final = 0.42
APART_M: Final = 0.6
"""Places nearer than the first to a person are positives; farther than the second from all, negatives."""

_SPREADS: Final = ((0.05, 0.03), (0.18, 0.1), (0.18, 0.1))
"""Standard deviations of places sampled around a person, along and across the line of sight."""

_WARM_UP_S: Final = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class PlaceSamples(Arrays):
    """N samples.

    Attributes:
        patches: (N, PATCH) patches of the panorama.
        distance_m: (N,) distance of the evaluated place.
        offset_m: (N, 2) position of the person relative to it, away from the camera and to the left; NaN for
            a negative.
    """

    patches: NDArray[np.float16]
    distance_m: Floats
    offset_m: Floats

    @property
    def inputs(self) -> Map:
        """Inputs (N, INPUTS) of the networks."""
        return with_distance(self.patches.astype(np.float32), self.distance_m)

    @property
    def is_person(self) -> NDArray[np.bool_]:
        """Labels (N,): whether a person is present."""
        return ~np.isnan(self.offset_m[:, 0])


_NONE: Final = PlaceSamples(np.zeros((0, PATCH), np.float16), np.zeros(0), np.zeros((0, 2)))


class _Standing(NamedTuple):
    """A person in an image: number, place (2,) and its polar form, and number of visible pixels."""

    number: int
    place_m: tuple[float, float]
    pixels: int

    @property
    def distance_m(self) -> float:
        return math.hypot(*self.place_m)

    @property
    def bearing_rad(self) -> float:
        return math.atan2(self.place_m[1], self.place_m[0])


def sample_places(
    sequence: PanoramaSequence, calibration: PanoramaCalibration, seed: int, camera: PanoramaName = "mirror"
) -> PlaceSamples:
    """Run the tracker's foreground segmentation on a sequence, and collect patches at and beside people."""
    rng, foreground = np.random.default_rng((seed, 2003)), Foreground(shipped_foreground(camera))
    parts = [_NONE]
    every = max(2, math.ceil(len(sequence.images) / IMAGES))
    for k, image in enumerate(sequence.images):
        mask = foreground.update(image, float(sequence.time_s[k]), sequence.odometry(k), calibration)
        if k % every == seed % every and sequence.time_s[k] >= _WARM_UP_S:
            people = _people(sequence, k)
            scene = PanoramaScene.of(image, mask, foreground.novelty, calibration)
            parts.extend(_sample_image(scene, people, rng))
    return PlaceSamples.join(parts)


def _people(sequence: PanoramaSequence, k: int) -> list[_Standing]:
    """Return the people in an image, the nearest first."""
    pixels = np.bincount(sequence.person[k].ravel(), minlength=len(sequence.place_m[k]) + 1)
    found = [
        _Standing(number + 1, (x, y), int(pixels[number + 1]))
        for number, (x, y) in enumerate(sequence.place_m[k].tolist())
        if not math.isnan(x)
    ]
    return sorted(found, key=lambda one: one.distance_m)


def _sample_image(
    scene: PanoramaScene, people: Sequence[_Standing], rng: np.random.Generator
) -> Iterator[PlaceSamples]:
    """Search an image like the tracker: nearest people first, masking those found, then new people."""
    yield _sample(scene, promising_places(scene.figures, 3), people)
    for one in people:
        yield _sample(scene, _beside(one, rng), people)
        if not _is_visible(one, scene):
            continue
        yield _sample(scene, _around(one, rng), people)
        if rng.random() < 0.9:
            scene.cover(
                one.bearing_rad + rng.normal(0.0, 0.03) / one.distance_m,
                one.distance_m + rng.normal(0.0, 0.05),
            )
    yield _sample(scene, promising_places(scene.figures, 3), people)


def _sample(scene: PanoramaScene, polar: Floats, people: Sequence[_Standing]) -> PlaceSamples:
    """Label places (N, 2), bearing and distance; ambiguous places are left out."""
    places = polar[:, 1:] * np.stack([np.cos(polar[:, 0]), np.sin(polar[:, 0])], axis=1)
    offset, is_sure = np.full((len(polar), 2), np.nan), np.ones(len(polar), np.bool_)
    for one in people:
        away = np.hypot(*(places - one.place_m).T)
        is_near = away < NEAR_M
        if _is_visible(one, scene):
            offset[is_near] = _offsets(polar[is_near], one)
            is_sure &= is_near | (away > APART_M)
        else:
            is_sure &= away > APART_M
    patches = scene.figures.patches(polar[is_sure, 0], polar[is_sure, 1])
    return PlaceSamples(patches.astype(np.float16), polar[is_sure, 1], offset[is_sure])


def _is_visible(one: _Standing, scene: PanoramaScene) -> bool:
    is_in_reach = NEAREST_M < one.distance_m < FARTHEST_M and one.pixels >= LEAST_PX
    return is_in_reach and scene.hidden_share(one.bearing_rad, one.distance_m) < BLIND_SHARE


def _offsets(polar: Floats, one: _Standing) -> Floats:
    turn = np.remainder(one.bearing_rad - polar[:, 0] + math.pi, math.tau) - math.pi
    return np.stack([one.distance_m - polar[:, 1], turn * polar[:, 1]], axis=1)


def _around(one: _Standing, rng: np.random.Generator) -> Floats:
    """Draw places (N, 2), bearing and distance, at which a tracker may predict a person."""
    off = rng.normal(0.0, 1.0, (len(_SPREADS), 2)) * _SPREADS
    off = np.clip(off, -0.3, 0.3)
    distance = np.maximum(one.distance_m + off[:, 0], 0.6)
    return np.stack([one.bearing_rad + off[:, 1] / distance, distance], axis=1)


def _beside(one: _Standing, rng: np.random.Generator) -> Floats:
    """Draw places beside, in front of and behind a person, and one random place."""
    side, depth = rng.choice([-1.0, 1.0], 2)
    beside = one.bearing_rad + side * rng.uniform(0.55, 1.2) / one.distance_m, one.distance_m
    behind = one.bearing_rad + rng.normal(0.0, 0.05), one.distance_m + depth * rng.uniform(0.65, 2.5)
    anywhere = rng.uniform(-math.pi, math.pi), rng.uniform(1.0, FARTHEST_M)
    places = np.array([beside, behind, anywhere])
    return places[places[:, 1] > NEAREST_M]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacesTraining(Specification[Split[PlaceSamples]]):
    """The tracker panoramic uses these networks.

    The training data are random scenes, processed by the shipped foreground network. Run `peopleboy train
    foreground --ship` first.
    """

    sequences: Annotated[
        int, Field(ge=2, le=100_000, alias="seeds", description="Number of random scenes to train on.")
    ] = 400
    rendered: Annotated[Path, Field(description="Folder with the rendered scenes of `train foreground`.")] = (
        Path("runs/foreground")
    )
    camera: Annotated[PanoramaName, Field(description=CAMERA_HELP)] = "mirror"

    def tasks(self, out: Path) -> Tasks:
        """Render scenes and collect samples; these depend on the foreground network."""
        rendered = self.rendered / f"sequences-{self.camera}"
        with writing_to(rendered, "--rendered"):
            rendered.mkdir(parents=True, exist_ok=True)
        folder = sample_folder(out, Path(__file__), SHIPPED / FOREGROUNDS[self.camera])

        def task(seed: int, scenario: str = "") -> SampleTask:
            path = folder / f"{scenario or 'scene'}_{seed}.npz"
            return SampleTask(path, collect_places, (scenario, seed, rendered, self.camera))

        training = [task(FIRST_SEED + k) for k in range(self.sequences)]
        if self.camera == "mirror":
            training += [task(FIRST_SEED + k, name) for name, count in LIBRARY.items() for k in range(count)]
        return Split(training, [task(seed) for seed in range(VALIDATION)])

    def load(self, tasks: Tasks) -> Split[PlaceSamples]:
        """Read the samples."""
        return Split(*(load_samples(PlaceSamples, part) for part in tasks))

    def fit(self, data: Split[PlaceSamples]) -> Mapping[str, PlaceModel]:
        """Train the three networks."""
        samples, people = data.training, int(data.training.is_person.sum())
        scenes = f"{self.sequences} random scenes"
        if self.camera == "mirror":
            scenes += f", and {', '.join(LIBRARY)}"
        about = {
            "trained on": f"{people} patches with people and {len(samples) - people} without, from {scenes}, "
            f"seeds from {FIRST_SEED}"
        }
        return {FILES[self.camera]: replace(fit_places(samples, training_view(self.camera)), about=about)}

    def evaluate(self, model: PlaceModel, data: Split[PlaceSamples]) -> Mapping[str, str]:
        """Evaluate offsets, their predicted deviations, and presence."""
        samples = data.validation
        found = model.look(samples.patches.astype(np.float32), samples.distance_m)
        is_person, is_found = samples.is_person, found.evidence > 0
        along, across = np.abs(found.offset_m - samples.offset_m)[is_person].mean(axis=0)
        squared = ((found.offset_m - samples.offset_m) / found.deviation_m)[is_person] ** 2
        return {
            "on other scenes": f"error {along:.3f} m in distance and {across:.3f} m across, squared error "
            f"over predicted variance {squared.mean():.2f}; people found {is_found[is_person].mean():.1%}, "
            f"false positives {is_found[~is_person].mean():.1%}"
        }


def collect_places(scenario: str, seed: int, rendered: Path, camera: PanoramaName) -> PlaceSamples:
    """Sample a scenario of the library, or a random scene, which is rendered unless its file exists."""
    if scenario:
        loaded = load_scenario(scenario)
        sequence = render_panoramas(loaded, seed)
    else:
        task = render_task(rendered, seed, camera)
        if not task.path.is_file():
            task(lambda _: None)
        sequence, loaded = PanoramaSequence.load(task.path), load_scenario(scenario_path(rendered, seed))
    return sample_places(sequence, panorama_calibration(loaded, seed), seed, camera)


class DenseRecipe(NamedTuple):
    """Hyperparameters for training a dense network.

    Attributes:
        units: units of the hidden layers.
        epochs: epochs at full learning rate, followed by a quarter as many at a tenth of it.
        rate: learning rate.
        shrinkage: weight of the squared weights in the loss over all samples.
    """

    units: tuple[int, ...]
    epochs: int
    rate: float
    shrinkage: float


PLACE: Final = DenseRecipe((96, 32), 24, 2e-3, 1e-2)
PRESENCE: Final = DenseRecipe((24,), 10, 1e-3, 1e-3)
DOUBT: Final = DenseRecipe((24,), 8, 2e-3, 1e-2)
_BATCH: Final = 200
_LEAST_ERROR_M: Final = 1e-3
_LOG_OF_NORMAL: Final = 0.6352
"""Minus the mean of log |e| for a standard normal e."""


def fit_places(samples: PlaceSamples, view: PanoramaView, *, seed: int = 0) -> PlaceModel:
    """Train the networks for position, uncertainty and presence.

    The uncertainty is trained by cross-validation: each half of the samples is predicted by a network that
    was trained on the other half.

    Args:
        samples: samples in the order of collection, so that the halves contain different scenes.
        view: view of the camera of the samples.
        seed: seed of the initial weights and the order of samples.
    """
    inputs, is_person = samples.inputs, samples.is_person
    people, offset = inputs[is_person], samples.offset_m[is_person]
    half, errors = len(people) // 2, np.empty_like(offset)
    for own, other in ((slice(half), slice(half, None)), (slice(half, None), slice(half))):
        network = fit_dense(PLACE, squares, people[other], offset[other], seed)
        errors[own] = network.predict(people[own]) - offset[own]
    logarithms = np.log(np.abs(errors) + _LEAST_ERROR_M) + _LOG_OF_NORMAL
    return PlaceModel(
        presence=fit_dense(PRESENCE, cross_entropy, inputs, is_person[:, None], seed),
        place=fit_dense(PLACE, squares, people, offset, seed),
        doubt=fit_dense(DOUBT, squares, people, logarithms, seed),
        view=view,
    )


def fit_dense(
    recipe: DenseRecipe,
    error: Callable[[jax.Array, jax.Array], jax.Array],
    inputs: Map,
    targets: NDArray[Any],
    seed: int,
) -> DenseNetwork:
    """Train a dense network to minimise an error of outputs and targets (N, outputs), summed over outputs."""
    rng, targets = np.random.default_rng(seed), targets.astype(np.float32)
    widths, size = (inputs.shape[1], *recipe.units, targets.shape[1]), min(_BATCH, len(inputs))
    optimiser = Optimiser(
        partial(_dense_loss, len(widths) - 1, error, recipe.shrinkage), _glorot(widths, rng)
    )
    for epoch in range(recipe.epochs + max(recipe.epochs // 4, 1)):
        rate = recipe.rate if epoch < recipe.epochs else recipe.rate / 10.0
        optimiser.run(((inputs[rows], targets[rows]), rate) for rows in shuffled(len(inputs), size, rng))
    weights = optimiser.weights
    return DenseNetwork([(weights[f"weights{k}"], weights[f"bias{k}"]) for k in range(len(widths) - 1)])


def _glorot(widths: Sequence[int], rng: np.random.Generator) -> Weights:
    """Draw initial weights (Glorot and Bengio, AISTATS 2010)."""
    weights: Weights = {}
    for k, (before, after) in enumerate(pairwise(widths)):
        limit = math.sqrt(6.0 / (before + after))
        weights[f"weights{k}"] = rng.uniform(-limit, limit, (before, after)).astype(np.float32)
        weights[f"bias{k}"] = rng.uniform(-limit, limit, after).astype(np.float32)
    return weights


def _dense_loss(
    layers: int,
    error: Callable[[jax.Array, jax.Array], jax.Array],
    shrinkage: float,
    weights: Weights,
    batch: Any,
    key: jax.Array,  # noqa: ARG001
) -> tuple[jax.Array, dict[str, jax.Array]]:
    units, targets = batch
    for k in range(layers - 1):
        units = jax.nn.relu(units @ weights[f"weights{k}"] + weights[f"bias{k}"])
    outputs = units @ weights[f"weights{layers - 1}"] + weights[f"bias{layers - 1}"]
    norm = sum((weights[f"weights{k}"] ** 2).sum() for k in range(layers))
    return error(outputs, targets).sum(axis=1).mean() + 0.5 * shrinkage * norm / len(targets), {}


def squares(outputs: jax.Array, targets: jax.Array) -> jax.Array:
    """Return half the squared errors."""
    return 0.5 * (outputs - targets) ** 2


def cross_entropy(outputs: jax.Array, targets: jax.Array) -> jax.Array:
    """Return the cross entropy of log-odds and labels."""
    return jnp.logaddexp(0.0, outputs) - targets * outputs
