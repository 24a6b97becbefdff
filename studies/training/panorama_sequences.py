"""Rendered sequences of the panoramic camera, with ground truth for every pixel."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Final

import numpy as np
import yaml
from numpy.typing import NDArray

from peopleboy.geometry.camera_calibration import PanoramaCalibration
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.random_worlds.draw_scene import Data, rounded
from peopleboy.scenarios.run_folder.atomic_output import atomic
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.geometry.panorama import Panorama
from peopleboy.sim.truth.truth import Truth
from peopleboy.studies.training.random_scenes import random_scene
from peopleboy.studies.training.samples import Arrays, SampleTask
from peopleboy.tracker.frame import PANORAMA, Odometry
from peopleboy.tracker.sensors.panorama.panorama_view import (
    ALL_ROUND_M,
    PanoramaName,
    PanoramaView,
    all_round,
    view_over,
)

Floats = NDArray[np.float64]

CAMERA_HELP: Final = (
    "Camera of the images: the default mirror, or the all-round view, into which other panoramas are "
    "resampled."
)

_LENS_M: Final = 0.001  # so close to its mirror that all columns share a centre


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PanoramaSequence(Arrays):
    """The images of one run, with ground truth.

    Attributes:
        images: (N, H, W, 3) uint8 RGB.
        person: (N, H, W) uint8 number of the person at each pixel, 0 for none.
        time_s: (N,) times of the images [s].
        motion: (N, 3) motion since the previous image by odometry: forward [m], left [m], rotation [rad].
        place_m: (N, P, 2) positions of people 1, 2, ... in the robot's frame [m]; NaN while they are absent.
    """

    # A hundred sequences of 10 MB are read in each round of training.
    IS_COMPRESSED: ClassVar[bool] = False

    images: NDArray[np.uint8]
    person: NDArray[np.uint8]
    time_s: Floats
    motion: Floats
    place_m: Floats

    @property
    def is_driven(self) -> bool:
        """Whether the robot moves by more than the odometry noise."""
        return bool(np.abs(self.motion).sum() > 0.05)

    def odometry(self, k: int) -> Odometry | None:
        """Return the robot's motion before image k; None for the first image."""
        if k == 0:
            return None
        advance, aside, turn = self.motion[k].tolist()
        return Odometry(advance_m=advance, aside_m=aside, turn_rad=turn)


def render_panoramas(scenario: Scenario, seed: int) -> PanoramaSequence:
    """Render a scenario with the panoramic camera; other cameras are not rendered.

    Raises:
        BadInput: the robot needs images to drive.
    """
    scenario = scenario.mounting((PANORAMA,))
    seen: dict[str, list[Any]] = {name: [] for name in ("images", "person", "time_s", "motion", "place_m")}
    before: Pose2 | None = None
    for world, observation in blind_drive(scenario, seed):
        if PANORAMA in observation.images:
            truth, now = world.truth(PANORAMA), observation.odometry
            seen["images"].append(np.array(observation.images[PANORAMA]))
            seen["person"].append(np.array(truth.instance))
            seen["time_s"].append(observation.time_s)
            seen["motion"].append(_motion(before, now))
            seen["place_m"].append(_places(truth, len(world.config.people)))
            before = now
    return PanoramaSequence(**{name: np.array(values) for name, values in seen.items()})


def render_random_scene(folder: Path, seed: int, camera: PanoramaName) -> PanoramaSequence:
    """Draw the scene of a seed, write its scenario to the folder, and render it."""
    path = scenario_path(folder, seed)
    own = all_round_camera(seed) if camera == "all-round" else {}
    with atomic(path) as part:
        scene = random_scene(seed, PANORAMA, own)
        part.write_text(yaml.safe_dump(scene, sort_keys=False), encoding="utf-8")
    return render_panoramas(load_scenario(path), seed)


def all_round_camera(seed: int) -> Data:
    """Return the keys of a camera with the view `all_round`, at a random height."""
    height_m = rounded(np.random.default_rng((seed, 360)).uniform(*ALL_ROUND_M))
    view = all_round(height_m)
    mirror = {
        "half_apex_deg": 45.0 + math.degrees(view.axis_rad) / 2.0,
        "lens_half_angle_deg": math.degrees(math.atan(view.height / view.focal_px)),
        "lens_m": _LENS_M,
        "apex_m": height_m,
    }
    return {"width_px": view.width, "height_px": view.height, "mirror": mirror}


def scenario_path(folder: Path, seed: int) -> Path:
    """Return the path of the scenario file of a seed."""
    return folder / f"scene_{seed}.yaml"


def training_view(camera: PanoramaName) -> PanoramaView:
    """Return the view of the training images."""
    if camera == "all-round":
        return view_over([all_round(height_m) for height_m in ALL_ROUND_M])
    return view_over([Panorama().calibration])


def render_task(folder: Path, seed: int, camera: PanoramaName = "mirror") -> SampleTask:
    """Return the task of rendering the scene of a seed."""
    path = scenario_path(folder, seed).with_suffix(".npz")
    return SampleTask(path, render_random_scene, (folder, seed, camera))


def scene_calibration(task: SampleTask) -> PanoramaCalibration:
    """Return the calibration of the camera that rendered the scene of a completed task."""
    folder, seed, _ = task.arguments
    return panorama_calibration(load_scenario(scenario_path(folder, seed)), seed)


def panorama_calibration(scenario: Scenario, seed: int) -> PanoramaCalibration:
    """Return the calibration of a scenario's panoramic camera."""
    cameras = scenario.mounting((PANORAMA,)).world(seed).robot.cameras
    calibration = calibrations_of(cameras)[PANORAMA]
    if not isinstance(calibration, PanoramaCalibration):
        raise TypeError(f"{scenario.name}: camera {PANORAMA} is not panoramic")
    return calibration


def _motion(before: Pose2 | None, now: Pose2) -> tuple[float, float, float]:
    if before is None:
        return 0.0, 0.0, 0.0
    motion = now.relative_to(before)
    return motion.x, motion.y, motion.heading


def _places(truth: Truth, people: int) -> Floats:
    places = np.full((people, 2), np.nan)
    for person in truth.people:
        places[person.id - 1] = truth.robot.to_local(person.position_m)
    return places
