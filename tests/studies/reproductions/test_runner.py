from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.suite import SuiteRun
from peopleboy.scenarios.running.engine.store import Result
from peopleboy.scenarios.running.engine.task import TasksFailed, Workers
from peopleboy.studies.reproductions.catalogue import EXPERIMENTS, choose
from peopleboy.studies.reproductions.experiment import Experiment, Line, Samples
from peopleboy.studies.reproductions.plan import Plan
from peopleboy.studies.reproductions.runner import MEANS, RESULTS, Means, reproduce
from peopleboy.studies.reproductions.statistics import THESIS
from peopleboy.studies.reproductions.units import Measurement, Unit, open_store, run_units
from tests.studies.reproductions.test_page import read


def throw(number: int, fails_from: int) -> Result:
    """Give its number; from one on it fails."""
    if number >= fails_from:
        raise ValueError("thrown too far")
    return {"AA": 50.0 + number}


def thrown(name: str, fails_from: int) -> Experiment:
    """Make an experiment of one throw in each repeat."""

    def measure(using: Measurement) -> Samples:
        numbers = range(using.plan.repeats)
        units = [Unit(f"throw {number} of {fails_from}", throw, (number, fails_from)) for number in numbers]
        values = [result["AA"] for result in using.results(units)]
        return {Line("both", "default"): {"AA": np.array(values)}}

    return EXPERIMENTS[name].model_copy(update={"measure": measure, "groups": (), "chart": "none"})


SOUND, HALF, BROKEN = thrown("figure-4.8", 10), thrown("figure-5.4", 2), thrown("figure-6.4", 0)


def plan_of(tmp_path: Path, repeats: int) -> Plan:
    return Plan(cache=tmp_path / "films", repeats=repeats)


def test_what_fails_costs_only_what_needs_it_and_the_page_names_that(tmp_path: Path) -> None:
    means = Means(out=tmp_path / "out")
    with pytest.raises(TasksFailed, match=r"(?s)reproduce: 1 of 6 failed.*thrown too far"):
        reproduce([SOUND, HALF], plan_of(tmp_path, 3), means)
    _, shown = reproduce([SOUND, HALF, BROKEN], plan_of(tmp_path, 3), means, so_far=True)
    sections = {part.id: part for part in shown}
    assert {number: part.outcome.repeats for number, part in sections.items()} == {
        "figure-4.8": 3,
        "figure-5.4": 2,
    }
    page = (tmp_path / "out" / "index.html").read_text()
    assert "<dt>Not finished</dt><dd>figure-6.4</dd>" in page
    assert [f"{number} repeats" in page for number in (1, 2, 3)] == [False, True, True]


def test_a_folder_without_anything_finished_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="no table or figure is finished there"):
        reproduce([SOUND], plan_of(tmp_path, 3), Means(out=tmp_path / "out"), so_far=True)


def note(number: int, path: Path) -> Result:
    """Leave a line, and give the number of its process."""
    with path.open("a", encoding="utf-8") as file:
        file.write(f"{number}\n")
    return {"process": os.getpid()}


def note_unit(number: int, path: Path, *, is_timing: bool = False) -> Unit:
    """Make a unit of a note."""
    return Unit(f"note {number}", note, (number, path), is_timing)


def test_what_several_ask_for_is_done_once_and_what_is_there_not_again(tmp_path: Path) -> None:
    notes, path = [note_unit(number, tmp_path / "notes") for number in range(3)], tmp_path / "units.jsonl"
    run_units([*notes, *notes], open_store(path), Workers(1))
    run_units([*notes, note_unit(3, tmp_path / "notes")], open_store(path), Workers(1))
    assert (tmp_path / "notes").read_text() == "0\n1\n2\n3\n"


@pytest.mark.thorough
def test_work_that_measures_time_runs_in_this_process_after_all_others(tmp_path: Path) -> None:
    notes = [note_unit(number, tmp_path / "notes", is_timing=number == 0) for number in range(3)]
    store = open_store(tmp_path / "units.jsonl")
    run_units(notes, store, Workers(2))
    assert (tmp_path / "notes").read_text().splitlines()[-1] == "0"
    assert store["note 0"]["process"] == os.getpid() != store["note 1"]["process"]


def toy_runs() -> Iterator[tuple[str, tuple[SuiteRun, ...]]]:
    pair = SuiteRun(load_scenario("crossing_pair").lasting(1.5), 0)
    single = SuiteRun(load_scenario("single_stationary").lasting(1.5), 0)
    for number, play in enumerate((single, single, pair, pair), 1):
        yield f"dataset{number}", (play,)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("numbers", "units", "says"),
    [
        pytest.param(("4.8",), 5, "figure-4.8", id="one figure"),
        pytest.param(
            ("3.1", "4.1", "4.8", "5.5", "figure-7.3", "paper-table-3"),
            31,
            "Left out of this run: 300, 2000.",
            marks=pytest.mark.thorough,
            id="a little of everything",
        ),
    ],
)
def test_what_is_chosen_becomes_a_page_and_is_done_once(
    numbers: tuple[str, ...], units: int, says: str, tmp_path: Path
) -> None:
    plan = Plan(cache=tmp_path / "films", suites=dict(toy_runs()), repeats=2, is_quick=True, timing_steps=2)
    chosen = choose(numbers)
    page, _ = reproduce(chosen, plan, Means(out=tmp_path))
    assert read(page)[1].ids >= {one.id for one in chosen}
    assert says in page.read_text(encoding="utf-8")
    means = json.loads((tmp_path / MEANS).read_text())
    assert set(means) == {one.id for one in chosen}
    assert means["figure-4.8"]["dataset1"]["default"].keys() == set(THESIS)
    lines = [json.loads(line) for line in (tmp_path / RESULTS).read_text().splitlines()]
    assert sum(line["spent_s"] for line in lines) > 0.0
    done = [line["key"] for line in lines]
    assert len(done) == len(set(done)) >= units
    assert reproduce(chosen, plan, Means(out=tmp_path))[0] == page
    assert len((tmp_path / RESULTS).read_text().splitlines()) == len(done)
