"""How exact the external measurement of the 2003 paper is, which the paper knew only where it was fitted."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.studies.reproduce.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.scenarios.studies.reproduce.measuring.units import Unit
from peopleboy.scenarios.studies.reproduce.measuring.workload import Plan

CM, DEGREES = "cm", "deg"

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
        from peopleboy.scenarios.studies.webcams.measure import measure_webcams  # here, as it needs PyBullet

        return asdict(measure_webcams(self.seed))


@dataclass(frozen=True, slots=True)
class Webcams:
    """Errors of the places [cm], and of the bearing from the robot [deg], one figure a seed."""

    id: str = "panoramic-webcams"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Each seed is one piece of work."""
        return missing([WebcamUnit(seed) for seed in range(plan.repeats)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Give the errors, line by line."""
        found = [done[WebcamUnit(seed).key] for seed in range(plan.repeats)]
        return {
            Line(group, "default"): {
                CM: np.array([100.0 * one[place] for one in found]),
                **({DEGREES: np.array([one[angle] for one in found])} if angle else {}),
            }
            for group, (place, angle) in _LINES.items()
        }
