"""How much is measured: everything, or a little in a few minutes."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.suite import SuiteRun, load_suite, runs_of

DATASETS = ("dataset1", "dataset2", "dataset3", "dataset4")
TRAINING = "training films"
"""Of the scenario of dataset1, with other seeds: by these the literal tracker's readings were chosen."""
_TRAINING_SEEDS = (100, 101)
SEQUENCES: Final[Mapping[str, str]] = {
    **{f"s1r{k}": f"bears_{k}" for k in range(1, 7)},
    **{f"s2r{k}": f"chairs_{k}" for k in (1, 2)},
    **{f"s3r{k}": f"tidying_{k}" for k in (1, 2)},
    **{f"s4r{k}": f"doors_{k}" for k in range(1, 5)},
    **{f"s5r{k}": f"cans_{k}" for k in (1, 2)},
    "s6r1": "plants_1",
}
"""Scenarios that stand for the sequences of the thesis on situation awareness, chapter 3, by its names."""
PRESETS: Final = ("tof", "kinect", "kinect_rough")
"""Depth cameras that record them."""
REPEATS = 10
"""How often the sources repeat everything."""
QUICK_S = 20.0
"""How much a quick run sees of a data set's run [s]."""
WHOLE_S = 3600.0
"""Longer than any drive [s]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plan:
    """How much of everything.

    Attributes:
        cache: where rendered frames are kept.
        suites: runs by the name of their data set.
        training: runs apart from those, by which readings were chosen.
        repeats: random streams per tracker.
        is_quick: whether sweeps take fewer values.
        pair_seeds: seeds per scenario from which examples of overlapping people are taken.
        splits: of examples into those to learn from and those to test with.
        triplets: whether weighted triplets are tried, which take minutes.
        rounds: of boosting.
        timing_steps: how often each step is timed in each turn.
        walks: seeds of each room in which people walk before a panoramic camera.
        sets: numbers of the drives with a depth camera, from 1.
        drives: seeds of each of them.
        ablated: seeds of those on which trackers are compared that differ in one thing.
        drive_s: [s] after which drives are cut.
        scenes: names of the sequences in which objects are moved.
        scene_seeds: seeds of each of them.
        presets: depth cameras that watch them.
        absences: seeds of each scenario in which a person goes away and comes back.
        follows: seeds of runs in which the robot follows such a person.
    """

    cache: Path
    suites: Mapping[str, Sequence[SuiteRun]] = field(default_factory=dict)
    training: Sequence[SuiteRun] = ()
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

    def runs(self, suites: Iterable[str]) -> list[SuiteRun]:
        """Return the runs of data sets, one after the other."""
        return [run for name in suites for run in (self.training if name == TRAINING else self.suites[name])]

    def repeated(self, repeats: int) -> "Plan":
        """Return a full plan with as many repeats; what is smaller than the sources' ten stays as small."""
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
    """Plan everything, as the sources did it, with as many repeats, or seeds where those are repeated."""
    suites = {name: tuple(runs_of(load_suite(name))) for name in DATASETS}
    return Plan(cache=cache, suites=suites, training=_training(suites)).repeated(repeats)


def quick_plan(cache: Path) -> Plan:
    """Plan a little of everything: the start of one run per data set, three repeats, fewer values."""
    suites = {name: (_middle_run(name),) for name in DATASETS}
    return Plan(
        cache=cache,
        suites=suites,
        training=_training(suites),
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
    """Load a scenario of the library, and cut it where it would be longer [s]."""
    scenario = load_scenario(name)
    return scenario.lasting(min(scenario.duration_s, most_s))


def _training(suites: Mapping[str, Sequence[SuiteRun]]) -> tuple[SuiteRun, ...]:
    scenario = suites[DATASETS[0]][0].scenario
    return tuple(SuiteRun(scenario, seed) for seed in _TRAINING_SEEDS)


def _middle_run(name: str) -> SuiteRun:
    runs = list(runs_of(load_suite(name)))
    middle = runs[len(runs) // 2]
    return SuiteRun(middle.scenario.lasting(min(QUICK_S, middle.scenario.duration_s)), middle.seed)
