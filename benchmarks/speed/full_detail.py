"""What full detail costs: both camera images with full truth of a scenario, beside the same in plain detail.

`python -m benchmarks.speed.full_detail` prints a row for each scenario of the library in full detail, the one
that it costs most first; names of scenarios behind it choose others.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import click
import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks import call
from peopleboy.behaviours.command import Command
from peopleboy.scenarios.files.load import LIBRARY, library, load_scenario, parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.schema.robot import ORACLE
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.loop.tracker_by_name import make_eyes
from peopleboy.sim.world import World

GOAL = 1.5
"""How many times as long full detail may take."""

PRESET = "uncooled"  # electronics of the thermal camera where detail is full, unless the file has others
SEED = 0
_COMPILED = 2  # instants after which all kernels are compiled


@dataclass(frozen=True, slots=True, kw_only=True)
class DetailTimes:
    """Medians over the instants of a run: thermal image, colour image and full truth.

    Attributes:
        plain_ms: [ms] with `detail: plain` and a fixed gain.
        full_ms: [ms] with `detail: full` and an uncooled camera's electronics.
        ratio: how many times as long full detail takes at the same instant, which a machine that is now busy
            and now idle disturbs less.
    """

    plain_ms: float
    full_ms: float
    ratio: float


def detail_times(name: str, instants: int | None = None) -> DetailTimes:
    """Play a scenario of the library in both details, instant by instant in turn, and time each.

    Args:
        name: of the scenario.
        instants: how many; None for all of them.

    Raises:
        BadInput: there is no such scenario.
    """
    plain, full = in_detail(name, "plain"), in_detail(name, "full")
    commands = _drive(full, instants)
    times: tuple[list[float], list[float]] = ([], [])
    with World(plain.world(SEED)) as plain_world, World(full.world(SEED)) as full_world:
        for command in commands:
            for world, spent in zip((plain_world, full_world), times, strict=True):
                start = time.process_time()
                world.truth()
                dict(world.take_images())  # made only when asked for
                spent.append(time.process_time() - start)
                world.step(command.linear_m_s, command.angular_rad_s)
    spent_ms = 1000.0 * np.array(times)[:, _COMPILED:]
    plain_ms, full_ms = np.median(spent_ms, axis=1)
    ratio = np.median(spent_ms[1] / spent_ms[0])
    return DetailTimes(plain_ms=float(plain_ms), full_ms=float(full_ms), ratio=float(ratio))


def in_detail(name: str, detail: str) -> Scenario:
    """A scenario of the library in a detail, the thermal camera's electronics with it."""
    data: dict[str, Any] = load_scenario(name).spec.model_dump(mode="json", exclude_unset=True)
    robot = data.get("robot", {})
    cameras = robot.get("cameras", {})
    electronics = {"preset": PRESET} | cameras.get("thermal", {}) if detail == "full" else {}
    robot |= {"cameras": cameras | {"thermal": {"kind": "thermal"} | electronics}}
    return parse_scenario(data | {"detail": detail, "robot": robot}, source=name, folder=LIBRARY)


def _drive(scenario: Scenario, instants: int | None) -> list[Command]:
    """What the robot does in a scenario, so that both worlds are seen from the same places."""
    config = scenario.world(SEED)
    frames = round(scenario.duration_s * config.control_hz) if instants is None else instants + _COMPILED
    with World(config) as world:
        ticks = closed_loop(world, make_eyes(ORACLE, SEED, world.truth), scenario.make_behaviour(), frames)
        return [tick.command for tick in ticks]


@click.command()
@click.argument("scenarios", nargs=-1)
@click.option("--instants", type=click.IntRange(1), help="How many are timed; all of a run by default.")
def main(scenarios: Sequence[str], instants: int | None) -> None:
    """Print CPU times of SCENARIOS in plain and in full detail; those of full detail by default."""
    names = scenarios or [name for name in library() if load_scenario(name).spec.detail == "full"]
    times = {name: detail_times(name, instants) for name in names}
    table = Table("scenario", "plain, ms", "full, ms", "times as long", "goal", box=None)
    for name, found in sorted(times.items(), key=lambda item: -item[1].ratio):
        row = (found.plain_ms, found.full_ms, found.ratio, GOAL)
        table.add_row(name, *(f"{value:.2f}" for value in row))
    Console(width=100).print(table)


if __name__ == "__main__":
    call(main, "benchmarks.speed.full_detail")
