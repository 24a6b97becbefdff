"""Tracking quality with other cameras than the robot's own: `python -m benchmarks.cameras`.

Scenes of the library are run with both cameras at another height, tilted, or with another field of view, or
with a thermal image that is offset or drifts. The tracker runs on the same images with and without the
cameras' calibration.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

import click
import numpy as np

from benchmarks import call
from benchmarks.compare import Recording, print_head, print_row, truth_rows
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.imaging.electronics import encode_8bit
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from peopleboy.tracker.evaluation.evaluate import Scores, combine
from peopleboy.tracker.evaluation.sequence import TrueBoxes
from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.trackers import DEFAULT_TRACKER, make_tracker

SCENES: Final = ("crossing_2", "single_stationary")
_HEIGHT_M: Final = 1.2  # default height of the cameras

Offset = Callable[[float], float]


def _none(share: float) -> float:  # noqa: ARG001
    return 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """Changes to the robot's cameras.

    Attributes:
        pitch_deg: tilt, positive downwards.
        height_m: height above the floor.
        fov_deg: vertical field of view of the thermal camera; None for the default.
        offset_k: temperature offset of the thermal image, as a function of the elapsed share of the run.
    """

    pitch_deg: float = 0.0
    height_m: float = _HEIGHT_M
    fov_deg: float | None = None
    offset_k: Offset = _none


CAMERAS: Final[Mapping[str, Camera]] = {
    "as is": Camera(),
    "3.5 K warmer": Camera(offset_k=lambda share: 3.5),  # noqa: ARG005
    "6 K warmer": Camera(offset_k=lambda share: 6.0),  # noqa: ARG005
    "drift of 1.5 K": Camera(offset_k=lambda share: 1.5 * math.sin(2.0 * math.pi * share)),
    "6 deg down": Camera(pitch_deg=6.0),
    "6 deg up": Camera(pitch_deg=-6.0),
    "15 deg down": Camera(pitch_deg=15.0),
    "15 deg up": Camera(pitch_deg=-15.0),
    "at 0.4 m": Camera(height_m=0.4),
    "at 0.7 m": Camera(height_m=0.7),
    "at 1.6 m": Camera(height_m=1.6),
    "at 1.8 m": Camera(height_m=1.8),
    "60 deg": Camera(fov_deg=60.0),
    "25 deg": Camera(fov_deg=25.0),
}


def mounted(config: WorldConfig, camera: Camera) -> WorldConfig:
    """Apply the changes to all cameras of the robot."""
    cameras = {name: _moved(one, camera) for name, one in config.robot.cameras.items()}
    return replace(config, robot=replace(config.robot, cameras=cameras))


def _moved(config: CameraConfig, camera: Camera) -> CameraConfig:
    geometry = config.camera
    if not isinstance(geometry, Pinhole):
        return config
    x, y, z = geometry.position_m
    zoom = 1.0
    if camera.fov_deg is not None:
        zoom = math.tan(math.radians(camera.fov_deg) / 2.0) / math.tan(Pinhole().vertical_fov_rad / 2.0)
    moved = replace(
        geometry,
        pitch_rad=geometry.pitch_rad + math.radians(camera.pitch_deg),
        position_m=(x, y, z + camera.height_m - _HEIGHT_M),
        vertical_fov_rad=2.0 * math.atan(zoom * math.tan(geometry.vertical_fov_rad / 2.0)),
    )
    return replace(config, camera=moved)


def play(scene: str, camera: Camera, seed: int) -> Recording:
    """Run a scene with a standing robot and other cameras."""
    scenario = load_scenario(scene)
    config = mounted(scenario.world(seed), camera)
    count = round(scenario.duration_s * config.control_hz)
    frames, truth = [], []
    with SimulatedWorld(config) as world:
        for tick in range(count):
            observation = world.observe()
            frame = Frame.from_observation(observation)
            images = {name: observation.images[name] for name in frame.images if not name.endswith("_c")}
            warmer_c = observation.images["thermal_c"] + np.float32(camera.offset_k(tick / count))
            frames.append(replace(frame, images=images | {THERMAL: encode_8bit(warmer_c)}))
            truth += truth_rows(tick + 1, world.truth())
            world.step(0.0, 0.0)
    return Recording(tuple(frames), TrueBoxes.from_rows(truth))


def track(recording: Recording, tracker: str, seed: int) -> Scores:
    """Score a tracker on a recording."""
    people = make_tracker(tracker, seed)
    return recording.score(people.update(frame) for frame in recording.frames)


def rows(names: tuple[str, ...], seeds: int, tracker: str) -> Iterator[tuple[str, list[str]]]:
    """Yield CP, CR, IDF1 and HOTA [%] of each camera, with calibration and then without."""
    for name in names:
        played = [(seed, play(scene, CAMERAS[name], seed)) for scene in SCENES for seed in range(seeds)]
        calibrated = combine([track(one, tracker, seed) for seed, one in played])
        uncalibrated = combine([track(one.uncalibrated(), tracker, seed) for seed, one in played])
        cells = []
        for scores in (calibrated, uncalibrated):
            figures = (scores.thesis.cp, scores.thesis.cr, scores.mot.identity.idf1, scores.mot.hota.hota)
            cells += ["-" if math.isnan(figure) else f"{figure:.1f}" for figure in figures]
        yield name, cells


@click.command()
@click.option("--seeds", default=5, show_default=True, help="Runs per scene.")
@click.option("--tracker", default=DEFAULT_TRACKER, show_default=True)
@click.argument("cameras", nargs=-1, type=click.Choice(tuple(CAMERAS)))
def main(seeds: int, tracker: str, cameras: tuple[str, ...]) -> None:
    """Print metrics [%] of a tracker with these cameras, by default with all, as a Markdown table."""
    make_tracker(tracker)  # fails now rather than after scenes have run
    figures = ("CP", "CR", "IDF1", "HOTA")
    print_head("camera", [f"{one}, {kind}" for kind in ("calibrated", "not") for one in figures])
    for name, cells in rows(cameras or tuple(CAMERAS), seeds, tracker):
        print_row(name, cells)


if __name__ == "__main__":
    call(main, "benchmarks.cameras")
