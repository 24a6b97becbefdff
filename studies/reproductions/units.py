"""Units of work: calls whose results are stored on disk, so that a killed run can resume."""

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from peopleboy.scenarios.running.engine.store import Result, Store, code_digest
from peopleboy.scenarios.running.engine.task import Failure, ReportProgress, Task, TasksFailed, Workers
from peopleboy.scenarios.running.engine.work_through import work_through
from peopleboy.studies.reproductions.plan import Plan

Key = TypeVar("Key")

_HERE = Path(__file__).parent
_ROOT = _HERE.parents[1]

MEASURES = (
    _HERE / "tracker_settings.py",
    *sorted(path for name in ("experiments", "pictures") for path in _HERE.glob(f"{name}/*.py")),
    *sorted((_HERE.parent / "training").rglob("*.py")),
    *sorted((_ROOT / "scenarios" / "library").glob("*.yaml")),
)
"""Files on which results depend, besides trackers and simulator."""


@dataclass(frozen=True, slots=True, eq=False)
class Unit:
    """A call that any process can execute, with plain data as result: a task of the engine.

    Attributes:
        key: unique description in one line.
        function: a module-level function, so that it can be pickled.
        arguments: arguments of the call.
        is_timing: whether it measures time, and must run alone.
    """

    size: ClassVar[int] = 1

    key: str
    function: Callable[..., Result]
    arguments: tuple[Any, ...] = ()
    is_timing: bool = False

    @classmethod
    def of(cls, function: Callable[..., Result], *arguments: Any, is_timing: bool = False) -> "Unit":
        """Return a unit whose key is function and arguments, without folders, which do not affect results."""
        words = (str(getattr(one, "key", one)) for one in arguments if not isinstance(one, Path))
        return cls(f"{function.__name__} {' | '.join(words)}", function, arguments, is_timing)

    @property
    def name(self) -> str:
        """The key."""
        return self.key

    def run(self) -> Result:
        """Execute the call."""
        return self.function(*self.arguments)

    def __call__(self, report_progress: ReportProgress) -> tuple[Result, float]:  # noqa: ARG002
        """Make the call; return the processor's time [s] that it took, too."""
        start = time.process_time()
        result = self.run()
        return result, time.process_time() - start


class Unfinished(Exception):  # noqa: N818
    """An experiment needs results that are missing.

    Attributes:
        units: units that must run before it can continue.
    """

    def __init__(self, units: Sequence[Unit]) -> None:
        super().__init__(f"{len(units)} units have no result")
        self.units = tuple(units)


@dataclass(frozen=True, slots=True, eq=False)
class Measurement:
    """Plan and stored results of an experiment.

    Attributes:
        plan: extent of the run.
        done: results by key of the unit.
        asked: keys of all units that the experiment has requested.
    """

    plan: Plan
    done: Mapping[str, Result]
    asked: set[str] = field(default_factory=set)

    def results(self, units: Iterable[Unit]) -> list[Result]:
        """Return the units' results, in their order.

        An experiment requests all units of a stage at once, so that they can run in parallel.

        Raises:
            Unfinished: some units have no result yet.
        """
        listed = list(units)
        self.asked.update(unit.key for unit in listed)
        missing = {unit.key: unit for unit in listed if unit.key not in self.done}
        if missing:
            raise Unfinished(list(missing.values()))
        return [self.done[unit.key] for unit in listed]

    def grouped(self, units: Mapping[Key, Sequence[Unit]]) -> dict[Key, list[Result]]:
        """Return the results of groups of units, which can all run in parallel.

        Raises:
            Unfinished: some units have no result yet.
        """
        self.results(unit for several in units.values() for unit in several)
        return {key: self.results(several) for key, several in units.items()}

    def played(
        self, work: Callable[..., Result], scenarios: Iterable[str], seeds: int, *more: Any
    ) -> dict[str, list[Result]]:
        """Return the results of a call by scenario, seed by seed.

        Args:
            work: function of the scenario's name, a seed, and further arguments.
            scenarios: names of scenarios.
            seeds: number of seeds, from 0.
            more: further arguments.

        Raises:
            Unfinished: some units have no result yet.
        """
        return self.grouped(
            {name: [Unit.of(work, name, seed, *more) for seed in range(seeds)] for name in scenarios}
        )


def open_store(path: Path) -> Store:
    """Open the file of results; only results of the current code are used.

    Raises:
        BadInput: its folder cannot be written to.
    """
    return Store(path, code_digest(*MEASURES))


def run_units(units: Sequence[Unit], store: Store, workers: Workers) -> None:
    """Run the units that are not in the store yet, and store each result at once.

    Units that measure time run one after the other in this process, after all others; units with the same key
    run once.

    Raises:
        BadInput: the cluster cannot be used.
        TasksFailed: some units failed, after all others were completed.
    """
    missing = {unit.key: unit for unit in units if unit.key not in store}
    failures: list[Failure] = []
    for is_timing, who in ((False, workers), (True, Workers(1))):
        tasks = [unit for unit in missing.values() if unit.is_timing == is_timing]
        try:
            work_through(tasks, who, "reproduce", partial(_keep, store))
        except TasksFailed as failed:
            failures += failed.failures
    if failures:
        raise TasksFailed("reproduce", failures, len(missing))


def _keep(store: Store, task: Task[tuple[Result, float]], found: tuple[Result, float]) -> None:
    result, spent_s = found
    store.add(task.name, result, spent_s)
