"""Train the networks that detect people by their legs in laser scans."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.geometry.camera_calibration import ScanCalibration
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.random_worlds.random_world import random_world
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.truth.truth import Truth
from peopleboy.studies.training.places import DenseRecipe, cross_entropy, fit_dense, squares
from peopleboy.studies.training.random_scenes import FIRST_SEED, random_scene
from peopleboy.studies.training.samples import Arrays, SampleTask, Split, Tasks, sample_folder
from peopleboy.studies.training.specification import Specification
from peopleboy.tracker.evaluation.floor import FloorFrame, average_precision
from peopleboy.tracker.frame import LASER
from peopleboy.tracker.sensors.laser.beam_votes import group_votes
from peopleboy.tracker.sensors.laser.leg_model import FILE, LegModel
from peopleboy.tracker.sensors.laser.scan_windows import FARTHEST_M, cut_windows

Floats = NDArray[np.float64]

VALIDATION: Final = 10
"""Number of scenes, and of worlds, of the validation split."""
RADIUS_M: Final = 0.5
"""Distance within which a detection is of a person."""
LEAST_BEAMS: Final = 2
"""People who are hit by fewer beams are neither found nor missed."""

FIRST_WORLD: Final = 20_000
"""First seed of the random worlds of the training; the validation split has seeds from 10 000."""
_FIRST_OTHER_WORLD: Final = 10_000

_SCENE, _WORLD = "scene", "world"
_RATE_HZ: Final = 5  # of scans: more of them would hardly differ
_STEPS_DEG: Final = (0.25, 0.5, 0.5, 1.0)
_HEIGHTS_M: Final = (0.2, 0.45)
_NOISE_M: Final = (0.003, 0.03)
_NEGATIVES: Final = 5  # beams without a person, for each beam on a person

BEAM: Final = DenseRecipe((96, 32), 8, 2e-3, 1e-2)
OFFSET: Final = DenseRecipe((64, 32), 12, 2e-3, 1e-2)
PERSON: Final = DenseRecipe((16,), 40, 2e-3, 1e-3)


@dataclass(frozen=True, slots=True, eq=False)
class Scans(Arrays):
    """The N scans of one run by a range finder with B beams, with ground truth.

    Attributes:
        ranges: (N, B) from left to right [mm], 0 for no reading.
        person: (N, B) number of the person at each beam, 0 for none.
        place_m: (N, P, 2) positions of people 1, 2, ... in the robot's frame [m]; NaN while they are absent.
        step_rad: (1,) angle between beams.
        mount: (4,) position in the robot's frame [m], and yaw [rad].
    """

    ranges: NDArray[np.uint16]
    person: NDArray[np.uint8]
    place_m: Floats
    step_rad: Floats
    mount: Floats

    @property
    def calibration(self) -> ScanCalibration:
        """Calibration of the range finder."""
        x, y, z, yaw_rad = self.mount.tolist()
        return ScanCalibration(
            beams=self.ranges.shape[1],
            step_rad=float(self.step_rad[0]),
            position_m=(x, y, z),
            yaw_rad=yaw_rad,
        )

    def people(self, k: int) -> tuple[Floats, NDArray[np.bool_]]:
        """Return the positions (P, 2) of those who are hit by a beam of scan k, and who of them counts."""
        is_read = self.ranges[k] > 0
        beams = np.bincount(self.person[k][is_read], minlength=len(self.place_m[k]) + 1)[1:]
        return self.place_m[k][beams > 0], beams[beams > 0] >= LEAST_BEAMS


def scan_random(kind: str, seed: int) -> Scans:
    """Draw the random scene or world of a seed, with a range finder of random settings, and scan it."""
    scene = random_scene(seed, LASER) if kind == _SCENE else random_world(seed)
    rng, cameras = np.random.default_rng((seed, 2009)), scene["robot"].setdefault("cameras", {})
    cameras[LASER] = {
        "kind": LASER,
        "rate_hz": _RATE_HZ,
        "step_deg": float(rng.choice(_STEPS_DEG)),
        "mount_m": [0.22, 0.0, round(float(rng.uniform(*_HEIGHTS_M)), 3)],
        "noise_m": round(float(rng.uniform(*_NOISE_M)), 4),
    }
    return scan_scenario(parse_scenario(scene, source=scene["name"], folder=Path()), seed)


def scan_scenario(scenario: Scenario, seed: int) -> Scans:
    """Scan a scenario; no images are rendered.

    Raises:
        BadInput: the robot needs images to drive.
    """
    scenario = scenario.mounting((LASER,))
    ranges, people, places = [], [], []
    for world, observation in blind_drive(scenario, seed):
        if LASER in observation.images:
            truth = world.truth(LASER)
            ranges.append(np.array(observation.images[LASER][0]))
            people.append(np.array(truth.instance[0]))
            places.append(_places(truth, len(world.config.people)))
            calibration = observation.calibrations[LASER]
    assert isinstance(calibration, ScanCalibration)
    return Scans(
        np.array(ranges), np.array(people), np.array(places), np.array([calibration.step_rad]),
        np.array([*calibration.position_m, calibration.yaw_rad]),
    )  # fmt: skip


def _places(truth: Truth, people: int) -> Floats:
    places = np.full((people, 2), np.nan)
    for person in truth.people:
        places[person.id - 1] = truth.robot.to_local(person.position_m)
    return places


@dataclass(frozen=True, slots=True, eq=False)
class BeamSamples(Arrays):
    """N beams.

    Attributes:
        inputs: (N, SIZE) of the networks.
        offset_m: (N, 2) offset of the person that the beam hits, along it and to the left; NaN for none.
    """

    inputs: NDArray[np.float32]
    offset_m: Floats


def sample_beams(scans: Scans, rng: np.random.Generator) -> BeamSamples:
    """Return all beams that hit people, and some of the others."""
    calibration, parts = scans.calibration, []
    for k, ranges in enumerate(scans.ranges):
        beams, inputs = cut_windows(ranges, calibration)
        person = scans.person[k][beams].astype(np.int64)
        offset = np.full((len(beams), 2), np.nan)
        hits = np.flatnonzero(person)
        away = scans.place_m[k][person[hits] - 1] - calibration.points(ranges / 1000.0)[beams[hits]]
        bearing = calibration.bearings[beams[hits]]
        cosine, sine = np.cos(bearing), np.sin(bearing)
        offset[hits] = np.column_stack(
            [away[:, 0] * cosine + away[:, 1] * sine, away[:, 1] * cosine - away[:, 0] * sine]
        )
        share = min(1.0, _NEGATIVES * max(len(hits), 4) / max(len(beams), 1))
        is_kept = (person > 0) | (rng.random(len(beams)) < share)
        parts.append(BeamSamples(inputs[is_kept], offset[is_kept]))
    return BeamSamples.join(parts)


def sample_groups(model: LegModel, sequences: Sequence[Scans]) -> tuple[NDArray[np.float32], NDArray[Any]]:
    """Return the features (M, FEATURES) of groups of votes, and whether each is of a person (M, 1)."""
    features, labels = [], []
    for scans in sequences:
        for k, ranges in enumerate(scans.ranges):
            groups = group_votes(model.vote(ranges, scans.calibration), scans.calibration)
            places, _ = scans.people(k)
            away = np.hypot(*(groups.places_m[:, None] - places).transpose(2, 0, 1))
            is_person = np.zeros(len(groups.places_m), np.bool_)
            for column in range(len(places)):  # the first group, which has the strongest vote, is the person
                near = np.flatnonzero((away[:, column] < RADIUS_M) & ~is_person)
                is_person[near[:1]] = True
            features.append(groups.features)
            labels.append(is_person[:, None])
    return np.concatenate(features), np.concatenate(labels)


def detect_all(model: LegModel, sequences: Sequence[Scans]) -> list[FloorFrame]:
    """Detect people in all scans, beside the true positions."""
    frames = []
    for scans in sequences:
        for k, ranges in enumerate(scans.ranges):
            found = model.detect(ranges, scans.calibration)
            places, counts = scans.people(k)
            frames.append(FloorFrame(found.places_m, found.scores, places, counts))
    return frames


@dataclass(frozen=True, slots=True, kw_only=True)
class LegsTraining(Specification[Split[list[Scans]]]):
    """The trackers with a laser range finder use these networks.

    The training data are scans of random scenes and random worlds, by range finders of 180 to 720 beams.
    """

    sequences: Annotated[
        int,
        Field(
            ge=2,
            le=100_000,
            alias="seeds",
            description="Number of random scenes to train on, and of random worlds.",
        ),
    ] = 250

    def tasks(self, out: Path) -> Tasks:
        """Scan scenes and worlds."""
        folder = sample_folder(out, Path(__file__))

        def tasks(first_scene: int, first_world: int, count: int) -> list[SampleTask]:
            firsts = {_SCENE: first_scene, _WORLD: first_world}
            return [
                SampleTask(folder / f"{kind}_{first + k}.npz", scan_random, (kind, first + k))
                for kind, first in firsts.items()
                for k in range(count)
            ]

        training = tasks(FIRST_SEED, FIRST_WORLD, self.sequences)
        return Split(training, tasks(0, _FIRST_OTHER_WORLD, VALIDATION))

    def load(self, tasks: Tasks) -> Split[list[Scans]]:
        """Read the scans."""
        training, validation = ([Scans.load(task.path) for task in part] for part in tasks)
        return Split(training, validation)

    def fit(self, data: Split[list[Scans]]) -> Mapping[str, LegModel]:
        """Train the networks for beams and offsets, then the one for groups of their votes."""
        rng = np.random.default_rng(2009)
        samples = BeamSamples.join([sample_beams(scans, rng) for scans in data.training])
        is_person = ~np.isnan(samples.offset_m[:, 0])
        beam = fit_dense(BEAM, cross_entropy, samples.inputs, is_person[:, None], 0)
        offset = fit_dense(OFFSET, squares, samples.inputs[is_person], samples.offset_m[is_person], 0)
        model = LegModel(beam, offset, beam)
        features, labels = sample_groups(model, data.training)
        scans = sum(len(one) for one in data.training)
        hits, others = int(is_person.sum()), int((~is_person).sum())
        about = {
            "trained on": f"{scans} scans of {self.sequences} random scenes, seeds from {FIRST_SEED}, and as "
            f"many random worlds, seeds from {FIRST_WORLD}; {hits} beams that hit people and {others} others"
        }
        person = fit_dense(PERSON, cross_entropy, features, labels, 0)
        return {FILE: replace(model, person=person, about=about)}

    def evaluate(self, model: LegModel, data: Split[list[Scans]]) -> Mapping[str, str]:
        """Evaluate detections of single scans."""
        frames = detect_all(model, data.validation)
        score = average_precision(frames, RADIUS_M)
        return {
            "on other scenes": f"average precision {score.average_precision:.3f} at {RADIUS_M:g} m, error "
            f"{score.error_m:.3f} m, of {score.people} people in {len(frames)} scans within {FARTHEST_M:g} m"
        }
