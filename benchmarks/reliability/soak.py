"""Memory over hours of a run and thousands of environments: `python -m benchmarks.reliability.soak`."""

import gc
import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import click
from rich.console import Console
from rich.table import Table

from benchmarks import call
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions

MOST_GROWTH_MB = 50.0


@dataclass(frozen=True, slots=True)
class Usage:
    """What this process uses.

    Attributes:
        at: number of frames or environments so far.
        memory_mb: resident memory.
        descriptors: open file descriptors.
        time_ms: time per frame or environment since the last row.
    """

    at: int
    memory_mb: float
    descriptors: int
    time_ms: float


class UsageLog:
    """Collect the usage of this process, every so many steps."""

    def __init__(self, every: int) -> None:
        self._every, self._began_s = every, time.monotonic()
        self.rows: list[Usage] = []

    def add(self, at: int) -> None:
        """Note the usage if it is due."""
        if at % self._every:
            return
        gc.collect()
        now_s = time.monotonic()
        took_ms = 1e3 * (now_s - self._began_s) / self._every
        self._began_s = now_s
        pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[1])
        memory_mb = pages * os.sysconf("SC_PAGESIZE") / 1e6
        self.rows.append(Usage(at, memory_mb, len(os.listdir("/proc/self/fd")), took_ms))

    @property
    def growth_mb(self) -> float:
        """Growth of the memory since the first row."""
        return self.rows[-1].memory_mb - self.rows[0].memory_mb if self.rows else 0.0


def soak_run(scenario: str, hours: float, log: UsageLog) -> None:
    """Run a scenario of many hours."""

    def note(tick: Tick, _frames: int) -> None:
        log.add(tick.frame)

    with TemporaryDirectory() as folder:
        options = RunOptions(seed=0, out=Path(folder) / "run", record=False)
        run(load_scenario(scenario).lasting(3600.0 * hours), options, note)


def soak_environments(count: int, log: UsageLog) -> None:
    """Open, reset and drop environments, every second one without closing it."""
    for number in range(1, count + 1):
        env = PeopleBoyEnv("single_follow", observation="truth")
        env.reset(seed=number)
        env.step([1.0, 0.0])
        if number % 2:
            env.close()
        log.add(number)


@click.command()
@click.option("--scenario", default="crossing_3", show_default=True, help="Scenario of the long run.")
@click.option("--hours", default=8.0, show_default=True, help="Simulated hours of the run.")
@click.option("--environments", default=2000, show_default=True, help="Number of environments.")
def main(scenario: str, hours: float, environments: int) -> None:
    """Check that memory does not grow with the length of a run or the number of environments."""
    frames = round(hours * 3600 * 15)
    logs = {
        "run": UsageLog(max(frames // 10, 1)),
        "environments": UsageLog(max(environments // 10, 1)),
    }
    soak_environments(environments, logs["environments"])
    soak_run(scenario, hours, logs["run"])
    table = Table("of", "number", "memory, MB", "descriptors", "time, ms")
    for name, log in logs.items():
        for row in log.rows:
            cells = (f"{row.memory_mb:.0f}", str(row.descriptors), f"{row.time_ms:.1f}")
            table.add_row(name, str(row.at), *cells)
    Console().print(table)
    sys.exit(1 if any(log.growth_mb > MOST_GROWTH_MB for log in logs.values()) else 0)


if __name__ == "__main__":
    call(main, "benchmarks.reliability.soak")
