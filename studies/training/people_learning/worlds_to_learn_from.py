"""The kinds of worlds that the detector learns from: as drawn, full of people, and plain ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from peopleboy.scenarios.random_worlds.draw_scene import rounded
from peopleboy.scenarios.random_worlds.random_world import random_world
from peopleboy.sim.random_streams import stream
from peopleboy.studies.training.people_learning.crowds import crowded_world

World = dict[str, Any]

_WARMEST_C: Final = 25.0
_SURFACES: Final = ("walls_c", "floor_c", "ceiling_c", "surroundings_c", "air_c")
_OF_CAMERA: Final = ("kind", "mount_m", "pitch_deg", "vertical_fov_deg")
_WARM_AIR_C: Final = (27.0, 31.0)


def as_the_library(world: World) -> World:
    """Give a world without the details, in a span of 24..36 degC: most of it is black."""
    place = {key: value for key, value in world["place"].items() if key != "sun"}
    warmth = place.get("temperatures", {})
    if max((warmth.get(surface, 0.0) for surface in _SURFACES), default=0.0) > _WARMEST_C:
        del place["temperatures"]
    return world | {"detail": "plain", "place": place, "robot": _with_own_camera(world["robot"])}


def _with_own_camera(robot: World) -> World:
    """Give a robot whose thermal camera has the span of the robot's own."""
    cameras = robot["cameras"]
    own = {key: value for key, value in cameras["thermal"].items() if key in _OF_CAMERA}
    return robot | {"cameras": cameras | {"thermal": own}}


def as_warm_as_people(world: World, air_c: float) -> World:
    """Give a world without the details, in the same span, whose air is that warm, and all else by as much."""
    place = {key: value for key, value in world["place"].items() if key != "sun"}
    warmth = place["temperatures"]
    warmer = air_c - warmth["air_c"]
    walls = {name: rounded(value + warmer) for name, value in warmth["single_walls_c"].items()}
    warm = {key: rounded(value + warmer) for key, value in warmth.items() if key != "single_walls_c"}
    place |= {"temperatures": warm | {"single_walls_c": walls}}
    return world | {"detail": "plain", "place": place, "robot": _with_own_camera(world["robot"])}


@dataclass(frozen=True, slots=True)
class Kind:
    """Worlds of a kind.

    Attributes:
        words: what they are.
        first_seed: they have seeds from here on, at most 1000.
        share: of all worlds that are learned from.
        draw: gives the data of a scenario of a seed.
    """

    words: str
    first_seed: int
    share: float
    draw: Callable[[int], World]

    def seeds(self, worlds: int) -> range:
        """Tell the seeds of its share of so many worlds, one at least."""
        return range(self.first_seed, self.first_seed + max(round(self.share * worlds), 1))


def _library_world(seed: int) -> World:
    return as_the_library(random_world(seed))


def _library_crowd(seed: int) -> World:
    return as_the_library(crowded_world(seed))


def _warm_world(seed: int) -> World:
    return as_warm_as_people(random_world(seed), rounded(stream(seed, "warm_world").uniform(*_WARM_AIR_C)))


KINDS: Final = (
    Kind("random worlds", 1000, 0.44, random_world),
    Kind("crowds", 2000, 0.1, crowded_world),
    Kind("worlds in the robot's own span", 3000, 0.3, _library_world),
    Kind("plain worlds as warm as people", 4000, 0.06, _warm_world),
    Kind("crowds in the robot's own span", 5000, 0.1, _library_crowd),
)

LATER: Final = 10_000
"""So many seeds after those of a kind there are more of it."""


def world_of(seed: int) -> World:
    """Draw the world of a seed; those below the first kind's are of that kind, too.

    Kinds come again every `LATER` seeds.
    """
    kind = next((kind for kind in reversed(KINDS) if seed % LATER >= kind.first_seed), KINDS[0])
    return kind.draw(seed)
