"""Vary a world, so that a controller that learns in it does not overfit: light, people, cameras, drive.

An episode of an environment is a world, varied, with physics and images of its own. Its settings are part of
the scenario file of the run that it is saved as.
"""

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from peopleboy.random_streams import stream
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.people.appearance.traits import usual_clothes
from peopleboy.sim.people.body.clothes import Clothes, random_clothes
from peopleboy.sim.people.person_config import SPEEDS_M_S, PersonConfig
from peopleboy.sim.places.place import Fixture, Place, air_of
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.world_config import WorldConfig

LIMITS: Final[Mapping[str, tuple[float, float]]] = {
    "warmer_k": (-30.0, 30.0),
    "light": (0.0, 2.0),
    "noise": (0.0, 20.0),
    "people": (0, 64),
    "clothes": (0, 1),
    "pace": (0.2, 2.0),
    "facing": (0, 1),
    "camera_pitch_deg": (-15.0, 15.0),
    "camera_height_m": (-0.6, 0.6),
    "action_noise": (0.0, 1.0),
    "latency_s": (0.0, 1.0),
    "wheel_slip": (0.0, 0.9),
    "odometry_drift": (0.0, 1.0),
    "calibration_off": (0.0, 0.5),
    "calibration_turned": (0.0, 20.0),
}
"""Keys of `reset(options=...)` and their limits; a value is a number, or a pair to sample from uniformly.

warmer_k [K] is added to the temperatures of the place and of everything in it; light is a factor on the
light, and noise a factor on the noise of all cameras; people is the number of people, the first ones of the
scenario, so that fewer people occlude each other; clothes, 1 or True, samples all clothes anew; pace
is a factor on all walking speeds, which stay within 0.1..2.5 m/s; facing, 1 or True, makes the robot
initially face the point where the first person enters.

camera_pitch_deg [deg] and camera_height_m [m] are added to the pitch, positive downwards, and the height of
all flat cameras, and trackers get the changed calibration. action_noise is the standard deviation of the
noise on actions, new in each step; latency_s [s], in whole steps, is the time until an action reaches the
drive, with the robot at rest before. wheel_slip, odometry_drift, calibration_off and calibration_turned are
strengths of the faults of these names throughout the episode; those of the calibration only affect images.

Random worlds also have `world`: the distribution that they are sampled from, see
`peopleboy.scenarios.random_worlds.distribution`.
"""

SWITCHES: Final = ("clothes", "facing")
WHOLE: Final = ("people", *SWITCHES)
FAULTS: Final = ("wheel_slip", "odometry_drift", "calibration_off", "calibration_turned")
"""Options that are faults of the whole episode; their values are strengths."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EpisodeSpec:
    """The episode of an environment that a run repeats."""

    frames: Annotated[int, Field(ge=1, description="number of frames")]
    physics_hz: Annotated[int, Field(ge=1, description="physics steps per second")]
    image_size: Annotated[
        list[int] | None,
        Field(description="width and height of all images in pixels; by default, those of the cameras"),
    ] = None
    options: Annotated[
        dict[str, list[float]],
        Field(description="ranges of the options that varied the world, sampled with the seed"),
    ] = field(default_factory=dict)

    def applied_to(self, config: WorldConfig) -> WorldConfig:
        """Return the world of the episode."""
        robot = config.robot
        if self.image_size is not None:
            width, height = self.image_size
            robot = resized(robot, (width, height))
        return vary(replace(config, robot=robot, physics_hz=self.physics_hz), self.options)


def as_ranges(options: Mapping[str, Any]) -> dict[str, list[float]]:
    """Return options that were checked as ranges; options that do not vary a world are left out."""
    ranges = {}
    for key in LIMITS:
        if key in options:
            value = options[key]
            bounds = value if isinstance(value, tuple | list) else (value, value)
            ranges[key] = [float(bound) for bound in bounds]
    return ranges


def resized(robot: RobotConfig, size: tuple[int, int]) -> RobotConfig:
    """Change the image size of all cameras; vertical field of view and sharpness stay."""
    return replace(robot, cameras={name: camera.resized(*size) for name, camera in robot.cameras.items()})


def vary(config: WorldConfig, ranges: Mapping[str, list[float]]) -> WorldConfig:
    """Vary a world within ranges, sampled with the world's seed; see `as_ranges`."""
    drawn, rng = sample_options(config.seed, ranges)
    place, robot, people = config.place, config.robot, config.people
    if "warmer_k" in drawn:
        place = _warmer(place, drawn["warmer_k"])
    if "light" in drawn:
        place = replace(place, light=_lighter(place.light, drawn["light"]))
    if "noise" in drawn:
        robot = _noisier(robot, drawn["noise"])
    if "people" in drawn:
        people = people[: round(drawn["people"])]
    if drawn.get("clothes"):
        people = tuple(replace(person, clothes=_clothes(config, person, rng)) for person in people)
    if "pace" in drawn:
        people = tuple(_paced(person, drawn["pace"]) for person in people)
    if drawn.get("facing") and people:
        robot = _facing(robot, people[0])
    robot = _mounted(robot, drawn.get("camera_pitch_deg", 0.0), drawn.get("camera_height_m", 0.0))
    return replace(config, place=place, robot=robot, people=people)


def sample_options(
    seed: int, ranges: Mapping[str, list[float]]
) -> tuple[dict[str, float], np.random.Generator]:
    """Return the options of an episode, sampled with the world's seed, and the generator after that."""
    rng = stream(seed, "environment.options")
    return {key: _draw(key, ranges[key][0], ranges[key][1], rng) for key in LIMITS if key in ranges}, rng


class ActionChannel:
    """What happens to actions on their way to the drive: noise and latency, as the options ask.

    Args:
        seed: seed of the episode.
        ranges: options of the episode; see `as_ranges`.
        dt_s: [s] length of a step.
    """

    def __init__(self, seed: int, ranges: Mapping[str, list[float]], dt_s: float) -> None:
        drawn, _ = sample_options(seed, ranges)
        self._noise = drawn.get("action_noise", 0.0)
        self._rng = stream(seed, "environment.action_noise")
        self._late = deque([np.zeros(2)] * round(drawn.get("latency_s", 0.0) / dt_s))

    def send(self, action: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what reaches the drive in this step, (2,) within -1..1, after an action (2,) is given."""
        if self._noise:
            action = np.clip(action + self._noise * self._rng.standard_normal(2), -1.0, 1.0)
        self._late.append(action)
        return self._late.popleft()


def _paced(person: PersonConfig, factor: float) -> PersonConfig:
    slowest, fastest = SPEEDS_M_S
    path = tuple(
        replace(waypoint, speed_m_s=min(max(factor * waypoint.speed_m_s, slowest), fastest))
        for waypoint in person.path
    )
    return replace(person, path=path)


def _facing(robot: RobotConfig, person: PersonConfig) -> RobotConfig:
    dx, dy = (there - here for there, here in zip(person.path[0].at_m, robot.at_m, strict=True))
    return replace(robot, heading_rad=math.atan2(dy, dx))


def _clothes(config: WorldConfig, person: PersonConfig, rng: np.random.Generator) -> Clothes:
    """Sample a person's clothes: any in plain worlds, typical ones in detailed worlds."""
    if config.detail == "plain":
        return random_clothes(rng)
    return usual_clothes(rng, person.sex, air_of(config.place))


def _draw(key: str, low: float, high: float, rng: np.random.Generator) -> float:
    return float(rng.integers(int(low), int(high), endpoint=True) if key in WHOLE else rng.uniform(low, high))


def _lighter(light: tuple[tuple[float, float], ...], factor: float) -> tuple[tuple[float, float], ...]:
    """Scale all steps of the light, including the full light before the first step."""
    return tuple((at_s, factor * level) for at_s, level in ((-1.0, 1.0), *light))


def _noisier(robot: RobotConfig, factor: float) -> RobotConfig:
    cameras = {name: camera.noisier(factor) for name, camera in robot.cameras.items()}
    return replace(robot, cameras=cameras)


def _mounted(robot: RobotConfig, pitch_deg: float, height_m: float) -> RobotConfig:
    """Turn all flat cameras downwards by an angle, and raise them."""
    if not (pitch_deg or height_m):
        return robot
    cameras = {
        name: replace(config, camera=_raised(config.camera, pitch_deg, height_m))
        if isinstance(config.camera, Pinhole)
        else config
        for name, config in robot.cameras.items()
    }
    return replace(robot, cameras=cameras)


def _raised(camera: Pinhole, pitch_deg: float, height_m: float) -> Pinhole:
    x, y, z = camera.position_m
    pitch_rad = camera.pitch_rad + math.radians(pitch_deg)
    return replace(camera, position_m=(x, y, z + height_m), pitch_rad=pitch_rad)


def _warmer(place: Place, by_k: float) -> Place:
    fixtures = tuple(_warmer_fixture(fixture, by_k) for fixture in place.fixtures)
    return replace(place, fixtures=fixtures, surroundings_c=place.surroundings_c + by_k)


def _warmer_fixture(fixture: Fixture, by_k: float) -> Fixture:
    if fixture.part is not None:
        part = replace(fixture.part, material=_warmer_material(fixture.part.material, by_k))
        return replace(fixture, part=part)
    return replace(
        fixture, material=None if fixture.material is None else _warmer_material(fixture.material, by_k)
    )


def _warmer_material(material: Material, by_k: float) -> Material:
    return replace(material, temperature_c=material.temperature_c + by_k)
