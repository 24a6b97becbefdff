"""Filming a random world for the detector, as a task, which leaves a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.random_worlds.random_world import random_world
from peopleboy.scenarios.running.engine.task import Tell
from peopleboy.scenarios.studies.people_learning.people_film import film_upright

_OWN_EVERY: Final = 3
"""Of so many worlds one is seen as the robot's own camera sees the library."""

_WARMEST_C: Final = 25.0
_SURFACES: Final = ("walls_c", "floor_c", "ceiling_c", "surroundings_c", "air_c")
_OF_CAMERA: Final = ("kind", "mount_m", "pitch_deg", "vertical_fov_deg")


@dataclass(frozen=True, slots=True)
class PeopleFilmTask:
    """Draw the world of a seed, and film it.

    Attributes:
        folder: of the films.
        seed: of the world and of its run.
    """

    folder: str
    seed: int
    size: int = 1

    @property
    def name(self) -> str:
        """Which world."""
        return f"world_{self.seed}"

    @property
    def film(self) -> Path:
        """File of the film."""
        return Path(self.folder) / f"{self.name}.npz"

    @property
    def is_own(self) -> bool:
        """Whether it is seen in the span of the robot's own camera."""
        return self.seed % _OWN_EVERY == 0

    def __call__(self, tell: Tell) -> None:  # noqa: ARG002
        """Film it."""
        film_upright(self._scenario(), self.seed).save(self.film)

    def _scenario(self) -> Scenario:
        world = random_world(self.seed)
        if self.is_own:
            world = as_the_library(world)
        return parse_scenario(world, source=self.name, folder=Path())


def as_the_library(world: dict[str, Any]) -> dict[str, Any]:
    """Give a world without the details, in a span of 24..36 degC: most of it is black."""
    place = {key: value for key, value in world["place"].items() if key != "sun"}
    warmth = place.get("temperatures", {})
    if max((warmth.get(surface, 0.0) for surface in _SURFACES), default=0.0) > _WARMEST_C:
        del place["temperatures"]
    cameras = world["robot"]["cameras"]
    own = {key: value for key, value in cameras["thermal"].items() if key in _OF_CAMERA}
    robot = world["robot"] | {"cameras": cameras | {"thermal": own}}
    return world | {"detail": "plain", "place": place, "robot": robot}
