"""Vary a world, so that a controller that learns in it does not overfit: temperature, light, noise, people.

An episode of an environment is a world, varied, with physics and images of its own. Its settings are part of
the scenario file of the run that it is saved as.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Final

import numpy as np
from pydantic import Field

from peopleboy.random_streams import stream
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
}
"""Keys of `reset(options=...)` and their limits; a value is a number, or a pair to sample from uniformly.

warmer_k [K] is added to the temperatures of the place and of everything in it; light is a factor on the
light, and noise a factor on the noise of all cameras; people is the number of people, the first ones of the
scenario, so that fewer people occlude each other; clothes, 1 or True, samples all clothes anew; pace
is a factor on all walking speeds, which stay within 0.1..2.5 m/s; facing, 1 or True, makes the robot
initially face the point where the first person enters.

Random worlds also have `world`: the distribution that they are sampled from, see
`peopleboy.scenarios.random_worlds.distribution`.
"""

SWITCHES: Final = ("clothes", "facing")
WHOLE: Final = ("people", *SWITCHES)


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
    rng = stream(config.seed, "environment.options")
    drawn = {key: _draw(key, ranges[key][0], ranges[key][1], rng) for key in LIMITS if key in ranges}
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
    return replace(config, place=place, robot=robot, people=people)


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
