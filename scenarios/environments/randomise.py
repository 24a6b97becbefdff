"""Worlds varied from episode to episode, so that a learned controller does not rely on one of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.schema_errors import hint
from peopleboy.sim.config import WorldConfig
from peopleboy.sim.people.body.clothes import Clothes, random_clothes
from peopleboy.sim.people.looks.wardrobe import usual_clothes
from peopleboy.sim.people.person_config import PersonConfig
from peopleboy.sim.places.place import Fixture, Place, air_of
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.shapes.materials import Material

LIMITS: Final[Mapping[str, tuple[float, float]]] = {
    "warmer_k": (-30.0, 30.0),
    "light": (0.0, 2.0),
    "noise": (0.0, 20.0),
    "people": (0, 64),
    "clothes": (0, 1),
}
"""What `reset(options=...)` takes, with its limits; each a number, or a pair from which one is drawn evenly.

warmer_k [K] is added to the temperatures of the place and of everything in it; light is a factor on the
light, and noise one on the noise of all cameras; people is how many of the scenario's people are there, its
first ones; clothes, 1 or True, draws everybody's clothes anew.
"""

_WHOLE: Final = ("people", "clothes")


def check_options(options: Mapping[str, Any]) -> None:
    """Refuse options that there are not, and values out of their limits.

    Raises:
        BadInput: with the key, the value, and what would be right.
    """
    for key, value in options.items():
        if key not in LIMITS:
            raise BadInput(f"options: unknown key {key!r}; {hint(str(key), list(LIMITS))}")
        low, high = LIMITS[key]
        bounds = value if isinstance(value, tuple | list) else (value, value)
        is_fine = len(bounds) == 2 and all(
            _is_number(bound, key) and low <= bound <= high for bound in bounds
        )
        if not is_fine or bounds[0] > bounds[1]:
            what = "a whole number" if key in _WHOLE else "a number"
            raise BadInput(f"options: {key} {value!r} must be {what} or a pair, within {low:g} .. {high:g}")


def vary(config: WorldConfig, options: Mapping[str, Any], rng: np.random.Generator) -> WorldConfig:
    """Vary a world by options that were checked."""
    drawn = {key: _draw(key, options[key], rng) for key in LIMITS if key in options}
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
    return replace(config, place=place, robot=robot, people=people)


def _clothes(config: WorldConfig, person: PersonConfig, rng: np.random.Generator) -> Clothes:
    """Draw what a person wears: anything, or what is usual where all is drawn finely."""
    if config.detail == "plain":
        return random_clothes(rng)
    return usual_clothes(rng, person.sex, air_of(config.place))


def _is_number(value: object, key: str) -> bool:
    if isinstance(value, bool):
        return key == "clothes"
    if isinstance(value, int | np.integer):
        return True
    return key not in _WHOLE and isinstance(value, float | np.floating) and math.isfinite(value)


def _draw(key: str, value: Any, rng: np.random.Generator) -> float:
    low, high = value if isinstance(value, tuple | list) else (value, value)
    return float(rng.integers(low, high, endpoint=True) if key in _WHOLE else rng.uniform(low, high))


def _lighter(light: tuple[tuple[float, float], ...], factor: float) -> tuple[tuple[float, float], ...]:
    """Scale all steps of the light, and the full light before the first of them."""
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
