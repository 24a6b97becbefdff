"""Many runs, some at the same time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from multiprocessing import get_context
from pathlib import Path

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.progress_bar import each_shown
from peopleboy.scenarios.running.finished import is_finished
from peopleboy.scenarios.running.run import RunOptions, run


@dataclass(frozen=True, slots=True)
class Job:
    """A scenario, by name or path, and how to run it."""

    scenario: str
    options: RunOptions


def run_seeds(
    scenario: str, seeds: Iterable[int], out: Path, tracker: str | None, jobs: int, *, overwrite: bool
) -> list[Path]:
    """Run a scenario once per seed, without recordings, some runs at the same time.

    Returns:
        The folders out/SCENARIO-SEED, in the order of the seeds.

    Raises:
        BadInput: as for a single run, or a complete run in its place is another one.
    """
    name = load_scenario(scenario).name
    options = [
        RunOptions(seed=seed, out=out / f"{name}-{seed}", tracker=tracker, record=False, overwrite=overwrite)
        for seed in seeds
    ]
    run_jobs(unfinished([Job(scenario, option) for option in options]), jobs, name)
    return [option.out for option in options]


def unfinished(jobs: Sequence[Job]) -> list[Job]:
    """Leave out the runs that are there already, so that a killed call goes on.

    Raises:
        BadInput: a complete run in the place of one is another one.
    """
    return [job for job in jobs if not is_finished(load_scenario(job.scenario), job.options)]


def run_jobs(jobs: Sequence[Job], processes: int, title: str) -> None:
    """Run all of them, with a bar on standard error.

    Raises:
        BadInput: as for a single run, or a process died.
    """
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        done = [pool.submit(_run_one, job) for job in jobs]
        try:
            for future in each_shown(done, title):
                future.result()
        except BrokenProcessPool as error:
            raise BadInput(
                f"{title}: a process was killed, perhaps for want of memory; the same command goes on "
                "where it was, with fewer --jobs"
            ) from error
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _run_one(job: Job) -> None:
    options = replace(job.options, overwrite=True)
    run(load_scenario(job.scenario), options, lambda _tick, _frames: None)
