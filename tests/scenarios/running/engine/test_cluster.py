from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from peopleboy.scenarios.running.engine import task
from peopleboy.scenarios.running.engine.store import Store
from peopleboy.scenarios.running.engine.task import TasksFailed, Workers, running_source
from tests.helpers.calls.refused import refused
from tests.helpers.runs import toy_tasks
from tests.helpers.runs.toy_tasks import ToyTask, diary, squares, toys, work

distributed = pytest.importorskip("distributed")
pytestmark = pytest.mark.filterwarnings("default")  # Dask closes its sockets late
MODULE = "peopleboy.scenarios.running.engine.cluster"


class Ours:
    """Tells something else here than in workers."""

    def __init__(self, changed: dict[str, str]) -> None:
        self._changed = changed

    def __call__(self) -> dict[str, str]:
        return running_source() | self._changed

    def __reduce__(self) -> tuple[object, ...]:
        return getattr, (task, "running_source")


@pytest.fixture
def cluster() -> Iterator[str]:
    """The address of two workers that are threads of this process."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, dashboard_address="127.0.0.1:0"
    ) as found:
        yield found.scheduler_address


def test_a_cluster_does_what_processes_do_and_a_failure_stops_no_other(tmp_path: Path, cluster: str) -> None:
    store = Store(tmp_path / "toys.jsonl", "toys")
    work(toys(tmp_path), store, Workers(scheduler=cluster))
    assert squares(store) == {number: number**2 for number in range(12)}
    assert set(diary(tmp_path).values()) == {1}
    more = [ToyTask(12, tmp_path, fault="wrong"), ToyTask(13, tmp_path)]
    with pytest.raises(TasksFailed, match=r"1 of 2 failed(.|\n)*toy 12: ArithmeticError: 12 is wrong"):
        work(more, store, Workers(scheduler=cluster))
    assert squares(store)[13] == 169


@pytest.mark.parametrize(
    ("changed", "why"),
    [({"source": "other"}, "a different source of peopleboy"), ({"numpy": "0.1"}, "instead of 0.1")],
)
def test_workers_of_another_version_are_refused(
    tmp_path: Path, cluster: str, monkeypatch: pytest.MonkeyPatch, changed: dict[str, str], why: str
) -> None:
    monkeypatch.setattr(f"{MODULE}.running_source", Ours(changed))
    with refused(f"--scheduler {cluster}", why):
        work(toys(tmp_path, 1), Store(tmp_path / "toys.jsonl", "toys"), Workers(scheduler=cluster))
    assert not diary(tmp_path)


def test_a_worker_with_threads_is_refused(tmp_path: Path) -> None:
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=2, processes=False, dashboard_address="127.0.0.1:0"
        ) as found,
        refused("has 2 threads", "--nthreads 1"),
    ):
        scheduler = Workers(scheduler=found.scheduler_address)
        work(toys(tmp_path, 1), Store(tmp_path / "toys.jsonl", "toys"), scheduler)


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "localhost", "ftp://x:1"])
def test_a_scheduler_that_does_not_answer_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, address: str
) -> None:
    monkeypatch.setattr(f"{MODULE}.CONNECT_S", 0.3)
    with refused(f"--scheduler {address}"):
        work(toys(tmp_path, 1), Store(tmp_path / "u.jsonl", "toys"), Workers(scheduler=address))


@pytest.mark.heavy
def test_a_cluster_finishes_though_one_of_its_two_workers_is_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(f"{MODULE}.WORKERS_S", 5.0)
    address_file = tmp_path / "scheduler.json"
    here = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    scheduler = start("dask_scheduler", *here, "--scheduler-file", str(address_file))
    workers: list[subprocess.Popen[bytes]] = []
    try:
        while not address_file.exists():
            time.sleep(0.05)
        address = json.loads(address_file.read_text(encoding="utf-8"))["address"]
        store = Store(tmp_path / "toys.jsonl", "toys")
        with refused(f"--scheduler {address}", "dask worker"):
            work(toys(tmp_path), store, Workers(scheduler=address))
        workers += [
            start("dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard") for _ in range(2)
        ]
        tasks = toys(tmp_path, 40, takes_s=0.2)
        work([tasks[0], ToyTask(99, tmp_path, deaths=1), *tasks[1:]], store, Workers(scheduler=address))
        assert squares(Store(store.path, "toys")) == {n: n * n for n in (*range(40), 99)}
        assert sum(worker.poll() is not None for worker in workers) == 1
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()


def start(program: str, *arguments: str) -> subprocess.Popen[bytes]:
    """Start one of Dask's programs, able to import the toys."""
    environment = os.environ | {"PYTHONPATH": str(Path(toy_tasks.__file__).parents[3])}
    return subprocess.Popen([sys.executable, "-m", f"distributed.cli.{program}", *arguments], env=environment)
