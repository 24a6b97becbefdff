"""How exact the external measurement of the 2003 paper is, and the angles that were held against it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass

import numpy as np

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.studies.reproductions.experiments.distances import ROOMS, examples_of, walks
from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.units import Unit
from peopleboy.studies.reproductions.measuring.workload import Plan
from peopleboy.studies.training.distance_learning.image_errors import ErrorSummary, ImageErrors

CM, DEGREES = "cm", "deg"

ANGLE = "angle of the person"
_ANGLES = {
    "against the truth": "panorama_truth",
    "against webcams, all at once": "panorama_at_once",
    "against webcams up to 0.2 s apart": "panorama_skewed",
    "against webcams all 0.2 s late": "panorama_late",
}
_LINES = {
    "known places": ("in_sample_m", None),
    "other places": ("new_m", None),
    "walking": ("walking_m", "bearing_deg"),
    "walking, webcams up to 0.2 s apart": ("skewed_m", "skewed_bearing_deg"),
}


@dataclass(frozen=True, slots=True)
class WebcamUnit:
    """The measurement once, with another seed each time."""

    seed: int
    is_timing: bool = False

    @property
    def key(self) -> str:
        """The seed."""
        return f"webcams | {self.seed}"

    def run(self) -> Result:
        """Play and measure."""
        from peopleboy.studies.reproductions.evaluations.webcam_positions import (
            measure_webcams,  # here, as it needs PyBullet
        )

        return asdict(measure_webcams(self.seed))


@dataclass(frozen=True, slots=True)
class Webcams:
    """Errors of the places [cm], and of the bearing from the robot [deg], one figure a seed."""

    id: str = "panoramic-webcams"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Each seed is one piece of work."""
        return missing(_units(plan), done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the errors, line by line."""
        found = [done[unit.key] for unit in _units(plan)]
        return {
            Line(group, "default"): {
                CM: np.array([100.0 * one[place] for one in found]),
                **({DEGREES: np.array([one[angle] for one in found])} if angle else {}),
            }
            for group, (place, angle) in _LINES.items()
        }


@dataclass(frozen=True, slots=True)
class Angles:
    """Errors of the angle that the panorama tells [deg], by what they are held against."""

    id: str = "panoramic-angle"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """The films of the rooms, and those with webcams."""
        films = [walk for room in ROOMS for walk in walks(plan, room)]
        return [*missing(films, done), *missing(_units(plan), done)]

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the errors, the rooms first."""
        found = {}
        for room in ROOMS:
            degrees = (np.degrees(run.angle_error_rad) for run in examples_of(plan, done, room))
            found[Line(ANGLE, f"{room}, against the truth")] = _films(map(ErrorSummary.of, degrees))
        for name, key in _ANGLES.items():
            kept = (ErrorSummary(**done[unit.key][key]) for unit in _units(plan))
            found[Line(ANGLE, f"corner_webcams, {name}")] = _films(kept)
        return {line: {DEGREES: errors} for line, errors in found.items()}


def _units(plan: Plan) -> list[WebcamUnit]:
    return [WebcamUnit(seed) for seed in range(plan.repeats)]


def _films(films: Iterable[ErrorSummary]) -> ImageErrors:
    return ImageErrors.joined(ImageErrors(splits=(film,)) for film in films)
