from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from peopleboy.scenarios.studies.reproduce.measuring.store import Store
from peopleboy.scenarios.studies.reproduce.measuring.workers import run_units
from tests.helpers.calls.refused import refused
from tests.helpers.runs import toy_units
from tests.helpers.runs.toy_units import ToyUnit, diary, no_report, toys


def squares(store: Store) -> dict[int, int]:
    return {int(key.split()[1]): result["square"] for key, result in store.items()}


def test_results_are_there_again_when_the_store_is_opened_again(tmp_path: Path) -> None:
    store = Store(tmp_path / "deep" / "units.jsonl")
    run_units(toys(tmp_path), store, 1, None, no_report)
    assert squares(Store(store.path)) == squares(store) == {n: n * n for n in range(12)}


def test_a_line_that_was_cut_off_is_done_again_and_harms_no_other(tmp_path: Path) -> None:
    path = tmp_path / "units.jsonl"
    run_units(toys(tmp_path, 5), Store(path), 1, None, no_report)
    path.write_bytes(path.read_bytes()[:-9])
    store = Store(path)
    assert len(store) == 4
    run_units(toys(tmp_path, 5), store, 1, None, no_report)
    assert squares(Store(path)) == {n: n * n for n in range(5)}
    assert diary(tmp_path) == {0: 1, 1: 1, 2: 1, 3: 1, 4: 2}


def test_results_of_another_version_of_the_code_are_not_used(tmp_path: Path) -> None:
    path = tmp_path / "units.jsonl"
    path.write_text(json.dumps({"key": "toy 0", "code": "older", "result": {"square": -1}}) + "\n")
    assert len(Store(path)) == 0


def test_what_several_ask_for_is_done_once(tmp_path: Path) -> None:
    run_units([*toys(tmp_path, 3), *toys(tmp_path, 3)], Store(tmp_path / "u.jsonl"), 1, None, no_report)
    assert diary(tmp_path) == {0: 1, 1: 1, 2: 1}


def test_who_is_killed_midway_goes_on_from_there_and_runs_nothing_twice(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.helpers.runs.toy_units", str(tmp_path)]
    killed = subprocess.Popen([*command, "0.2"])
    path = tmp_path / "units.jsonl"
    while not path.exists() or len(path.read_text(encoding="utf-8").splitlines()) < 3:
        time.sleep(0.01)
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    kept = squares(Store(path))
    assert 3 <= len(kept) < 12
    subprocess.run([*command, "0"], check=True)
    assert squares(Store(path)) == {n: n * n for n in range(12)}
    assert all(diary(tmp_path)[number] == 1 for number in kept)


def test_a_worker_that_is_killed_loses_nothing(tmp_path: Path) -> None:
    units = [ToyUnit(number, tmp_path, dies=number == 2) for number in range(6)]
    store = Store(tmp_path / "units.jsonl")
    run_units(units, store, 2, None, no_report)
    assert squares(store) == {n: n * n for n in range(6)}


def test_work_that_measures_time_runs_in_this_process_after_all_others(tmp_path: Path) -> None:
    units = [ToyUnit(0, tmp_path, is_timing=True), *toys(tmp_path, 3)[1:]]
    run_units(units, Store(tmp_path / "units.jsonl"), 2, None, no_report)
    last = (tmp_path / "diary").read_text(encoding="utf-8").splitlines()[-1]
    assert last == f"0 {os.getpid()}"


def test_a_mistake_in_the_work_is_not_tried_again(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        run_units([ToyUnit(0, tmp_path / "absent")], Store(tmp_path / "u.jsonl"), 1, None, no_report)


def test_a_scheduler_that_does_not_answer_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("peopleboy.scenarios.studies.reproduce.measuring.workers.CONNECT_S", 0.3)
    with refused("--scheduler tcp://127.0.0.1:9"):
        run_units(toys(tmp_path), Store(tmp_path / "u.jsonl"), 1, "tcp://127.0.0.1:9", no_report)


@pytest.mark.heavy
@pytest.mark.filterwarnings("default")
def test_a_cluster_finishes_though_one_of_its_two_workers_is_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("peopleboy.scenarios.studies.reproduce.measuring.workers.CONNECT_S", 5.0)
    address_file = tmp_path / "scheduler.json"
    here = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
    scheduler = start("dask_scheduler", *here, "--scheduler-file", str(address_file))
    workers: list[subprocess.Popen[bytes]] = []
    try:
        while not address_file.exists():
            time.sleep(0.05)
        address = json.loads(address_file.read_text(encoding="utf-8"))["address"]
        with refused(f"--scheduler {address}", "dask worker"):
            run_units(toys(tmp_path), Store(tmp_path / "none.jsonl"), -1, address, no_report)
        workers += [
            start("dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard") for _ in range(2)
        ]
        store = Store(tmp_path / "units.jsonl")

        def kill_one(finished: int, _total: int, _last: str) -> None:
            if finished == 5:
                workers[0].send_signal(signal.SIGKILL)

        run_units(toys(tmp_path, 40, takes_s=0.2), store, -1, address, kill_one)
        assert squares(Store(store.path)) == {n: n * n for n in range(40)}
        assert workers[0].wait(10) != 0
    finally:
        for process in (*workers, scheduler):
            process.kill()
            process.wait()


def start(program: str, *arguments: str) -> subprocess.Popen[bytes]:
    """Start one of Dask's programs, able to import the toys."""
    environment = os.environ | {"PYTHONPATH": str(Path(toy_units.__file__).parents[3])}
    return subprocess.Popen([sys.executable, "-m", f"distributed.cli.{program}", *arguments], env=environment)
