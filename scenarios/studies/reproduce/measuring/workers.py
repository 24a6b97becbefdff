"""Run units on all cores, or on a cluster; what is finished is kept, whatever dies."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import joblib
from joblib.externals.loky.process_executor import BrokenProcessPool

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.studies.reproduce.measuring.store import Result, Store
from peopleboy.scenarios.studies.reproduce.measuring.units import Unit

ATTEMPTS = 5  # how often workers may die without a unit having been finished in between
CONNECT_S = 30.0  # [s] to wait for the scheduler, and for its first worker

Report = Callable[[int, int, str], None]


def run_units(units: Sequence[Unit], store: Store, jobs: int, scheduler: str | None, report: Report) -> None:
    """Run the units that are not in the store yet, and put each there as soon as it is finished.

    Units that measure time run one after the other in this process, after all others.

    Args:
        units: what to do; several with the same key are done once.
        store: where results are kept.
        jobs: processes at the same time; -1 for one a core.
        scheduler: address of a Dask scheduler whose workers do the work; None to do it here.
        report: told how many units are finished, of how many, and which one was last.

    Raises:
        BadInput: the scheduler cannot be reached.
        BrokenProcessPool: workers die again and again.
    """
    missing = {unit.key: unit for unit in units if unit.key not in store}
    total = len(missing)
    report(0, total, "")

    def keep(key: str, result: Result) -> None:
        store.add(key, result)
        report(sum(name in store for name in missing), total, key)

    with _backend(jobs, scheduler):
        _run_together([unit for unit in missing.values() if not unit.is_timing], store, keep)
    for unit in missing.values():
        if unit.is_timing:
            keep(unit.key, unit.run())


def _run_together(units: Sequence[Unit], store: Store, keep: Callable[[str, Result], None]) -> None:
    """Run units in many processes, again and again until all are finished, though some may be killed."""
    failures, left = 0, list(units)
    while left:
        before = len(left)
        try:
            for key, result in _finished(left):
                keep(key, result)
        except Exception as error:
            if not _is_death(error):
                raise
            failures = failures + 1 if before == sum(u.key not in store for u in left) else 0
            if failures >= ATTEMPTS:
                raise
        left = [unit for unit in left if unit.key not in store]


def _finished(units: Sequence[Unit]) -> Iterator[tuple[str, Result]]:
    # A batch is one unit: what is finished is kept at once.
    parallel = joblib.Parallel(return_as="generator_unordered", batch_size=1)
    yield from parallel(joblib.delayed(_run)(unit) for unit in units)


def _run(unit: Unit) -> tuple[str, Result]:
    return unit.key, unit.run()


def _is_death(error: Exception) -> bool:
    """Tell whether a worker was killed, rather than that its work is wrong."""
    return isinstance(error, BrokenProcessPool) or type(error).__name__ == "KilledWorker"


@contextmanager
def _backend(jobs: int, scheduler: str | None) -> Iterator[None]:
    if scheduler is None:
        with joblib.parallel_config(backend="loky", n_jobs=jobs):
            yield
    else:
        with _dask(scheduler):
            yield


@contextmanager
def _dask(scheduler: str) -> Iterator[None]:
    try:
        from distributed import Client
    except ImportError:
        raise BadInput("--scheduler needs Dask: pip install '.[cluster]'") from None
    try:
        client = Client(scheduler, timeout=CONNECT_S)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise BadInput(f"--scheduler {scheduler}: cannot be reached: {error}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=CONNECT_S)
        except TimeoutError:
            raise BadInput(f"--scheduler {scheduler}: has no workers; start some with dask worker") from None
        with joblib.parallel_config(backend="dask"):
            yield
