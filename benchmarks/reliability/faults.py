"""Effect of every kind of fault on tracking and following: `python -m benchmarks.reliability.faults`.

The robot follows a person in three scenarios, with several seeds each, once without a fault and once with
each kind. Reported are HOTA, the share of the time in which the person is tracked, the distance error, how
soon the robot is at rest, and how soon it follows the person again after the end of the fault.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

import click
import numpy as np

from benchmarks import call
from benchmarks.compare import compare, print_table, rows_of, update_results
from benchmarks.reliability.safety import KINDS, Stop, measure_stop, way_along
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.running.engine.task import ReportProgress, chosen_workers
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.contacts import AT_REST_M_S
from peopleboy.scenarios.scores.following_metrics import FollowingScore, tracks_on_target
from peopleboy.tracker.evaluation.evaluate import Scores, combine

SCENARIOS: Final = ("follow_passers_by", "follow_occluded", "follow_round_corner")
DURATION_S: Final = 20.0
FROM_S, LASTS_S = 10.0, 3.0  # the robot drives then, in all three scenarios

FAULTS: Final[Mapping[str, Mapping[str, Any]]] = {
    "none": {},
    **{kind: {"kind": kind} for kind in KINDS},
    "camera_lost, thermal": {"kind": "camera_lost", "camera": "thermal"},
    "camera_lost, colour": {"kind": "camera_lost", "camera": "colour"},
    "sonar_maximum, one": {"kind": "sonar_maximum", "sonar": 3},
    "sonar_stuck, one": {"kind": "sonar_stuck", "sonar": 3},
}
"""Faults of all cameras and all sonars, and of one of them, by name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FaultRun:
    """Results of one run with a fault.

    Attributes:
        people: scores of the tracker.
        following: scores of the behaviour.
        contacts: number of contacts that the robot caused.
        stop: stop after the beginning of the fault.
        recovered_s: [s] from the end of the fault until the robot follows the right person; NaN if never.
    """

    people: Scores
    following: FollowingScore
    contacts: int
    stop: Stop
    recovered_s: float


@dataclass(slots=True)
class DriveWatch:
    """Collects time, speed, position, and whether the robot follows the right person, tick by tick."""

    rows: list[tuple[float, float, float, float, bool]] = field(default_factory=list)
    _track: int = 0

    def __call__(self, tick: Tick, _frames: int) -> None:
        """Add a tick."""
        track, _ = tracks_on_target(tick, before=self._track)
        self._track = track or self._track
        truth = tick.truth
        follows = track > 0 and tick.following == track
        self.rows.append((truth.time_s, abs(truth.robot_velocity[0]), truth.robot.x, truth.robot.y, follows))


@dataclass(frozen=True, slots=True)
class FaultTask:
    """Run of a scenario with a fault."""

    fault: str
    scenario: str
    seed: int
    tracker: str

    @property
    def name(self) -> str:
        """Name for messages."""
        return f"{self.fault}, {self.scenario}, seed {self.seed}"

    @property
    def size(self) -> int:
        """Number of runs."""
        return 1

    def __call__(self, report_progress: ReportProgress) -> FaultRun:
        """Run the scenario, and return the results."""
        scenario = load_scenario(self.scenario).lasting(DURATION_S)
        found = run_with(self.fault, scenario, self.seed, self.tracker)
        report_progress(1)
        return found


def run_with(fault: str, scenario: Scenario, seed: int, tracker: str) -> FaultRun:
    """Run a scenario with a fault of `FAULTS`."""
    settings = FAULTS[fault]
    spec = FaultSpec(from_s=FROM_S, lasts_s=LASTS_S, **(settings or {"kind": "camera_lost"}))
    faults = (spec,) if settings else ()
    scenario = replace(scenario, spec=replace(scenario.spec, faults=faults))
    watch = DriveWatch()
    with TemporaryDirectory() as folder:
        options = RunOptions(
            seed=seed, out=Path(folder) / "run", tracker=tracker, physics="kinematic", record=False
        )
        scores = run(scenario, options, watch)
    assert scores.drive.following is not None  # all scenarios are of following
    time_s, speed_m_s, x_m, y_m, follows = np.array(watch.rows).T
    driven_m = way_along(np.stack([x_m, y_m], axis=1))
    again = time_s[(time_s >= FROM_S + LASTS_S - 1e-6) & (follows > 0.0)]
    return FaultRun(
        people=scores.people,
        following=scores.drive.following,
        contacts=sum(contact.cause == "robot" for contact in scores.contacts),
        stop=measure_stop(time_s, speed_m_s, driven_m, spec),
        recovered_s=float(again[0]) - FROM_S - LASTS_S if len(again) else math.nan,
    )


def summarise(runs: Sequence[FaultRun], sound: Sequence[FaultRun]) -> dict[str, float | None]:
    """Return the results of the runs with a fault by the titles of `COLUMNS`; None where there are none.

    Args:
        runs: runs with the fault.
        sound: runs of the same scenarios and seeds without a fault.
    """
    hota, sound_hota = (combine([one.people for one in each]).mot.hota.hota for each in (runs, sound))
    moving = [one.stop for one in runs if one.stop.speed_m_s > AT_REST_M_S]
    stops_s = [stop.after_s for stop in moving if not math.isnan(stop.after_s)]
    again_s = [one.recovered_s for one in runs if not math.isnan(one.recovered_s)]
    return {
        "runs": len(runs),
        "HOTA": hota,
        "change": hota - sound_hota if runs is not sound else None,
        "tracked": 100.0 * float(np.nanmean([one.following.followed for one in runs])),
        "distance error": float(np.nanmean([one.following.mean_distance_error_m for one in runs])),
        "stops": 100.0 * len(stops_s) / len(moving) if moving else None,
        "median stop": float(np.median(stops_s)) if stops_s else None,
        "latest stop": max(stops_s, default=None),
        "recover": 100.0 * len(again_s) / len(runs),
        "median recovery": float(np.median(again_s)) if again_s else None,
        "contacts": sum(one.contacts for one in runs),
    }


COLUMNS: Final[Mapping[str, str]] = {
    "runs": "{}", "HOTA": "{:.1f}", "change": "{:+.1f}", "tracked": "{:.1f} %", "distance error": "{:.2f} m",
    "stops": "{:.0f} %", "median stop": "{:.2f} s", "latest stop": "{:.2f} s", "recover": "{:.0f} %",
    "median recovery": "{:.1f} s", "contacts": "{}",
}  # fmt: skip
"""Columns of the table, with the format of their values."""


@click.command()
@click.option("--seeds", type=click.IntRange(min=1, max=1000), default=10, help="seeds of each scenario")
@click.option("--tracker", default="detection", show_default=True)
@click.option("--fault", "names", multiple=True, type=click.Choice(list(FAULTS)), help="default: all")
@click.option("--workers", type=click.IntRange(min=1), default=None, help="processes; default one per core")
def main(seeds: int, tracker: str, names: tuple[str, ...], workers: int | None) -> None:
    """Run with each fault and without; print the effect, and write it to runs/faults-TRACKER.json."""
    tasks = {
        name: [FaultTask(name, scenario, seed, tracker) for scenario in SCENARIOS for seed in range(seeds)]
        for name in dict.fromkeys(("none", *(names or FAULTS)))
    }
    runs = compare(tasks, chosen_workers(workers, None), tracker)
    found = {name: summarise(own, runs["none"]) for name, own in runs.items()}
    print_table(("fault", *COLUMNS), rows_of(found, COLUMNS), width=200)
    update_results(Path(f"runs/faults-{tracker}.json"), found)


if __name__ == "__main__":
    call(main, "benchmarks.reliability.faults")
