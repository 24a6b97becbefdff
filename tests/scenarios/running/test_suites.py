from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest
from click.testing import CliRunner

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.cli import cli
from peopleboy.scenarios.files import library as listed
from peopleboy.scenarios.files import suite as suites
from peopleboy.scenarios.files.library import suite_names
from peopleboy.scenarios.files.suite import EntrySpec, SuiteSpec, load_suite, runs_of, scenarios_of
from peopleboy.scenarios.running import many_runs as module
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.scenarios.running.many_runs import run_suite
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.suite_table import THESIS, Content, add_up, count
from peopleboy.studies.reproductions.runner import count_suite
from tests.helpers.calls.refused import refused

TINY = SuiteSpec(
    name="tiny",
    description="Two short runs.",
    runs=(EntrySpec(scenario="crossing_2", seeds=(0, 1), duration_s=0.6),),
)


@pytest.mark.parametrize("name", suite_names())
def test_every_run_of_a_suite_is_there(name: str) -> None:
    runs = list(runs_of(load_suite(name)))
    assert len({run.name for run in runs}) == len(runs)


@pytest.mark.parametrize("name", list(THESIS))
def test_data_sets_are_as_long_as_those_of_the_thesis(name: str) -> None:
    frames = sum(round(run.scenario.duration_s * 15) for run in runs_of(load_suite(name)))
    assert frames == pytest.approx(THESIS[name].frames, rel=0.01)


@pytest.mark.heavy
@pytest.mark.parametrize("name", list(THESIS))
def test_data_sets_hold_what_those_of_the_thesis_hold_within_5_percent(name: str, tmp_path: Path) -> None:
    ours, theirs = asdict(count_suite(name, tmp_path)), asdict(THESIS[name])
    if theirs["at_once"] == 1:
        del ours["occlusions"]  # the thesis counts none for single persons
    for key, value in ours.items():
        assert value == pytest.approx(theirs[key], rel=0.05), key


def test_counts_agree_with_counting_by_hand(tmp_path: Path) -> None:
    shot = module.film(next(iter(runs_of(TINY))).scenario, 0, tmp_path)
    assert count(shot.people(), shot.frames, 15.0) == Content(
        frames_with_persons=9, frames=9, tracks=2, detections=18, occlusions=0, at_once=2
    )
    two = [count(shot.people(), shot.frames, 15.0)] * 2
    assert add_up(two).detections == 36
    assert add_up(two).at_once == 2


@pytest.fixture
def tiny(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "load_suite", lambda _: TINY)
    monkeypatch.setattr(suites, "suite_names", lambda: ["tiny"])


@pytest.mark.slow
@pytest.mark.usefixtures("tiny")
def test_a_suite_skips_complete_runs_and_redoes_those_that_were_cut_off(tmp_path: Path) -> None:
    options = RunOptions(seed=0, out=tmp_path)
    first, second = run_suite("tiny", options, Workers())
    made = [path.stat().st_mtime_ns for path in (first / "tracks.txt", second / "tracks.txt")]
    about = json.loads((second / "run.json").read_text())
    (second / "run.json").write_text(json.dumps(about | {"status": "running"}))  # as a killed run leaves it
    assert run_suite("tiny", options, Workers()) == [first, second]
    assert (first / "tracks.txt").stat().st_mtime_ns == made[0]
    assert (second / "tracks.txt").stat().st_mtime_ns > made[1]
    assert json.loads((second / "run.json").read_text())["status"] == "complete"
    with refused(first, "'detection'"):
        run_suite("tiny", RunOptions(seed=0, out=tmp_path, tracker="thesis"), Workers())


def test_a_suite_stands_for_its_scenarios_among_others_each_once(tmp_path: Path) -> None:
    of_suite = {one.scenario.name for one in runs_of(load_suite("dataset3"), with_drives=False)}
    names = [one.name for one in scenarios_of(["crossing_2", "dataset3", "crossing_2"])]
    assert set(names) == of_suite | {"crossing_2"}
    assert len(names) == len(set(names))
    other = tmp_path / "other.yaml"
    other.write_text("name: crossing_2\ndescription: Another one.\nlike: crossing_3\n", encoding="utf-8")
    with refused("crossing_2", "another scenario is also called"):
        scenarios_of(["crossing_2", str(other)])


def test_an_unknown_suite_or_data_set_is_refused() -> None:
    with refused("'datset1'", "'dataset1'"):
        load_suite("datset1")
    for command in (["datasets", "dataset9"], ["run", "dataset1", "--seed", "1"]):
        assert isinstance(CliRunner().invoke(cli, command).exception, BadInput)


def test_a_suite_file_with_a_mistake_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "odd.yaml").write_text(
        "name: odd\ndescription: x\nruns: [{scenario: crossing_2, seed: [0]}]\n"
    )
    for home in (suites, listed):
        monkeypatch.setattr(home, "SUITES", tmp_path)
    with refused("suites/odd.yaml", "'seed'", "'seeds'"):
        load_suite("odd")
