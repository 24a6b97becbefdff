"""One scenario, many seeds."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from rich.console import Console
from rich.progress import track

from scenarios.load import load_scenario
from scenarios.run import RunOptions, run


def run_seeds(
    scenario: str, seeds: Iterable[int], out: Path, tracker: str, jobs: int, *, overwrite: bool
) -> list[Path]:
    """Run a scenario once per seed, without recordings, some runs at the same time.

    Returns:
        The folders out/SCENARIO-SEED, in the order of the seeds.

    Raises:
        BadInput: as for a single run; runs that were finished before stay.
    """
    name = load_scenario(scenario).name
    options = [
        RunOptions(seed=seed, out=out / f"{name}-{seed}", tracker=tracker, record=False, overwrite=overwrite)
        for seed in seeds
    ]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        done = [pool.submit(_run_one, scenario, option) for option in options]
        for future in track(done, description=name, console=Console(stderr=True)):
            future.result()
    return [option.out for option in options]


def _run_one(scenario: str, options: RunOptions) -> None:
    run(load_scenario(scenario), options, lambda _tick, _frames: None)
