"""Random training worlds of the detector: ordinary, crowded, plain, and warm ones."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from peopleboy.random_streams import stream
from peopleboy.scenarios.random_worlds.distribution import ODDS, RANGES, SHARES, Distribution
from peopleboy.scenarios.random_worlds.draw_scene import is_valid, rounded
from peopleboy.scenarios.random_worlds.random_world import random_world

World = dict[str, Any]

_RANGES: Final[Mapping[str, tuple[float, float]]] = {
    "room_length": (9.0, 20.0),
    "room_width": (6.0, 14.0),
    "street_length": (18.0, 40.0),
    "ceiling": (3.6, 5.0),
    "things": (0, 10),
    "people": (5, 10),
    "camera_height": (0.8, 3.4),
    "pitch": (-4.0, 20.0),
    "vertical_fov": (20.0, 50.0),
}
_SHARES: Final[Mapping[str, Mapping[str, float]]] = {
    "place": {"room": 0.35, "street": 0.65},
    "robot": {"stands": 0.9, "drives": 0.1},
}
_ODDS: Final[Mapping[str, float]] = {"begins_in_view": 0.9, "enters_later": 0.1}
_PEOPLE: Final[Mapping[str, Mapping[str, float]]] = {
    "posture": {
        "standing": 0.3, "sitting": 0.15, "bending": 0.14, "crouching": 0.1, "lying": 0.08, "fallen": 0.07,
        "arms_crossed": 0.06, "arms_raised": 0.06, "kneeling": 0.04,
    },
    "bodies": {"capsules": 0.4, "skins": 0.6},
}  # fmt: skip
"""Kinds of people, as far as they differ from those of other random worlds."""
_HIGH: Final[Mapping[str, tuple[float, float]]] = {
    "street_length": (18.0, 40.0),
    "room_length": (9.0, 20.0),
    "ceiling": (4.0, 5.0),
    "people": (1, 8),
    "camera_height": (2.2, 5.5),
    "pitch": (8.0, 32.0),
    "vertical_fov": (20.0, 45.0),
}


def _distribution(
    ranges: Mapping[str, tuple[float, float]],
    shares: Mapping[str, Mapping[str, float]],
    odds: Mapping[str, float],
) -> Distribution:
    """Return a distribution of random worlds with other ranges, shares and odds, and all kinds of people."""
    return Distribution(
        ranges={**RANGES, **{key: replace(RANGES[key], low=a, high=b) for key, (a, b) in ranges.items()}},
        shares={**SHARES, **_PEOPLE, **shares},
        odds={**ODDS, **{key: (share, ODDS[key][1]) for key, share in odds.items()}},
    )


_ALL_PEOPLE: Final = _distribution({}, {}, {"pauses": 0.4, "begins_in_view": 0.8})
_CROWDS: Final = _distribution(_RANGES, _SHARES, {**_ODDS, "pauses": 0.35})
_FROM_ABOVE: Final = _distribution(_HIGH, {**_SHARES, "place": {"room": 0.15, "street": 0.85}}, _ODDS)
_TOGETHER: Final = 0.5  # share of people with a companion
_APART_M: Final = (0.45, 0.9)
_TRIES: Final = 4


def ordinary_world(seed: int, distribution: Distribution = _ALL_PEOPLE) -> World:
    """Draw a random world with people of all ages and gaits, in all postures, some with equipment."""
    return random_world(seed, distribution=distribution)


def crowded_world(seed: int) -> dict[str, Any]:
    """Draw a world with 5 to 10 people, as far as there is room, some with companions beside them."""
    world = ordinary_world(seed, _CROWDS)
    rng = stream(seed, "crowded_world")
    for person in world.get("people", ()):
        if rng.random() < _TOGETHER:
            world = _with_companion(world, person, rng)
    return world


def _with_companion(
    world: dict[str, Any], person: dict[str, Any], rng: np.random.Generator
) -> dict[str, Any]:
    """Add a person who walks a parallel path, if that path is free."""
    for _ in range(_TRIES):
        way, far = rng.uniform(-math.pi, math.pi), rng.uniform(*_APART_M)
        aside = np.array([far * math.cos(way), far * math.sin(way)])
        path = [
            point | {"at_m": [rounded(x) for x in np.array(point["at_m"]) + aside]}
            for point in person["path"]
        ]
        other = person | {"name": f"{person['name']}_beside", "path": path}
        fuller = world | {"people": [*world["people"], other]}
        if is_valid(fuller):
            return fuller
    return world


_WARMEST_C: Final = 25.0
_SURFACES: Final = ("walls_c", "floor_c", "ceiling_c", "surroundings_c", "air_c")
_OF_CAMERA: Final = ("kind", "mount_m", "pitch_deg", "vertical_fov_deg")
_WARM_AIR_C: Final = (27.0, 31.0)


def with_library_span(world: World) -> World:
    """Return a plain world seen in the robot's own span of 24..36 degC, in which most pixels are black."""
    warmth = world["place"].get("temperatures", {})
    is_warm = max((warmth.get(surface, 0.0) for surface in _SURFACES), default=0.0) > _WARMEST_C
    return _plain(world, {} if is_warm else warmth)


def with_warm_air(world: World, air_c: float) -> World:
    """Return a plain world in the same span, with all temperatures shifted by the same offset as the air."""
    warmth = world["place"]["temperatures"]
    warmer = air_c - warmth["air_c"]
    walls = {name: rounded(value + warmer) for name, value in warmth["single_walls_c"].items()}
    warm = {key: rounded(value + warmer) for key, value in warmth.items() if key != "single_walls_c"}
    return _plain(world, warm | {"single_walls_c": walls})


def _plain(world: World, temperatures: World) -> World:
    """Return a world with given temperatures, without details and sun, seen in the robot's own span."""
    place = {key: value for key, value in world["place"].items() if key not in ("sun", "temperatures")}
    place |= {"temperatures": temperatures} if temperatures else {}
    cameras = world["robot"]["cameras"]
    own = {key: value for key, value in cameras["thermal"].items() if key in _OF_CAMERA}
    robot = world["robot"] | {"cameras": cameras | {"thermal": own}}
    return world | {"detail": "plain", "place": place, "robot": robot}


@dataclass(frozen=True, slots=True)
class WorldKind:
    """A kind of training worlds.

    Attributes:
        description: text for reports.
        first_seed: first of at most 1000 seeds.
        share: share of all training worlds.
        draw: function that returns the scenario data for a seed.
    """

    description: str
    first_seed: int
    share: float
    draw: Callable[[int], World]

    def seeds(self, worlds: int) -> range:
        """Return the seeds of this kind's share of a number of worlds, at least one."""
        return range(self.first_seed, self.first_seed + max(round(self.share * worlds), 1))


def _library_world(seed: int) -> World:
    return with_library_span(ordinary_world(seed))


def _library_crowd(seed: int) -> World:
    return with_library_span(crowded_world(seed))


def _world_from_above(seed: int) -> World:
    return ordinary_world(seed, _FROM_ABOVE)


def _warm_world(seed: int) -> World:
    return with_warm_air(ordinary_world(seed), rounded(stream(seed, "warm_world").uniform(*_WARM_AIR_C)))


KINDS: Final = (
    WorldKind("random worlds", 1000, 0.32, ordinary_world),
    WorldKind("crowds", 2000, 0.12, crowded_world),
    WorldKind("worlds in the robot's own span", 3000, 0.22, _library_world),
    WorldKind("plain worlds as warm as people", 4000, 0.04, _warm_world),
    WorldKind("crowds in the robot's own span", 5000, 0.08, _library_crowd),
    WorldKind("worlds seen from above", 6000, 0.22, _world_from_above),
)

LATER: Final = 10_000
"""Distance between the seed ranges of a kind."""


def world_of(seed: int) -> World:
    """Draw the world of a seed; seeds below the first kind's range belong to the first kind, too."""
    kind = next((kind for kind in reversed(KINDS) if seed % LATER >= kind.first_seed), KINDS[0])
    return kind.draw(seed)


def seeds_of(worlds: int) -> list[int]:
    """Return the seeds of a number of worlds, at least one of each kind."""
    return [seed for kind in KINDS for seed in kind.seeds(worlds)]
