"""What the engine costs: a sweep with one worker, beside a plain loop over the same runs."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import click

from benchmarks import call
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.scenarios.running.run import RunOptions, run
from peopleboy.scenarios.running.run_task import RunTask, play, unfinished

SCENARIO, DURATION_S = "crossing_2", 2.0


@dataclass(frozen=True, slots=True)
class EngineCost:
    """Least times of a sweep, which other work on the machine disturbs least.

    Attributes:
        loop_s: wall time [s] of the plain loop.
        engine_s: that of the engine.
        loop_cpu_s: processor time [s] of the plain loop.
        engine_cpu_s: that of the engine.
    """

    loop_s: float
    engine_s: float
    loop_cpu_s: float
    engine_cpu_s: float

    @property
    def share(self) -> float:
        """The processor time that the engine adds, as a share of the loop's."""
        return self.engine_cpu_s / self.loop_cpu_s - 1.0


def engine_cost(seeds: int = 8, rounds: int = 5) -> EngineCost:
    """Time both in turn, after one round that compiles."""
    scenario = load_scenario(SCENARIO).lasting(DURATION_S)
    times: dict[Callable[[Sequence[RunTask]], None], list[tuple[float, float]]] = {_loop: [], _engine: []}
    for number in range(rounds + 1):
        for way, found in times.items():
            with TemporaryDirectory() as folder:
                options = RunOptions(seed=0, out=Path(folder), record=False)
                tasks = [
                    RunTask(scenario, replace(options, seed=seed, out=Path(folder, str(seed))))
                    for seed in range(seeds)
                ]
                spent = _timed(way, tasks)
            if number > 0:
                found.append(spent)
    (loop_s, loop_cpu_s), (engine_s, engine_cpu_s) = (
        (min(wall for wall, _ in found), min(cpu for _, cpu in found)) for found in times.values()
    )
    return EngineCost(loop_s, engine_s, loop_cpu_s, engine_cpu_s)


def _timed(way: Callable[[Sequence[RunTask]], None], tasks: Sequence[RunTask]) -> tuple[float, float]:
    start, cpu = time.perf_counter(), time.process_time()
    way(tasks)
    return time.perf_counter() - start, time.process_time() - cpu


def _loop(tasks: Sequence[RunTask]) -> None:
    for task in tasks:
        run(task.scenario, task.options, lambda _tick, _frames: None)


def _engine(tasks: Sequence[RunTask]) -> None:
    play(unfinished(tasks), Workers(1), "engine")


@click.command()
@click.option("--seeds", default=8, show_default=True, help="Runs of a sweep.")
@click.option("--rounds", default=5, show_default=True, help="How often both are timed.")
def main(seeds: int, rounds: int) -> None:
    """Print what the engine adds to a sweep of short runs."""
    cost = engine_cost(seeds, rounds)
    click.echo(f"loop   {cost.loop_s:.2f} s, processor {cost.loop_cpu_s:.2f} s")
    click.echo(
        f"engine {cost.engine_s:.2f} s, processor {cost.engine_cpu_s:.2f} s: {100 * cost.share:+.1f} %"
    )


if __name__ == "__main__":
    call(main, "benchmarks.speed.engine")
