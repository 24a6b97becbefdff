"""Random worlds full of people, many of them together, some far off, seen from higher up."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np

from peopleboy.scenarios.random_worlds.attempts import is_valid, rounded
from peopleboy.scenarios.random_worlds.distribution import ODDS, RANGES, SHARES, Distribution, Range
from peopleboy.scenarios.random_worlds.random_world import random_world
from peopleboy.sim.random_streams import stream

LASTS_S: Final = 12.0

_CROWDS: Final = Distribution(
    ranges=RANGES
    | {
        "room_length": Range(low=9.0, high=20.0, unit="m", what=RANGES["room_length"].what),
        "room_width": Range(low=6.0, high=14.0, unit="m", what=RANGES["room_width"].what),
        "street_length": Range(low=18.0, high=40.0, unit="m", what=RANGES["street_length"].what),
        "ceiling": Range(low=3.6, high=5.0, unit="m", what=RANGES["ceiling"].what),
        "things": Range(low=0, high=10, unit="", what=RANGES["things"].what, is_whole=True),
        "people": Range(low=5, high=10, unit="", what=RANGES["people"].what, is_whole=True),
        "camera_height": Range(low=0.8, high=3.4, unit="m", what=RANGES["camera_height"].what),
        "pitch": Range(low=-4.0, high=20.0, unit="deg", what=RANGES["pitch"].what),
        "vertical_fov": Range(low=20.0, high=50.0, unit="deg", what=RANGES["vertical_fov"].what),
    },
    shares=SHARES | {"place": {"room": 0.35, "street": 0.65}, "robot": {"stands": 0.9, "drives": 0.1}},
    odds=ODDS
    | {name: (odds, ODDS[name][1]) for name, odds in (("begins_in_view", 0.9), ("enters_later", 0.1))},
)
_TOGETHER: Final = 0.5  # of all people have somebody beside them
_APART_M: Final = (0.45, 0.9)
_TRIES: Final = 4


def crowded_world(seed: int) -> dict[str, Any]:
    """Draw a world of 5 to 10 people, as far as they find room, and of those who walk beside them."""
    world = random_world(seed, LASTS_S, _CROWDS)
    rng = stream(seed, "crowded_world")
    for person in world.get("people", ()):
        if rng.random() < _TOGETHER:
            world = _with_somebody_beside(world, person, rng)
    return world


def _with_somebody_beside(
    world: dict[str, Any], person: dict[str, Any], rng: np.random.Generator
) -> dict[str, Any]:
    """Add somebody who goes the same way a little aside; nobody, if that is not free."""
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
