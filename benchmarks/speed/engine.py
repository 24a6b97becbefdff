"""Overhead of the engine: a sweep with one worker, compared with a plain loop over the same runs."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import click

from benchmarks import call
from benchmarks.compare import Turns, spent_ms
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.scenarios.running.many_runs import RunTask, play, unfinished
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions

SCENARIO, DURATION_S = "crossing_2", 2.0


def _loop(tasks: Sequence[RunTask]) -> None:
    for task in tasks:
        run(task.scenario, task.options, lambda _tick, _frames: None)


def _engine(tasks: Sequence[RunTask]) -> None:
    play(unfinished(tasks), Workers(1), "engine")


WAYS: dict[str, Callable[[Sequence[RunTask]], None]] = {"loop": _loop, "engine": _engine}


def engine_cost(seeds: int = 8, rounds: int = 5) -> tuple[Turns, Turns]:
    """Time both in turn, after one round of warm-up; return clock and processor times [ms]."""
    scenario = load_scenario(SCENARIO).lasting(DURATION_S)
    clock, processor = Turns(), Turns()
    for number in range(rounds + 1):
        walls, spent = {}, {}
        for name, work in WAYS.items():
            with TemporaryDirectory() as folder:
                options = RunOptions(seed=0, out=Path(folder), record=False)
                tasks = [
                    RunTask(scenario, replace(options, seed=seed, out=Path(folder, str(seed))))
                    for seed in range(seeds)
                ]
                start = time.perf_counter()
                spent[name] = spent_ms(partial(work, tasks))
                walls[name] = 1000.0 * (time.perf_counter() - start)
        if number > 0:
            clock.add(walls)
            processor.add(spent)
    return clock, processor


@click.command()
@click.option("--seeds", default=8, show_default=True, help="Runs per sweep.")
@click.option("--rounds", default=5, show_default=True, help="Number of turns.")
def main(seeds: int, rounds: int) -> None:
    """Print the engine's overhead for a sweep of short runs: shortest times, and share of the loop's."""
    clock, processor = engine_cost(seeds, rounds)
    loop, engine = (
        f"{clock.least(name) / 1000.0:.2f} s, processor {processor.least(name) / 1000.0:.2f} s"
        for name in WAYS
    )
    share = processor.least("engine") / processor.least("loop") - 1.0
    click.echo(f"loop   {loop}")
    click.echo(f"engine {engine}: {100 * share:+.1f} %")


if __name__ == "__main__":
    call(main, "benchmarks.speed.engine")
