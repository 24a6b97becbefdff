from __future__ import annotations

import json
from pathlib import Path

from peopleboy.scenarios.running.engine.store import Store


def test_results_are_there_again_when_the_store_is_opened_again(tmp_path: Path) -> None:
    store = Store(tmp_path / "deep" / "results.jsonl", "code")
    third = {"third": 1 / 3}
    store.add("one", third)
    store.add("two", {})
    assert dict(Store(store.path, "code")) == dict(store) == {"one": third, "two": {}}


def test_a_line_that_was_cut_off_is_missing_and_harms_no_other(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    store = Store(path, "code")
    for number in range(3):
        store.add(str(number), {})
    path.write_bytes(path.read_bytes()[:-9])
    again = Store(path, "code")
    assert list(again) == ["0", "1"]
    again.add("2", {})
    assert list(Store(path, "code")) == ["0", "1", "2"]


def test_results_of_another_version_of_the_code_are_not_used(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    path.write_text(json.dumps({"key": "toy 0", "code": "older", "result": {"square": -1}}) + "\n")
    assert len(Store(path, "newer")) == 0
