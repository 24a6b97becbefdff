"""Examples of one film as a task, which leaves a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.loop.calibrations import calibrations_of
from peopleboy.scenarios.running.engine.task import Tell
from peopleboy.studies.training.foreground_learning.film_task import FilmTask
from peopleboy.studies.training.foreground_learning.masked_film import MaskedFilm, film_people
from peopleboy.studies.training.place_learning.place_examples import examples_of
from peopleboy.tracker.frame import PANORAMA
from peopleboy.tracker.panorama_calibration import PanoramaCalibration


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaceTask:
    """Film a scene, and keep examples of it.

    Attributes:
        films: folder of films of scenes drawn at random, which are kept.
        examples: folder of the examples.
        scenario: of the library; empty for a scene drawn at random.
        seed: of scene and run.
    """

    films: str
    examples: str
    scenario: str = ""
    seed: int
    size: int = 1

    @property
    def name(self) -> str:
        """Which scene."""
        return f"{self.scenario or 'scene'}_{self.seed}"

    @property
    def path(self) -> Path:
        """File of the examples."""
        return Path(self.examples) / f"{self.name}.npz"

    def __call__(self, tell: Tell) -> None:
        """Collect them."""
        film, scenario = self._filmed(tell)
        calibration = panorama_of(scenario, self.seed)
        examples_of(film, calibration, self.seed).save(self.path)

    def _filmed(self, tell: Tell) -> tuple[MaskedFilm, Scenario]:
        """Film the scene, unless its film is there."""
        if self.scenario:
            scenario = load_scenario(self.scenario)
            return film_people(scenario, self.seed), scenario
        task = FilmTask(self.films, self.seed)
        if not task.film.is_file():
            task(tell)
        return MaskedFilm.load(task.film), load_scenario(task.film.with_suffix(".yaml"))


def panorama_of(scenario: Scenario, seed: int) -> PanoramaCalibration:
    """Give the calibration of a scenario's panoramic camera."""
    cameras = scenario.mounting((PANORAMA,)).world(seed).robot.cameras
    calibration = calibrations_of(cameras)[PANORAMA]
    if not isinstance(calibration, PanoramaCalibration):
        raise TypeError(f"{scenario.name}: camera {PANORAMA} is no panoramic one")
    return calibration
