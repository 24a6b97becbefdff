"""Units of work: calls whose results are kept on disk, so that a killed run resumes."""

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
"""The files on which results depend, beside trackers and simulator."""


@dataclass(frozen=True, slots=True, eq=False)
class Unit:
    """A call that any process can make, and whose result is plain data: the task that the engine runs.

    Attributes:
        key: what it is, in one line; no two units have the same.
        function: of a module, so that it can be pickled.
        arguments: of the call.
        is_timing: whether it measures time, and has to run alone.
    """

    size: ClassVar[int] = 1

    key: str
    function: Callable[..., Result]
    arguments: tuple[Any, ...] = ()
    is_timing: bool = False

    @classmethod
    def of(cls, function: Callable[..., Result], *arguments: Any, is_timing: bool = False) -> "Unit":
        """Name a call by its function and arguments, folders left out: these change no result."""
        words = (str(getattr(one, "key", one)) for one in arguments if not isinstance(one, Path))
        return cls(f"{function.__name__} {' | '.join(words)}", function, arguments, is_timing)

    @property
    def name(self) -> str:
        """The key."""
        return self.key

    def run(self) -> Result:
        """Make the call."""
        return self.function(*self.arguments)

    def __call__(self, report_progress: ReportProgress) -> tuple[Result, float]:  # noqa: ARG002
        """Make the call; return the processor's time [s] that it took, too."""
        start = time.process_time()
        result = self.run()
        return result, time.process_time() - start


class Unfinished(Exception):  # noqa: N818
    """An experiment needs results that are missing.

    Attributes:
        units: that have to run before it can go on.
    """

    def __init__(self, units: Sequence[Unit]) -> None:
        super().__init__(f"{len(units)} units have no result")
        self.units = tuple(units)


@dataclass(frozen=True, slots=True, eq=False)
class Measurement:
    """What an experiment measures with: how much, and the results that are there.

    Attributes:
        plan: how much of everything.
        done: results by the unit's key.
        asked: keys of all units that the experiment has asked for.
    """

    plan: Plan
    done: Mapping[str, Result]
    asked: set[str] = field(default_factory=set)

    def results(self, units: Iterable[Unit]) -> list[Result]:
        """Return the units' results, in their order.

        An experiment asks for all units of a stage at once, so that they can run side by side.

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
        """Return the results of groups of units, all of which can run side by side.

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
            work: takes the scenario's name, a seed, and what follows.
            scenarios: names.
            seeds: how many, from 0.
            more: further arguments.

        Raises:
            Unfinished: some units have no result yet.
        """
        return self.grouped(
            {name: [Unit.of(work, name, seed, *more) for seed in range(seeds)] for name in scenarios}
        )


def open_store(path: Path) -> Store:
    """Open the file of results; only those count that this code would give again.

    Raises:
        BadInput: its folder cannot be written to.
    """
    return Store(path, code_digest(*MEASURES))


def run_units(units: Sequence[Unit], store: Store, workers: Workers) -> None:
    """Run the units that are not in the store yet, and keep each result as soon as it is there.

    Units that measure time run one after the other in this process, after all others; several with the same
    key run once.

    Raises:
        BadInput: the cluster cannot be used.
        TasksFailed: some units failed, after all others were done.
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
