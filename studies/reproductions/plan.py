"""Plan the extent of a run: everything, or a small part in a few minutes."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.suite import SuiteRun, load_suite, runs_of

DATASETS = ("dataset1", "dataset2", "dataset3", "dataset4")
TRAINING = "training films"
"""Clips of dataset1's scenario with other seeds, used to choose the readings of the literal tracker."""
WITH_MONITOR = "dataset1 with a monitor"
"""Dataset1 with a warm monitor of the size of a head in view."""
_TRAINING_SEEDS = (100, 101)
SEQUENCES: Final[Mapping[str, str]] = {
    **{f"s1r{k}": f"bears_{k}" for k in range(1, 7)},
    **{f"s2r{k}": f"chairs_{k}" for k in (1, 2)},
    **{f"s3r{k}": f"tidying_{k}" for k in (1, 2)},
    **{f"s4r{k}": f"doors_{k}" for k in range(1, 5)},
    **{f"s5r{k}": f"cans_{k}" for k in (1, 2)},
    "s6r1": "plants_1",
}
"""Scenarios that replace the sequences of the thesis on situation awareness, chapter 3, by its names."""
PRESETS: Final = ("tof", "kinect", "kinect_rough")
"""Depth cameras of the sequences."""
REPEATS = 10
"""Number of repeats in the sources."""
QUICK_S = 20.0
"""Length of a data set's run in a quick run [s]."""
WHOLE_S = 3600.0
"""Longer than any drive [s]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plan:
    """Extent of a run.

    Attributes:
        cache: folder of rendered frames.
        suites: runs by name of their data set.
        further: runs by name that are no data sets: `TRAINING` and `WITH_MONITOR`.
        repeats: random streams per tracker.
        is_quick: whether sweeps take fewer values.
        pair_seeds: seeds per scenario for samples of overlapping people.
        splits: number of splits of samples into training and test.
        triplets: whether weighted triplets are included, which take minutes.
        rounds: rounds of boosting.
        timing_steps: number of timings of each step in each turn.
        walks: seeds of each room in which people walk around a panoramic camera.
        sets: numbers of the drives with a depth camera, from 1.
        drives: seeds of each drive.
        ablated: seeds of each drive for trackers that differ in one setting.
        drive_s: [s] maximum length of drives.
        scenes: names of the sequences with moved objects.
        scene_seeds: seeds of each sequence.
        presets: depth cameras of the sequences.
        absences: seeds of each scenario in which a person leaves and comes back.
        follows: seeds of runs in which the robot follows such a person.
        label_noise_px: [px] standard deviation of noise at the edges of ground-truth boxes.
    """

    cache: Path
    suites: Mapping[str, Sequence[SuiteRun]] = field(default_factory=dict)
    further: Mapping[str, Sequence[SuiteRun]] = field(default_factory=dict)
    repeats: int = 10
    is_quick: bool = False
    pair_seeds: int = 10
    splits: int = 10
    triplets: bool = True
    rounds: int = 40
    timing_steps: int = 40
    walks: int = 10
    sets: tuple[int, ...] = tuple(range(1, 13))
    drives: int = 5
    ablated: int = 2
    drive_s: float = WHOLE_S
    scenes: tuple[str, ...] = tuple(SEQUENCES)
    scene_seeds: int = 5
    presets: tuple[str, ...] = PRESETS
    absences: int = 10
    follows: int = 20
    label_noise_px: float = 0.0

    def runs(self, suites: Iterable[str]) -> list[SuiteRun]:
        """Return the runs of data sets, one after the other."""
        known = {**self.suites, **self.further}
        return [run for name in suites for run in known[name]]

    def repeated(self, repeats: int) -> "Plan":
        """Return a full plan with a number of repeats; counts below the sources' ten stay as they are."""
        return replace(
            self,
            repeats=repeats,
            pair_seeds=repeats,
            walks=repeats,
            drives=min(repeats, 5),
            ablated=min(repeats, 2),
            scene_seeds=min(repeats, 5),
            absences=repeats,
            follows=2 * repeats,
        )


def full_plan(cache: Path, repeats: int = REPEATS) -> Plan:
    """Return the plan of a full run, with the sources' number of repeats or seeds."""
    suites = {name: tuple(runs_of(load_suite(name))) for name in DATASETS}
    return Plan(cache=cache, suites=suites, further=_further(suites)).repeated(repeats)


def quick_plan(cache: Path) -> Plan:
    """Return the plan of a quick run: the start of one run per data set, three repeats, fewer values."""
    suites = {name: (_middle_run(name),) for name in DATASETS}
    return Plan(
        cache=cache,
        suites=suites,
        further=_further(suites),
        repeats=3,
        is_quick=True,
        pair_seeds=1,
        splits=3,
        triplets=False,
        rounds=20,
        timing_steps=20,
        walks=2,
        sets=(2, 7, 11),
        drives=1,
        ablated=1,
        drive_s=10.0,
        scenes=("s1r1", "s2r1", "s4r1"),
        scene_seeds=1,
        presets=PRESETS[:2],
        absences=1,
        follows=1,
    )


def shortened(name: str, most_s: float) -> Scenario:
    """Load a scenario of the library, with a maximum duration [s]."""
    scenario = load_scenario(name)
    return scenario.lasting(min(scenario.duration_s, most_s))


def _further(suites: Mapping[str, Sequence[SuiteRun]]) -> dict[str, tuple[SuiteRun, ...]]:
    runs = suites[DATASETS[0]]
    monitor = load_scenario("passers_by_monitor").lasting(runs[0].scenario.duration_s)
    return {
        TRAINING: tuple(SuiteRun(runs[0].scenario, seed) for seed in _TRAINING_SEEDS),
        WITH_MONITOR: tuple(SuiteRun(monitor, run.seed) for run in runs),
    }


def _middle_run(name: str) -> SuiteRun:
    runs = list(runs_of(load_suite(name)))
    middle = runs[len(runs) // 2]
    return SuiteRun(middle.scenario.lasting(min(QUICK_S, middle.scenario.duration_s)), middle.seed)
