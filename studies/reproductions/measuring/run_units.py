"""Do units of work that are missing, and keep their results."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from peopleboy.scenarios.files.load import LIBRARY
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.store import Result, Store, code_digest
from peopleboy.scenarios.running.engine.task import Failure, Task, TasksFailed, Tell
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.studies.reproductions.evaluations.drive_tracking import SETS, TURNS
from peopleboy.studies.reproductions.measuring.units import Unit

STUDIES = Path(__file__).parents[2]
_STUDIES = ("reproductions/evaluations", "training/distance_learning", "training/window_learning")
_MODELS = (
    "corridor_meeting", "corridor_straight", "crossing_2", "follow_visitors", "hall_visits", "hidden_2s",
    "leader_swap", "passers_by",
)  # fmt: skip
_SCENARIOS = ("corner_webcams", "room_long", "room_narrow", "room_short", *SETS, TURNS, *_MODELS)

MEASURES = (
    *(
        Path(__file__).with_name(f"{kind}units.py")
        for kind in ("", "cause_", "delay_", "distance_", "drive_", "learn_", "picture_", "window_")
    ),
    *sorted(Path(__file__).parents[1].glob("pictures/*.py")),
    *(path for study in _STUDIES for path in sorted((STUDIES / study).glob("*.py"))),
    *(LIBRARY / f"{name}.yaml" for name in _SCENARIOS),
)
"""The files that say how results are measured, beside trackers and simulator."""


@dataclass(frozen=True, slots=True)
class UnitTask:
    """A unit for the engine."""

    unit: Unit
    size: int = 1

    @property
    def name(self) -> str:
        """Its key."""
        return self.unit.key

    def __call__(self, tell: Tell) -> tuple[Result, float]:  # noqa: ARG002
        """Do it, and give the processor's time [s] that it took, too."""
        start = time.process_time()
        result = self.unit.run()
        return result, time.process_time() - start


def open_store(path: Path) -> Store:
    """Open the file of results, of which those count that this code would give again.

    Raises:
        BadInput: its folder cannot be written to.
    """
    return Store(path, code_digest(*MEASURES))


def run_units(units: Sequence[Unit], store: Store, workers: Workers) -> None:
    """Do the units that are not in the store yet, and put each there as soon as it is finished.

    Units that measure time are done one after the other in this process, after all others; several with the
    same key are done once.

    Raises:
        BadInput: the cluster cannot be used.
        TasksFailed: some units failed, after all others were done.
    """
    missing = {unit.key: unit for unit in units if unit.key not in store}
    keep = partial(_keep, store)
    failures: list[Failure] = []
    for is_timing, who in ((False, workers), (True, Workers(1))):
        tasks = [UnitTask(unit) for unit in missing.values() if unit.is_timing == is_timing]
        try:
            work_through(tasks, who, "reproduce", keep)
        except TasksFailed as failed:
            failures += failed.failures
    if failures:
        raise TasksFailed("reproduce", failures, len(missing))


def _keep(store: Store, task: Task[tuple[Result, float]], found: tuple[Result, float]) -> None:
    result, spent_s = found
    store.add(task.name, result, spent_s)
