from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from peopleboy.scenarios.running.engine.store import Store
from peopleboy.scenarios.running.engine.task import TasksFailed, Workers, attempt, chosen_workers
from peopleboy.scenarios.running.engine.work_through import work_through
from tests.helpers.calls.processes import start
from tests.helpers.calls.refused import refused
from tests.helpers.runs.toy_tasks import ToyTask, diary, diary_lines, squares, toys, work
from tests.helpers.some_of import some_of

ALL = {number: number**2 for number in range(12)}


def wait_for(what: Callable[[], bool]) -> None:
    until = time.monotonic() + 60.0
    while not what():
        assert time.monotonic() < until
        time.sleep(0.01)


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "toys.jsonl", "toys")


@pytest.mark.slow
def test_one_worker_is_this_process_and_two_are_others(tmp_path: Path, store: Store) -> None:
    work(toys(tmp_path, 3), store, Workers(1))
    assert {process for _, process in diary_lines(tmp_path)} == {os.getpid()}
    work(toys(tmp_path), store, Workers(2))
    assert os.getpid() not in {process for _, process in diary_lines(tmp_path)[3:]}
    assert squares(store) == ALL
    assert set(diary(tmp_path).values()) == {1}


@pytest.mark.parametrize("count", [1, 2])
def test_a_task_that_fails_stops_no_other_and_is_named_with_its_reason(
    tmp_path: Path, store: Store, count: int
) -> None:
    tasks = [*toys(tmp_path, 6), ToyTask(6, tmp_path, fault="wrong"), ToyTask(7, tmp_path, fault="refused")]
    with pytest.raises(TasksFailed) as caught:
        work(tasks[::-1], store, Workers(count))
    assert squares(store) == {number: number**2 for number in range(6)}
    lines = sorted(str(caught.value).splitlines())
    assert lines[0].startswith("  toy 6: ArithmeticError: 6 is wrong (toy_tasks.py, line ")
    assert lines[1:] == [
        "  toy 7: 7 is refused",
        "toys: 2 of 8 failed; the others are complete; run the command again to retry",
    ]


def test_what_every_task_refuses_is_bad_input(tmp_path: Path, store: Store) -> None:
    with refused("0 is refused"):
        work([ToyTask(number, tmp_path, fault="refused") for number in range(2)], store, Workers(1))


@pytest.mark.thorough
def test_a_process_that_is_killed_loses_nothing_and_nothing_is_done_twice(
    tmp_path: Path, store: Store
) -> None:
    tasks = [ToyTask(number, tmp_path, deaths=number == 2) for number in range(12)]
    work(tasks, store, Workers(2))
    assert squares(store) == ALL
    assert len(list(tmp_path.glob("died-*"))) == 1


@pytest.mark.thorough
def test_a_process_that_grows_is_replaced_without_a_word(tmp_path: Path, store: Store) -> None:
    work([ToyTask(number, tmp_path, takes_s=0.3, keeps_mb=400) for number in range(6)], store, Workers(2))
    assert squares(store) == {number: number**2 for number in range(6)}
    assert len({process for _, process in diary_lines(tmp_path)}) > 2


@pytest.mark.thorough
def test_a_task_that_kills_every_process_fails_alone(tmp_path: Path, store: Store) -> None:
    tasks = [ToyTask(number, tmp_path, deaths=99 if number == 0 else 0) for number in range(6)]
    with pytest.raises(TasksFailed, match=r"1 of 6 failed(.|\n)*toy 0: its process was killed 3 times"):
        work(tasks, store, Workers(2))
    assert squares(store) == {number: number**2 for number in range(1, 6)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "code"), some_of([(signal.SIGTERM, 143), (signal.SIGKILL, -9), (signal.SIGINT, -2)], 3)
)
def test_who_is_ended_midway_takes_its_workers_along_and_goes_on_from_there(
    tmp_path: Path, store: Store, number: int, code: int
) -> None:
    command = [sys.executable, "-m", "tests.helpers.runs.toy_tasks", str(tmp_path)]
    ended = start([*command, "0.3", "2"], stderr=subprocess.DEVNULL)
    wait_for(lambda: len(Store(store.path, "toys")) >= 3)
    ended.send_signal(number)
    assert ended.wait() == code
    workers = {process for _, process in diary_lines(tmp_path)}
    wait_for(lambda: not any(Path(f"/proc/{process}").exists() for process in workers))
    kept = Store(store.path, "toys")
    assert 3 <= len(kept) < 12
    work(toys(tmp_path), kept, Workers(1))
    assert squares(Store(store.path, "toys")) == ALL


def test_a_signal_within_a_kernel_ends_the_process_and_is_no_failure_of_the_task() -> None:
    def work_in_kernel(_: object) -> None:
        try:
            raise SystemExit(143)
        except SystemExit as leaving:
            raise SystemError("a kernel returned a result with an exception set") from leaving

    with pytest.raises(SystemExit) as caught:
        attempt(work_in_kernel, lambda _: None)  # type: ignore[arg-type]
    assert caught.value.code == 143


def test_the_bar_tells_done_left_and_failed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[tuple[int, int, str]] = []

    class Bar:
        def __enter__(self) -> Callable[[int, int, str], None]:
            return lambda *told: shown.append(told)

        def __exit__(self, *_: object) -> None:
            pass

    monkeypatch.setattr(
        "peopleboy.scenarios.running.engine.work_through.progress_bar", lambda _title, _unit: Bar()
    )
    tasks = [ToyTask(0, tmp_path, fault="wrong", size=4), ToyTask(1, tmp_path, size=8)]
    with pytest.raises(TasksFailed):
        work_through(tasks, Workers(1), "toys")
    assert shown == [
        (4, 12, "0 done, 1 left, 1 failed"),
        (5, 12, "0 done, 1 left, 1 failed"),
        (12, 12, "1 done, 0 left, 1 failed"),
    ]


def test_a_cluster_takes_no_number_of_workers() -> None:
    assert chosen_workers(3, None) == Workers(3)
    assert chosen_workers(None, "tcp://here:1").scheduler == "tcp://here:1"
    with refused("--workers 3", "--scheduler"):
        chosen_workers(3, "tcp://here:1")
