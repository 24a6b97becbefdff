"""What the data sets hold: the thesis's table 3.1."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from peopleboy.scenarios.scores.suite_table import Content, add_up
from peopleboy.studies.reproductions.experiments.experiment import Chart, Done, Line, Samples, missing
from peopleboy.studies.reproductions.measuring.units import FilmUnit, Unit
from peopleboy.studies.reproductions.measuring.workload import Plan

COLUMNS = {
    "frames_with_persons": "frames with persons",
    "frames": "frames",
    "tracks": "tracks",
    "detections": "detections",
    "occlusions": "occlusions",
    "at_once": "persons at once",
}


@dataclass(frozen=True, slots=True)
class Contents:
    """Counts of frames, tracks, detections and occlusions, data set by data set."""

    id: str = "table-3.1"
    chart: Chart = "none"
    plotted: tuple[str, ...] = ()

    def wants(self, plan: Plan, done: Done) -> list[Unit]:
        """Every film is counted when it is made."""
        return missing([unit for name in plan.suites for unit in films(plan, name)], done)

    def samples(self, plan: Plan, done: Done) -> Samples:
        """Add up the films of each data set."""
        result = {}
        for name in plan.suites:
            total = asdict(add_up(Content(**done[unit.key]) for unit in films(plan, name)))
            result[Line(name, "simulated")] = {COLUMNS[key]: np.array([float(total[key])]) for key in COLUMNS}
        return result


def films(plan: Plan, suite: str) -> list[FilmUnit]:
    """List the films of a data set."""
    return [FilmUnit(play, plan.cache) for play in plan.suites[suite]]
