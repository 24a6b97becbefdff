"""Tasks for tests of the engine; run as a module, it works through some of them slowly."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.running.engine.store import Result, Store
from peopleboy.scenarios.running.engine.task import ReportProgress, Task, Workers
from peopleboy.scenarios.running.engine.work_through import work_through

_KEPT: list[bytes] = []


@dataclass(frozen=True, slots=True)
class ToyTask:
    """Squares a number, and leaves a line in a diary whenever it is finished.

    Attributes:
        number: to be squared.
        folder: where the diary is.
        takes_s: how long it takes.
        deaths: how often it kills its process.
        fault: what it raises instead; empty for nothing.
        keeps_mb: by how much its process grows for good.
    """

    number: int
    folder: Path
    takes_s: float = 0.0
    deaths: int = 0
    fault: str = ""
    size: int = 1
    keeps_mb: int = 0

    @property
    def name(self) -> str:
        return f"toy {self.number}"

    def __call__(self, report_progress: ReportProgress) -> Result:
        self._die()
        if self.fault:
            raise {"refused": BadInput, "wrong": ArithmeticError}[self.fault](
                f"{self.number} is {self.fault}"
            )
        _KEPT.append(b"x" * (self.keeps_mb << 20))
        time.sleep(self.takes_s)
        report_progress(1)
        with (self.folder / "diary").open("a", encoding="utf-8") as diary:
            diary.write(f"{self.number} {os.getpid()}\n")
        return {"square": self.number**2}

    def _die(self) -> None:
        died = len(list(self.folder.glob(f"died-{self.number}-*")))
        if died < self.deaths:
            (self.folder / f"died-{self.number}-{died}").touch()
            os.kill(os.getpid(), signal.SIGKILL)


def diary(folder: Path) -> Counter[int]:
    """Count how often each number was squared."""
    return Counter(number for number, _ in diary_lines(folder))


def diary_lines(folder: Path) -> list[tuple[int, int]]:
    """Read which number was squared by which process, in order."""
    path = folder / "diary"
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return [(int(number), int(process)) for number, process in map(str.split, lines)]


def toys(folder: Path, count: int = 12, takes_s: float = 0.0) -> list[ToyTask]:
    """Make tasks that square 0, 1, 2, ..."""
    return [ToyTask(number, folder, takes_s) for number in range(count)]


def squares(store: Store) -> dict[int, int]:
    """Give the results by number."""
    return {int(key.split()[1]): result["square"] for key, result in store.items()}


def work(tasks: list[ToyTask], store: Store, workers: Workers) -> None:
    """Do the tasks that are not in the store."""

    def keep(task: Task[Result], result: Result) -> None:
        store.add(task.name, result)

    work_through([task for task in tasks if task.name not in store], workers, "toys", keep)


if __name__ == "__main__":
    here = Path(sys.argv[1])
    work(
        toys(here, takes_s=float(sys.argv[2])), Store(here / "toys.jsonl", "toys"), Workers(int(sys.argv[3]))
    )
