"""One scenario, many seeds."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

from rich.console import Console
from rich.progress import track

from scenarios.finished import is_finished
from scenarios.load import load_scenario
from scenarios.run import RunOptions, run


def run_seeds(
    scenario: str, seeds: Iterable[int], out: Path, tracker: str, jobs: int, *, overwrite: bool
) -> list[Path]:
    """Run a scenario once per seed, without recordings, some runs at the same time.

    Runs that are complete stay; a sweep that was killed goes on where it was.

    Returns:
        The folders out/SCENARIO-SEED, in the order of the seeds.

    Raises:
        BadInput: as for a single run, or a complete run in its place is another one.
    """
    loaded = load_scenario(scenario)
    name = loaded.name
    options = [
        RunOptions(seed=seed, out=out / f"{name}-{seed}", tracker=tracker, record=False, overwrite=overwrite)
        for seed in seeds
    ]
    waiting = [option for option in options if not is_finished(loaded, option)]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        done = [pool.submit(_run_one, scenario, replace(option, overwrite=True)) for option in waiting]
        for future in track(done, description=name, console=Console(stderr=True)):
            future.result()
    return [option.out for option in options]


def _run_one(scenario: str, options: RunOptions) -> None:
    run(load_scenario(scenario), options, lambda _tick, _frames: None)
