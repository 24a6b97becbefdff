"""Examples of one film as a task, which leaves a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.running.engine.task import Tell
from peopleboy.scenarios.studies.foreground_learning.film_task import FilmTask
from peopleboy.scenarios.studies.foreground_learning.masked_film import PANORAMA, MaskedFilm
from peopleboy.scenarios.studies.place_learning.place_examples import examples_of
from peopleboy.tracker.panorama_calibration import PanoramaCalibration


@dataclass(frozen=True, slots=True)
class PlaceTask:
    """Film a scene drawn at random unless it is there, and keep examples of it.

    Attributes:
        films, examples: folders.
        seed: of the scene.
    """

    films: str
    examples: str
    seed: int
    size: int = 1

    @property
    def name(self) -> str:
        """Which scene."""
        return f"scene_{self.seed}"

    @property
    def path(self) -> Path:
        """File of the examples."""
        return Path(self.examples) / f"{self.name}.npz"

    def __call__(self, tell: Tell) -> None:
        """Collect them."""
        task = FilmTask(self.films, self.seed)
        if not task.film.is_file():
            task(tell)
        calibration = calibration_of_film(task)
        examples_of(MaskedFilm.load(task.film), calibration, self.seed).save(self.path)


def calibration_of_film(task: FilmTask) -> PanoramaCalibration:
    """Give the calibration of the camera that a film is taken with."""
    scenario = load_scenario(task.film.with_suffix(".yaml"))
    calibration = calibrations_of(scenario.world(task.seed).robot.cameras)[PANORAMA]
    if not isinstance(calibration, PanoramaCalibration):
        raise TypeError(f"{task.name}: camera {PANORAMA} is no panoramic one")
    return calibration
