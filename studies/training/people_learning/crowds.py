"""Random worlds full of people, many of them together, some far off, seen from higher up."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np

from peopleboy.scenarios.random_worlds.distribution import ODDS, RANGES, SHARES, Distribution
from peopleboy.scenarios.random_worlds.draw_scene import is_valid, rounded
from peopleboy.scenarios.random_worlds.random_world import random_world
from peopleboy.sim.random_streams import stream

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
_CROWDS: Final = Distribution(
    ranges={**RANGES, **{key: replace(RANGES[key], low=a, high=b) for key, (a, b) in _RANGES.items()}},
    shares={**SHARES, **_SHARES},
    odds={**ODDS, **{key: (odds, ODDS[key][1]) for key, odds in _ODDS.items()}},
)
_TOGETHER: Final = 0.5  # of all people have somebody beside them
_APART_M: Final = (0.45, 0.9)
_TRIES: Final = 4


def crowded_world(seed: int) -> dict[str, Any]:
    """Draw a world of 5 to 10 people, as far as they find room, and of those who walk beside them."""
    world = random_world(seed, distribution=_CROWDS)
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
