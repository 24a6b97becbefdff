"""Filming one scene as a task, which leaves a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import yaml

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.run_folder.atomic_output import atomic
from peopleboy.scenarios.running.engine.task import Tell
from peopleboy.studies.training.foreground_learning.masked_film import film_people
from peopleboy.studies.training.foreground_learning.random_scene import random_scene


@dataclass(frozen=True, slots=True)
class FilmTask:
    """Draw the scene of a seed, and film it.

    Attributes:
        folder: of scenes and films.
        seed: of the scene and of its run.
    """

    folder: str
    seed: int
    size: int = 1

    @property
    def name(self) -> str:
        """Which scene."""
        return f"scene_{self.seed}"

    @property
    def film(self) -> Path:
        """File of the film."""
        return Path(self.folder) / f"{self.name}.npz"

    def __call__(self, tell: Tell) -> None:  # noqa: ARG002
        """Film it, and leave its scenario beside the film."""
        path = self.film.with_suffix(".yaml")
        with atomic(path) as part:
            part.write_text(yaml.safe_dump(random_scene(self.seed), sort_keys=False), encoding="utf-8")
        film_people(load_scenario(path), self.seed).save(self.film)
