"""Safety of the robot in random worlds, with and without faults: `python -m benchmarks.reliability.safety`.

The robot follows people in random worlds, with a fault in every third of them. Only worlds in which it drives
at least 1 m count. Reported are contacts with their cause, the closest approach to a person, and how soon the
robot is at rest after a fault that blinds it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import Final, Literal, NamedTuple, get_args

import click
import numpy as np
from numpy.typing import NDArray

from benchmarks import call
from benchmarks.compare import compare, print_table, rows_of, update_results
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.scenario_file import Failure, FaultSpec
from peopleboy.scenarios.loop.faults import FaultySensors, FaultyTracker, active
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.loop.tracker_by_name import make_named_tracker
from peopleboy.scenarios.random_worlds.random_world import random_world
from peopleboy.scenarios.running.engine.task import ReportProgress, chosen_workers
from peopleboy.scenarios.scores.contacts import AT_REST_M_S, Contact, ContactLog
from peopleboy.sim.robot.robot_body import outline_gap
from peopleboy.sim.world import SimulatedWorld

Floats = NDArray[np.float64]

KINDS: Final[tuple[str, ...]] = get_args(Failure)
BLINDING: Final = (
    "camera_lost", "camera_frozen", "camera_black", "camera_saturated", "sonar_stuck", "tracker_raises",
)  # fmt: skip
"""Faults after which the robot must come to rest."""

OUT: Final = Path("runs/safety.json")
DRIVES_M: Final = 1.0
LASTS_S: Final = 5.0  # duration of a fault
_CARRIED_M: Final = 0.2  # farther than the robot drives within a frame
_APART_M: Final = 0.3  # half the width of a person, and more
SMALL: Final = {"width_px": 80, "height_px": 60}  # for true tracks, which need no image


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """One drive in a random world.

    Attributes:
        seed: seed of the world.
        fault: kind of its fault; empty for none.
        driven_m: [m] distance driven.
        fastest_s: [s] when it drove fastest, before the last `LASTS_S`.
        nearest_m: [m] smallest gap between the robot's outline and the middle of a person, see `Approach`.
        contacts: what the robot touched.
        speed_m_s: [m/s] speed when the fault began; NaN without a fault.
        stopping_s, stopping_m: [s], [m] from there until the robot was at rest; NaN if it was not within the
            fault's duration.
    """

    seed: int
    fault: str
    driven_m: float
    fastest_s: float
    nearest_m: float
    contacts: tuple[Contact, ...]
    speed_m_s: float = math.nan
    stopping_s: float = math.nan
    stopping_m: float = math.nan


@dataclass(frozen=True, slots=True)
class DriveTask:
    """Drive of one seed with one tracker."""

    seed: int
    tracker: str
    duration_s: float

    @property
    def name(self) -> str:
        """Name for messages."""
        return f"world {self.seed}, {self.tracker}"

    @property
    def size(self) -> int:
        """Number of worlds."""
        return 1

    def __call__(self, report_progress: ReportProgress) -> Drive | None:
        """Drive, and return what happened; None if the robot hardly drives."""
        drive = drive_of(self.seed, self.tracker, self.duration_s)
        report_progress(1)
        return drive


def drive_of(seed: int, tracker: str, duration_s: float) -> Drive | None:
    """Drive in the world of a seed, with its fault if it has one.

    A fault begins when the robot drives fastest, as an earlier drive without it shows.

    Returns:
        What happened; None if the robot drives less than `DRIVES_M` without a fault.
    """
    scenario = world_of(seed, tracker, duration_s)
    drive = drive_in(scenario, seed, tracker)
    if drive.driven_m < DRIVES_M:
        return None
    if fault := fault_of(seed):
        spec = FaultSpec(kind=fault, from_s=drive.fastest_s, lasts_s=LASTS_S)
        drive = drive_in(replace(scenario, spec=replace(scenario.spec, faults=(spec,))), seed, tracker)
    return drive


def fault_of(seed: int) -> Failure | Literal[""]:
    """Return the kind of fault in the world of a seed; empty in two of three."""
    return KINDS[seed // 3 % len(KINDS)] if seed % 3 == 0 else ""


def world_of(seed: int, tracker: str, duration_s: float) -> Scenario:
    """Sample a world in which the robot follows people."""
    data = random_world(seed, duration_s)
    data["robot"] = {key: data["robot"][key] for key in ("at_m", "heading_deg", "cameras")}
    data["robot"]["behaviour"], data["physics"] = "follow_person", "kinematic"
    if tracker == ORACLE:
        data["robot"]["cameras"] = {name: camera | SMALL for name, camera in data["robot"]["cameras"].items()}
    return parse_scenario(data, source=f"world {seed}", folder=Path())


def drive_in(scenario: Scenario, seed: int, name: str) -> Drive:
    """Let the robot drive in a scenario."""
    tracker = make_named_tracker(name, seed, lambda: world.truth())
    scenario, faults = scenario.mounting(tracker.cameras), scenario.spec.faults
    config, log, rows = scenario.world(seed, "raycast"), ContactLog(), []
    approach = Approach()
    with SimulatedWorld(config) as world:
        stage = FaultySensors(world, faults)
        frames = round(scenario.duration_s * config.control_hz)
        for tick in closed_loop(stage, FaultyTracker(tracker, faults), scenario.make_behaviour(), frames):
            truth = tick.truth
            log.add(truth)
            rows.append((truth.time_s, truth.robot.x, truth.robot.y, abs(truth.robot_velocity[0])))
            gaps_m = {one.name: outline_gap(truth.robot, one.position_m) for one in truth.people}
            approach.add(gaps_m)
    path = np.array(rows)
    driven = way_along(path[:, 1:3])
    early = path[: -round(LASTS_S * config.control_hz)]
    drive = Drive(
        seed=seed,
        fault=faults[0].kind if faults else "",
        driven_m=float(driven[-1]),
        fastest_s=float(early[np.argmax(early[:, 3]), 0]),
        nearest_m=approach.nearest_m,
        contacts=tuple(blamed(log.contacts, faults)),
    )
    if not faults:
        return drive
    stop = measure_stop(path[:, 0], path[:, 3], driven, faults[0])
    return replace(drive, speed_m_s=stop.speed_m_s, stopping_s=stop.after_s, stopping_m=stop.within_m)


@dataclass(slots=True)
class Approach:
    """Closest approach to people, instant by instant.

    A person who enters the world at the robot's place counts from when the two are apart.

    Attributes:
        nearest_m: [m] smallest gap; inf for none.
    """

    nearest_m: float = math.inf
    _apart: set[str] = field(default_factory=set)

    def add(self, gaps_m: Mapping[str, float]) -> None:
        """Add the gaps [m] to the people who are present, by name."""
        self._apart |= {name for name, gap_m in gaps_m.items() if gap_m > _APART_M}
        self.nearest_m = min([self.nearest_m, *(gaps_m[name] for name in gaps_m if name in self._apart)])


def way_along(positions: Floats) -> Floats:
    """Return the distance (T,) [m] driven until each of some positions (T, 2); being carried is none."""
    steps = np.hypot(*np.diff(positions, axis=0).T)
    return np.concatenate([[0.0], np.cumsum(np.where(steps < _CARRIED_M, steps, 0.0))])


def blamed(contacts: Sequence[Contact], faults: Sequence[FaultSpec]) -> list[Contact]:
    """Return contacts of which those while the robot is pushed are caused by the person who pushes it."""
    pushes = [fault for fault in faults if fault.kind == "robot_pushed"]
    return [
        replace(contact, cause="person") if active(pushes, contact.time_s) else contact
        for contact in contacts
    ]


class Stop(NamedTuple):
    """A stop after the beginning of a fault.

    Attributes:
        speed_m_s: [m/s] speed when the fault began.
        after_s, within_m: [s], [m] from there until the robot was at rest; NaN if it was not within the
            fault's duration.
    """

    speed_m_s: float
    after_s: float = math.nan
    within_m: float = math.nan


def measure_stop(time_s: Floats, speed_m_s: Floats, driven_m: Floats, fault: FaultSpec) -> Stop:
    """Measure how soon a robot is at rest after a fault begins.

    Args:
        time_s: (T,) [s] times of the frames.
        speed_m_s: (T,) [m/s] absolute speeds.
        driven_m: (T,) [m] distances driven.
        fault: the fault.
    """
    first = int(np.argmax(time_s >= fault.from_s - 1e-6))
    is_during = time_s[first:] < fault.from_s + (fault.lasts_s or math.inf)
    stop = Stop(float(speed_m_s[first]))
    at_rest = np.flatnonzero(is_during & (speed_m_s[first:] < AT_REST_M_S))
    if not len(at_rest):
        return stop
    end = first + int(at_rest[0])
    # Between two frames the speed falls evenly, or faster at the end.
    fall = speed_m_s[end - 1] - speed_m_s[end]
    early_s = (time_s[end] - time_s[end - 1]) * (AT_REST_M_S - speed_m_s[end]) / fall if end > first else 0.0
    after_s = float(time_s[end] - time_s[first] - early_s)
    return stop._replace(after_s=after_s, within_m=float(driven_m[end] - driven_m[first]))


def groups_of(drives: Sequence[Drive]) -> dict[str, list[Drive]]:
    """Return the drives without a fault, with one that blinds the robot, with any other, and of each kind."""
    groups: dict[str, list[Drive]] = {"none": [], "blinding": [], "other": []}
    for drive in drives:
        group = "blinding" if drive.fault in BLINDING else "other" if drive.fault else "none"
        groups[group].append(drive)
        if drive.fault:
            groups.setdefault(drive.fault, []).append(drive)
    return {name: own for name, own in groups.items() if own}


def summarise(drives: Sequence[Drive]) -> dict[str, float | None]:
    """Return the results of some drives by the titles of `COLUMNS`; None where there are none."""
    touched = [contact for drive in drives for contact in drive.contacts]
    by_robot = [contact for contact in touched if contact.cause == "robot"]
    moving = [drive for drive in drives if drive.speed_m_s > AT_REST_M_S]
    stops = [drive for drive in moving if not math.isnan(drive.stopping_s)]
    return {
        "runs": len(drives),
        "driven": sum(drive.driven_m for drive in drives),
        "by robot": len(by_robot),
        "fastest": max((contact.robot_m_s for contact in by_robot), default=None),
        "by person": len(touched) - len(by_robot),
        "relative": max((contact.relative_m_s for contact in touched), default=None),
        "nearest": min(drive.nearest_m for drive in drives),
        "driving": len(moving),
        "at rest": len(stops),
        "after": max((drive.stopping_s for drive in stops), default=None),
        "within": max((drive.stopping_m for drive in stops), default=None),
    }


COLUMNS: Final[Mapping[str, str]] = {
    "runs": "{}", "driven": "{:.0f} m", "by robot": "{}", "fastest": "{:.2f} m/s", "by person": "{}",
    "relative": "{:.2f} m/s", "nearest": "{:.2f} m", "driving": "{}", "at rest": "{}", "after": "{:.2f} s",
    "within": "{:.2f} m",
}  # fmt: skip
"""Columns of the table, with the format of their values."""


def failures_in(drives: Sequence[Drive]) -> list[str]:
    """Return what is unsafe: a contact that the robot caused at speed, or no rest after a blinding fault."""
    found = [
        f"world {drive.seed} ({drive.fault or 'no fault'}): hits {contact.other} at {contact.robot_m_s} m/s"
        for drive in drives
        for contact in drive.contacts
        if contact.cause == "robot" and contact.robot_m_s > AT_REST_M_S
    ]
    return found + [
        f"world {drive.seed} ({drive.fault}): not at rest, from {drive.speed_m_s:.2f} m/s"
        for drive in drives
        if drive.fault in BLINDING and drive.speed_m_s > AT_REST_M_S and math.isnan(drive.stopping_s)
    ]


@click.command()
@click.option(
    "--worlds", type=click.IntRange(min=1, max=10_000), default=200, help="worlds in which it drives"
)
@click.option("--first", type=click.IntRange(min=0), default=0, help="first seed")
@click.option(
    "--duration", type=click.FloatRange(min=10.0, max=600.0), default=30.0, help="length of a drive [s]"
)
@click.option("--tracker", "trackers", multiple=True, default=("detection", ORACLE), show_default=True)
@click.option("--workers", type=click.IntRange(min=1), default=None, help="processes; default one per core")
def main(worlds: int, first: int, duration: float, trackers: tuple[str, ...], workers: int | None) -> None:
    """Drive in random worlds with each tracker; print contacts, closest approach and stops.

    The results are also written to runs/safety.json.
    """
    unsafe, found_by = [], {}
    for tracker in trackers:
        drives: list[Drive] = []
        seed = first
        while len(drives) < worlds and seed < first + 20 * worlds:
            tasks = [DriveTask(each, tracker, duration) for each in range(seed, seed + worlds - len(drives))]
            seed += len(tasks)
            (more,) = compare({tracker: tasks}, chosen_workers(workers, None), tracker).values()
            drives += [drive for drive in more if drive is not None]
        drives = list(islice(drives, worlds))
        click.echo(
            f"Tracker {tracker}: {len(drives)} worlds with {DRIVES_M:g} m of travel in {seed - first} seeds."
        )
        found_by[tracker] = {name: summarise(own) for name, own in groups_of(drives).items()}
        print_table(("fault", *COLUMNS), rows_of(found_by[tracker], COLUMNS), width=200)
        unsafe += [f"{tracker}: {line}" for line in failures_in(drives)]
    update_results(OUT, found_by)
    for line in unsafe:
        click.echo(line)
    if unsafe:
        raise SystemExit(1)


if __name__ == "__main__":
    call(main, "benchmarks.reliability.safety")
