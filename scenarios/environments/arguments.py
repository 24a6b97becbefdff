"""Check the arguments, actions and options of an environment, and vary its worlds according to the options.

Worlds vary between episodes so that a learned controller does not overfit to one of them.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from reprlib import repr as shown
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.bad_input import BadInput, found_in
from peopleboy.scenarios.random_worlds.distribution import Distribution, is_number, narrowed
from peopleboy.sim.people.appearance.traits import usual_clothes
from peopleboy.sim.people.body.clothes import Clothes, random_clothes
from peopleboy.sim.people.person_config import SPEEDS_M_S, PersonConfig
from peopleboy.sim.places.place import Fixture, Place, air_of
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.world_config import WorldConfig
from peopleboy.wording import hint

SMALLEST_PX: Final = (64, 48)
LARGEST_PX: Final = (1280, 960)


def check_word(name: str, word: str | None, known: Sequence[str | None]) -> None:
    """Refuse an unknown word.

    Raises:
        BadInput: the word is not in `known`.
    """
    if not (word is None or isinstance(word, str)) or word not in known:
        raise BadInput(f"unknown {name} {shown(word)}; choose from {', '.join(map(str, known))}")


def check_size(size: tuple[int, int]) -> None:
    """Refuse an invalid width and height [px] of images.

    Raises:
        BadInput: the size is invalid.
    """
    is_fine = (
        isinstance(size, tuple | list)
        and len(size) == 2
        and all(
            isinstance(got, int) and low <= got <= high
            for got, low, high in zip(size, SMALLEST_PX, LARGEST_PX, strict=True)
        )
    )
    if not is_fine:
        (narrow, flat), (wide, tall) = SMALLEST_PX, LARGEST_PX
        raise BadInput(
            f"image_size {shown(size)} must be width and height [px], {narrow} x {flat} to {wide} x {tall}"
        )


def whole_number(name: str, value: Any, low: int, high: int) -> int:
    """Return a whole number, NumPy's included, within limits.

    Raises:
        BadInput: it is no such number.
    """
    is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not is_whole or not low <= value <= high:
        raise BadInput(f"{name} {shown(value)} must be a whole number from {low} to {high}")
    return int(value)


def shown_cameras(cameras: Sequence[str] | None, observation: str, robot: RobotConfig) -> tuple[str, ...]:
    """Return the names of the cameras in the observation; all cameras if `cameras` is None.

    Raises:
        BadInput: the robot lacks one of the cameras, or the observation has no images.
    """
    if cameras is None:
        return tuple(robot.cameras)
    if observation != "pixels":
        raise BadInput(f"cameras {shown(cameras)}: observation {observation!r} has no images; leave them out")
    is_list = isinstance(cameras, tuple | list) and all(isinstance(name, str) for name in cameras)
    if not is_list or not cameras or len(set(cameras)) < len(cameras):
        raise BadInput(f"cameras {shown(cameras)} must be one or more different names, such as ('thermal',)")
    for name in cameras:
        check_word("cameras", name, tuple(robot.cameras))
    return tuple(cameras)


def check_actions(actions: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return actions as shares of the speed limits, clipped to -1..1: (G, 2).

    Raises:
        BadInput: the actions do not have this shape, or contain NaN or infinity.
    """
    try:
        shares = np.asarray(actions, np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise BadInput(f"actions must be {shape}, two finite numbers each, got {shown(actions)}") from error
    if shares.shape != shape:
        raise BadInput(f"actions of shape {shares.shape}: must be {shape}, two finite numbers each")
    if not np.isfinite(shares).all():
        wrong = next(row for row in shares.reshape(-1, 2).tolist() if not np.isfinite(row).all())
        raise BadInput(f"action {wrong} must be two finite numbers: shares of speed and turn rate")
    return np.clip(shares, -1.0, 1.0).reshape(-1, 2)


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

WORLD: Final = "world"

_SWITCHES: Final = ("clothes", "facing")
_WHOLE: Final = ("people", *_SWITCHES)


def check_options(options: Mapping[str, Any], *, draws_worlds: bool = False) -> None:
    """Refuse unknown options and values outside their limits.

    Args:
        options: values by name.
        draws_worlds: whether worlds are random, so that `world` is valid.

    Raises:
        BadInput: an option is invalid; the error states key, value and limits.
    """
    if not isinstance(options, Mapping):
        raise BadInput(f"options: must be a mapping of names to values, got {shown(options)}")
    for key, value in options.items():
        if key == WORLD and draws_worlds:
            world_of(options)
            continue
        if key == WORLD:
            raise BadInput("options: world needs random worlds; make the environment with scenario=None")
        if key not in LIMITS:
            raise BadInput(f"options: unknown key {shown(key)}; {hint(str(key), [*LIMITS, WORLD])}")
        low, high = LIMITS[key]
        bounds = value if isinstance(value, tuple | list) else (value, value)
        is_fine = len(bounds) == 2 and all(
            _is_number(bound, key) and low <= bound <= high for bound in bounds
        )
        if not is_fine or bounds[0] > bounds[1]:
            what = "a whole number" if key in _WHOLE else "a number"
            raise BadInput(
                f"options: {key} {shown(value)} must be {what} or a rising pair, within {low:g} .. {high:g}"
            )


def world_of(options: Mapping[str, Any]) -> Distribution | None:
    """Return the distribution of random worlds that the options ask for; None for the default distribution.

    Raises:
        BadInput: a name is unknown, or its value is outside the limits.
    """
    if WORLD not in options:
        return None
    with found_in("options", WORLD):
        return narrowed(options[WORLD])


def vary(config: WorldConfig, options: Mapping[str, Any], rng: np.random.Generator) -> WorldConfig:
    """Vary a world according to options that were checked."""
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


def _is_number(value: object, key: str) -> bool:
    if isinstance(value, bool):
        return key in _SWITCHES
    return is_number(value, is_whole=key in _WHOLE)


def _draw(key: str, value: Any, rng: np.random.Generator) -> float:
    low, high = value if isinstance(value, tuple | list) else (value, value)
    return float(rng.integers(low, high, endpoint=True) if key in _WHOLE else rng.uniform(low, high))


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
