"""Memory over hours of a run and thousands of environments: `python -m benchmarks.reliability.soak`.

The run is that of a hall in which people come and go, with 50 faults of all kinds in turn.
"""

import gc
import os
import sys
import time
from dataclasses import astuple, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, get_args

import click
import pybullet

from benchmarks import call
from benchmarks.reliability.safety import SMALL
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.scenario_file import Failure
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions

MOST_GROWTH_MB: Final = 50.0  # over the environments, and in an hour of a run
_TURNS: Final = 50  # people and faults, one after the other
_CORNERS_M: Final = ([4.0, 2.0], [9.0, 2.5], [9.0, -2.5], [4.0, -2.0])
_LAPS: Final = 40
_ROW: Final = "{:12} {:8}  {:10.0f}  {:11}  {:7}  {:8.1f}"
_CLIENTS: Final = 1024  # the most that PyBullet has


def busy_hall(duration_s: float, *, is_small: bool = False) -> Scenario:
    """Return a hall in which two people are present at any time, and new ones take their turn.

    Args:
        duration_s: [s] length of the run.
        is_small: whether cameras have small images, which take less time.
    """
    cameras = {name: SMALL | {"kind": name} for name in ("thermal", "colour")} if is_small else {}
    turn_s, kinds = duration_s / _TURNS, get_args(Failure)
    return parse_scenario(
        {
            "name": "busy_hall",
            "description": "People come and go, while sensors, wheels and tracker fail.",
            "duration_s": duration_s,
            "place": {"kind": "room", "length_m": 12.0, "width_m": 8.0},
            "people": [_visitor(number, turn_s, duration_s) for number in range(_TURNS)],
            "robot": {"at_m": [1.0, 0.0], "behaviour": "follow_person", "cameras": cameras},
            "faults": [
                {"kind": kinds[n % len(kinds)], "from_s": (n + 0.5) * turn_s, "lasts_s": turn_s / 10}
                for n in range(_TURNS)
            ],
        },
        source="busy_hall",
        folder=Path(),
    )


def _visitor(number: int, turn_s: float, duration_s: float) -> dict[str, Any]:
    """Return a person who walks around the hall for two turns."""
    leave_s = (number + 2) * turn_s
    person = {
        "name": f"p{number}",
        "enter_s": number * turn_s,
        "path": [{"at_m": at_m} for at_m in _CORNERS_M * _LAPS],
    }
    return person | ({"leave_s": leave_s} if leave_s < duration_s else {})


@dataclass(frozen=True, slots=True)
class Usage:
    """What this process uses.

    Attributes:
        at: number of frames or environments so far.
        memory_mb: resident memory.
        descriptors: open file descriptors.
        clients: PyBullet clients.
        time_ms: time per frame or environment since the last row.
    """

    at: int
    memory_mb: float
    descriptors: int
    clients: int
    time_ms: float


class UsageLog:
    """Collect the usage of this process, every so many steps.

    Args:
        every: number of steps between two rows.
        title: what the steps are, to print rows as they come; empty to print none.
    """

    def __init__(self, every: int, title: str = "") -> None:
        self._every, self._title, self._began_s = every, title, time.monotonic()
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
        clients = sum(pybullet.isConnected(number) for number in range(_CLIENTS))
        self.rows.append(Usage(at, memory_mb, len(os.listdir("/proc/self/fd")), clients, took_ms))
        if self._title:
            click.echo(_ROW.format(self._title, *astuple(self.rows[-1])))

    @property
    def growth_mb(self) -> float:
        """Growth of the memory since the first row."""
        return self.rows[-1].memory_mb - self.rows[0].memory_mb if self.rows else 0.0


def soak_run(hours: float, tracker: str, log: UsageLog) -> None:
    """Run the busy hall for many hours, with small images if the tracker needs none."""

    def note(tick: Tick, _frames: int) -> None:
        log.add(tick.frame)

    with TemporaryDirectory() as folder:
        options = RunOptions(seed=0, out=Path(folder) / "run", tracker=tracker, record=False)
        run(busy_hall(3600.0 * hours, is_small=tracker == ORACLE), options, note)


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
@click.option("--hours", default=8.0, show_default=True, help="Simulated hours of the run.")
@click.option("--tracker", default="detection", show_default=True, help="Tracker of the run.")
@click.option("--environments", default=2000, show_default=True, help="Number of environments.")
def main(hours: float, tracker: str, environments: int) -> None:
    """Check that memory does not grow with the length of a run or the number of environments."""
    frames = round(hours * 3600 * 15)
    opened = UsageLog(max(environments // 10, 1), "environments")
    ran = UsageLog(max(frames // 10, 1), "frames")
    click.echo("step                  memory, MB  descriptors  clients  time, ms")
    soak_environments(environments, opened)
    soak_run(hours, tracker, ran)
    sys.exit(1 if max(opened.growth_mb, ran.growth_mb / max(hours, 1.0)) > MOST_GROWTH_MB else 0)


if __name__ == "__main__":
    call(main, "benchmarks.reliability.soak")
