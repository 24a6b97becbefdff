from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import pytest

from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.studies.reproductions.measuring.run_units import open_store, run_units


@dataclass(frozen=True, slots=True)
class Note:
    """Leaves a line, and gives the number of its process."""

    number: int
    path: Path
    is_timing: bool = False

    @property
    def key(self) -> str:
        return f"note {self.number}"

    def run(self) -> Result:
        with self.path.open("a", encoding="utf-8") as file:
            file.write(f"{self.number}\n")
        return {"process": os.getpid()}


def test_what_several_ask_for_is_done_once_and_what_is_there_not_again(tmp_path: Path) -> None:
    notes, path = [Note(number, tmp_path / "notes") for number in range(3)], tmp_path / "units.jsonl"
    run_units([*notes, *notes], open_store(path), Workers(1))
    run_units([*notes, Note(3, tmp_path / "notes")], open_store(path), Workers(1))
    assert (tmp_path / "notes").read_text() == "0\n1\n2\n3\n"


@pytest.mark.thorough
def test_work_that_measures_time_runs_in_this_process_after_all_others(tmp_path: Path) -> None:
    notes = [Note(number, tmp_path / "notes", is_timing=number == 0) for number in range(3)]
    store = open_store(tmp_path / "units.jsonl")
    run_units(notes, store, Workers(2))
    assert (tmp_path / "notes").read_text().splitlines()[-1] == "0"
    assert store["note 0"]["process"] == os.getpid() != store["note 1"]["process"]
