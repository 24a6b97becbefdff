"""`python -m benchmarks.speed.against OTHER_CHECKOUT`: compare the speed of runs with another checkout.

Both use the contour tracker, under the name in each checkout, and take turns on this machine, in separate
processes with separate caches, so that other load affects both. The other checkout may be older than the
present layout of the package. The first turn of each compiles, and is not counted.
"""

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Final

import click

from benchmarks import call

HERE: Final = Path(__file__).parents[2]
SCENARIO: Final = "crossing_pair"
_CODE: Final = f"""
import inspect, json
from peopleboy.tracker import trackers
try:
    from benchmarks.speed.closed_loop import loop_speed, run_speed
except ImportError:
    from benchmarks.closed_loop import loop_speed, run_speed
has_choice = "tracker" in inspect.signature(run_speed).parameters
options = {{"tracker": trackers.CONTOUR_TRACKER}} if has_choice else {{}}
print(json.dumps([loop_speed("{SCENARIO}", **options), run_speed("{SCENARIO}", **options)]))
"""


@dataclass(frozen=True, slots=True)
class SpeedRatio:
    """Ratios of CPU time of the other checkout to this one, with two people.

    Attributes:
        loop: ratio for the closed loop: world, images, truth, tracker and behaviour.
        run: ratio for a whole run, which also writes tables, contact sheet and recording.
    """

    loop: float
    run: float


def gain_over(other: Path, rounds: int) -> SpeedRatio:
    """Measure both in turn, and return the median ratios."""
    _speeds(other)
    turns = [(_speeds(HERE), _speeds(other)) for _ in range(rounds)]
    loop, run = (median(here[which] / there[which] for here, there in turns) for which in (0, 1))
    return SpeedRatio(loop, run)


def _speeds(checkout: Path) -> list[float]:
    """Run a checkout's measurement of loop and run, in multiples of real time."""
    where = os.pathsep.join((str(checkout / "src"), str(checkout)))
    done = subprocess.run(
        [sys.executable, "-c", _CODE],
        cwd=checkout,
        env={**os.environ, "PYTHONPATH": where},
        stdout=subprocess.PIPE,
        check=True,
        text=True,
    )
    loop, run = json.loads(done.stdout.splitlines()[-1])
    return [float(loop), float(run)]


@click.command()
@click.argument(
    "other",
    type=click.Path(exists=True, file_okay=False, path_type=Path, resolve_path=True),
    metavar="OTHER_CHECKOUT",
)
@click.option("--rounds", default=3, show_default=True, help="Number of turns.")
def main(other: Path, rounds: int) -> None:
    """Print the speed of runs with two people relative to OTHER_CHECKOUT."""
    gain = gain_over(other, rounds)
    print(f"closed loop, two people: {gain.loop:.2f} times as fast")
    print(f"with tables, contact sheet and recording: {gain.run:.2f} times as fast")


if __name__ == "__main__":
    call(main, "benchmarks.speed.against")
