"""Train the distance network of the 2003 paper, which estimates a person's distance from silhouette cues."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Annotated, ClassVar, Final

import numpy as np
from numba import njit
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.frame_cache import film_key
from peopleboy.settings import POSITIONAL
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.sim.world_config import WorldConfig
from peopleboy.studies.training.samples import Arrays, SampleTask, Split, Tasks, sample_folder
from peopleboy.studies.training.specification import Specification
from peopleboy.tracker.frame import PANORAMA, Frame
from peopleboy.tracker.reproductions.panoramic.depth_cues import EMPTY_IMAGES, learn_background, measure
from peopleboy.tracker.reproductions.panoramic.distance_network import (
    CUES,
    HIGH,
    LOW,
    DistanceModel,
    DistanceNetwork,
    file_name,
    scaled,
    with_bias,
)
from peopleboy.tracker.reproductions.panoramic.paper_tracker import PanoramicConfig
from peopleboy.tracker.reproductions.panoramic.position_filter import STEP_S, estimate_noise
from peopleboy.tracker.sensors.panorama.panorama_view import PanoramaView, view_of

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DistanceSamples(Arrays):
    """The samples of one run, in order of time.

    Attributes:
        person: (N,) number of the person.
        time_s: (N,) time of the image [s].
        cues: (N, 3) silhouette cues in the order of `DepthCues` [px].
        bearing_rad: (N,) bearing of the silhouette, left positive [rad].
        true_m: (N, 2) true position of the person in the robot's frame [m]: the middle between the feet, and
            not the hat as in the paper.
        missed: (1,) number of images in which the person was not detected.
    """

    person: NDArray[np.int64]
    time_s: Floats
    cues: Floats
    bearing_rad: Floats
    true_m: Floats
    missed: NDArray[np.int64]

    @property
    def distance_m(self) -> Floats:
        """True distances (N,) from the robot's middle [m]."""
        return np.asarray(np.hypot(*self.true_m.T), np.float64)

    @property
    def angle_error_rad(self) -> Floats:
        """Absolute errors (N,) of the silhouette's bearing, in 0..pi [rad]."""
        off = self.bearing_rad - np.arctan2(self.true_m[:, 1], self.true_m[:, 0])
        return np.asarray(np.abs(np.angle(np.exp(1j * off))), np.float64)

    def positions_at(self, distance_m: Floats) -> Floats:
        """Return positions (N, 2) on the floor in the robot's frame [m], for estimated distances (N,) [m]."""
        way = np.stack([np.cos(self.bearing_rad), np.sin(self.bearing_rad)], axis=1)
        return np.asarray(distance_m[:, None] * way, np.float64)

    @classmethod
    def from_rows(cls, rows: Sequence[Sequence[float]], missed: int = 0) -> "DistanceSamples":
        """Build samples from rows of person, time, three cues, bearing, and true position x and y."""
        person, time_s, *cues, bearing_rad, x, y = np.array(rows, np.float64).reshape(-1, 8).T
        return cls(
            person=person.astype(np.int64),
            time_s=time_s,
            cues=np.stack(cues, axis=1),
            bearing_rad=bearing_rad,
            true_m=np.stack([x, y], axis=1),
            missed=np.array([missed]),
        )


def collect_distances(scenario: str, seed: int) -> DistanceSamples:
    """Run a scenario with the panoramic camera, and collect measurements of a single person.

    Raises:
        BadInput: an unknown scenario, a person in the first images, or a camera that cannot be calibrated or
            that does not see the floor where people walk.
    """
    loaded = load_scenario(scenario).mounting((PANORAMA,))
    config = loaded.world(seed)
    check_floor(config, scenario)
    return _measured(panoramas(config, loaded.duration_s), scenario)


def check_floor(config: WorldConfig, scenario: str) -> PanoramaView:
    """Return the calibration of the panoramic camera, without rendering.

    Raises:
        BadInput: it cannot be calibrated, or it does not see the floor where people walk.
    """
    camera, calibrations = config.robot.cameras[PANORAMA], calibrations_of(config.robot.cameras)
    if PANORAMA not in calibrations:
        raise BadInput(f"{scenario}: camera {PANORAMA!r} of kind {camera.kind!r} cannot be calibrated")
    ways = [point.at_m for person in config.people for point in person.path]
    if not ways:
        raise BadInput(f"{scenario}: no person walks in this scenario")
    away = np.subtract(ways, config.robot.at_m)
    farthest = np.array([[float(np.hypot(*away.T).max()), 0.0, 0.0]])
    row = float(calibrations[PANORAMA].project(farthest)[0, 1])
    if not row < camera.camera.height:  # also true for NaN, a point that the lens does not see
        raise BadInput(
            f"{scenario}: camera {PANORAMA!r} sees no floor where people walk; take another mirror"
        )
    return view_of(calibrations[PANORAMA], camera.camera.width, camera.camera.height)


def panoramas(config: WorldConfig, duration_s: float) -> Iterator[tuple[NDArray[np.uint8], ImageFreeTruth]]:
    """Yield every image (H, W, 3) of the panoramic camera, and the people present; render no other images."""
    from peopleboy.sim.world import (
        SimulatedWorld,  # imported late: reading existing samples does not need PyBullet
    )

    with SimulatedWorld(config) as world:
        for _ in range(round(duration_s * config.control_hz)):
            observation = world.observe()
            if PANORAMA in observation.images:
                frame = Frame(images=observation.images, time_s=observation.time_s)
                yield frame.rgb(PANORAMA), world.scene()
            world.step(0.0, 0.0)


def _measured(instants: Iterator[tuple[NDArray[np.uint8], ImageFreeTruth]], scenario: str) -> DistanceSamples:
    """Measure the single person in each image after the empty ones, and count missed detections."""
    first = list(islice(instants, EMPTY_IMAGES))
    if len(first) < EMPTY_IMAGES or any(scene.people for _, scene in first):
        raise BadInput(
            f"{scenario}: the first {EMPTY_IMAGES} panoramas must be empty: they are the background"
        )
    background = learn_background([image for image, _ in first])
    rows, missed = [], 0
    for image, scene in instants:
        figure = measure(background.silhouette(image), PanoramicConfig().least_px)
        if len(scene.people) == 1 and figure is not None:
            (person,) = scene.people
            place = scene.robot.to_local(person.position_m)
            rows.append([float(person.id), scene.time_s, *figure.cues, figure.bearing_rad, *place])
        missed += bool(scene.people) and figure is None
    return DistanceSamples.from_rows(rows, missed)


@dataclass(frozen=True, slots=True, kw_only=True)
class Backpropagation:
    """Settings of the paper's online backpropagation.

    Hidden units and learning rate are the paper's best ones. The paper does not give the number of epochs and
    the initial weights; those are chosen here.

    Attributes:
        hidden: units of the hidden layer.
        rate: learning rate of the online updates.
        epochs: number of passes through the samples, each in another order.
        first_weight: the initial weights are uniform between this and its negative.
    """

    hidden: int = 4
    rate: float = 0.3
    epochs: int = 2000
    first_weight: float = 0.5


def fit_distances(
    cues: Floats, distances_m: Floats, rng: np.random.Generator, settings: Backpropagation | None = None
) -> DistanceNetwork:
    """Train a network online by backpropagation of the squared error.

    Args:
        cues: (N, 3) silhouette cues [px].
        distances_m: (N,) true distances [m].
        rng: draws the initial weights and the order of the samples.
        settings: settings of the training.

    Raises:
        BadInput: too few samples, or all at one distance.

    Source: OMNIVIS 2003, section 4.4.
    """
    if len(cues) < 10:
        raise BadInput(f"{len(cues)} samples of distances: at least 10 are needed; use more sequences")
    if np.ptp(distances_m) <= 0.0 or np.any(np.ptp(cues, axis=0) <= 0.0):
        raise BadInput("samples of distances: all are equal, so there is nothing to train on")
    settings = Backpropagation() if settings is None else settings
    ranges = np.stack([cues.min(axis=0), cues.max(axis=0)], axis=1)
    nearest, farthest = float(distances_m.min()), float(distances_m.max())
    inputs = with_bias(scaled(cues, ranges))
    targets = LOW + (HIGH - LOW) * (distances_m - nearest) / (farthest - nearest)
    limit = settings.first_weight
    hidden = rng.uniform(-limit, limit, (settings.hidden, CUES + 1))
    output = rng.uniform(-limit, limit, settings.hidden + 1)
    for _ in range(settings.epochs):
        run_epoch(inputs, targets, rng.permutation(len(inputs)), hidden, output, settings.rate)
    return DistanceNetwork(
        hidden=hidden, output=output, cue_ranges=ranges, distance_range_m=(nearest, farthest)
    )


@njit(cache=True)
def run_epoch(
    inputs: Floats,
    targets: Floats,
    order: NDArray[np.int64],
    hidden: Floats,
    output: Floats,
    rate: float,
) -> None:
    """Run one epoch: go once through the samples, and update the weights in place after each.

    Each change is the negative gradient of half the squared error, times the rate.
    """
    units = np.empty(len(hidden))
    for sample in order:
        total = output[-1]
        for j in range(len(hidden)):
            units[j] = 1.0 / (1.0 + np.exp(-np.dot(hidden[j], inputs[sample])))
            total += output[j] * units[j]
        predicted = 1.0 / (1.0 + np.exp(-total))
        blame = (targets[sample] - predicted) * predicted * (1.0 - predicted)
        for j in range(len(hidden)):
            passed = blame * output[j] * units[j] * (1.0 - units[j])
            output[j] += rate * blame * units[j]
            hidden[j] += rate * passed * inputs[sample]
        output[-1] += rate * blame


def walks(run: DistanceSamples, measured: Floats) -> list[tuple[Floats, Floats]]:
    """Split a run where the person changes or an image is missing: true and measured positions (N, 2) [m]."""
    is_cut = (np.diff(run.person) != 0) | (np.diff(run.time_s) > 1.5 * STEP_S)
    cuts = np.flatnonzero(is_cut) + 1
    pieces = zip(np.split(run.true_m, cuts), np.split(measured, cuts), strict=True)
    return [(true, seen) for true, seen in pieces if len(true) > 2]


TRAINING_SHARE: Final = 0.3
"""Share of the samples used for training (OMNIVIS 2003, section 4.4)."""
_LEAST_SAMPLES: Final = 100  # least number of samples in a run
BLOCKS: Final = 20
"""Number of blocks of a sequence, for a split in which neighbouring images are not independent."""


def block_split(count: int, rng: np.random.Generator) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Split images by blocks of time, 30 to 70."""
    block = np.arange(count) * BLOCKS // count
    is_training = np.isin(block, rng.permutation(BLOCKS)[: round(TRAINING_SHARE * BLOCKS)])
    return np.flatnonzero(is_training), np.flatnonzero(~is_training)


@dataclass(frozen=True, slots=True, kw_only=True)
class DistanceTraining(Specification[list[DistanceSamples]]):
    """The tracker panoramic-paper uses this network.

    The training scenario must begin with five empty panoramas, and then show one person at a time.
    """

    HINT: ClassVar[str] = "`peopleboy reproduce --paper panoramic` evaluates it in the paper's experiments"

    sequences: Annotated[
        int,
        Field(
            ge=1, le=100_000, alias="seeds", description="Number of seeds; the scenario runs once per seed."
        ),
    ] = 10
    scenario: Annotated[str, POSITIONAL, Field(description="Scenario, by name or path.")] = "room_long"
    epochs: Annotated[int, Field(ge=1, le=1_000_000, description="Number of training epochs.")] = 2000

    def default_folder(self, model: str) -> Path:
        """Return a separate folder for each scenario."""
        return Path("runs") / f"{model}-{Path(self.scenario).stem}"

    def tasks(self, out: Path) -> Tasks:
        """Run the scenario; existing samples are reused unless the code or the scenario has changed."""
        scenario = load_scenario(self.scenario).mounting((PANORAMA,))
        check_floor(scenario.world(0), self.scenario)
        folder = sample_folder(out, Path(__file__))
        runs = ((seed, film_key(scenario, seed)[:12]) for seed in range(self.sequences))
        return Split(
            [
                SampleTask(folder / f"{seed}-{key}.npz", collect_distances, (self.scenario, seed))
                for seed, key in runs
            ],
            [],
        )

    def load(self, tasks: Tasks) -> list[DistanceSamples]:
        """Read the samples, run by run."""
        runs = [DistanceSamples.load(task.path) for task in tasks.training]
        for seed, run in enumerate(runs):
            if len(run) < _LEAST_SAMPLES:
                raise BadInput(
                    f"{self.scenario}, seed {seed}: {len(run)} panoramas show exactly one person; at least "
                    f"{_LEAST_SAMPLES} are needed"
                )
        return runs

    def fit(self, data: list[DistanceSamples]) -> Mapping[str, DistanceModel]:
        """Train the network on all samples."""
        settings, samples = Backpropagation(epochs=self.epochs), DistanceSamples.join(data)
        network = fit_distances(samples.cues, samples.distance_m, np.random.default_rng(0), settings)
        all_walks = [walk for run in data for walk in walks(run, run.positions_at(network.predict(run.cues)))]
        scenario = load_scenario(self.scenario).mounting((PANORAMA,))
        model = DistanceModel(
            network=network,
            view=check_floor(scenario.world(0), self.scenario),
            noise=estimate_noise(all_walks, uses_velocity=False),
            about={
                "trained on": f"{len(samples)} images of {scenario.name}, seeds 0 to {len(data) - 1}",
                "training": f"{settings.epochs} epochs, rate {settings.rate:g}, online",
                "excluded": f"{samples.missed.sum()} images in which the person was not detected",
            },
        )
        return {file_name(scenario.name): model}

    def evaluate(self, model: DistanceModel, data: list[DistanceSamples]) -> Mapping[str, str]:
        """Measure the training error, and the validation error of a split by blocks (30 % for training)."""
        settings, seen, unseen = Backpropagation(epochs=self.epochs), [], []
        for run in data:
            seen.append(model.network.predict(run.cues) - run.distance_m)
            rng = np.random.default_rng((0, 0))
            rows, rest = block_split(len(run), rng)
            network = fit_distances(run.cues[rows], run.distance_m[rows], rng, settings)
            unseen.append((network.predict(run.cues) - run.distance_m)[rest])
        return {"training error": _error(seen), "validation error, split by blocks": _error(unseen)}

    def is_replaced(self, path: Path, model: DistanceModel) -> bool:
        """Return whether a shipped file belongs to the same mirror."""
        return path.match(file_name("*")) and not DistanceModel.load(path).view.refusal(model.view)


def _error(parts: Sequence[Floats]) -> str:
    errors = np.abs(np.concatenate(parts))
    return f"{errors.mean():.3f} ± {errors.std():.3f} m"
