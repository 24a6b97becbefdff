"""Filming a random world for the detector, as a task, which leaves a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.running.engine.task import Tell
from peopleboy.studies.training.people_learning.people_film import film_upright
from peopleboy.studies.training.people_learning.worlds_to_learn_from import world_of


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

    def __call__(self, tell: Tell) -> None:  # noqa: ARG002
        """Film it."""
        film_upright(self._scenario(), self.seed).save(self.film)

    def _scenario(self) -> Scenario:
        return parse_scenario(world_of(self.seed), source=self.name, folder=Path())
