"""Units of work for tests of the machinery; run as a module, it works through some of them slowly."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from peopleboy.scenarios.studies.reproduce.measuring.store import Result, Store
from peopleboy.scenarios.studies.reproduce.measuring.workers import run_units


@dataclass(frozen=True, slots=True)
class ToyUnit:
    """Squares a number, and leaves a line in a diary whenever it is finished.

    Attributes:
        number: to be squared.
        folder: where the diary is.
        takes_s: how long it takes.
        dies: whether it kills its process the first time.
    """

    number: int
    folder: Path
    takes_s: float = 0.0
    dies: bool = False
    is_timing: bool = False

    @property
    def key(self) -> str:
        return f"toy {self.number}"

    def run(self) -> Result:
        fatal = self.folder / f"died-{self.number}"
        if self.dies and not fatal.exists():
            fatal.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(self.takes_s)
        with (self.folder / "diary").open("a", encoding="utf-8") as diary:
            diary.write(f"{self.number} {os.getpid()}\n")
        return {"square": self.number**2}


def diary(folder: Path) -> Counter[int]:
    """Count how often each number was squared."""
    path = folder / "diary"
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return Counter(int(line.split()[0]) for line in lines)


def no_report(finished: int, total: int, last: str) -> None:
    """Say nothing."""


def toys(folder: Path, count: int = 12, takes_s: float = 0.0) -> list[ToyUnit]:
    """Make units that square 0, 1, 2, ..."""
    return [ToyUnit(number, folder, takes_s) for number in range(count)]


if __name__ == "__main__":
    here = Path(sys.argv[1])
    run_units(toys(here, takes_s=float(sys.argv[2])), Store(here / "units.jsonl"), 1, None, no_report)
