"""Runs of one tracker are taken together, those of several are compared pair by pair and never pooled."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from peopleboy.scenarios.scores.bootstrap import bootstrap
from peopleboy.scenarios.scores.by_tracker import ScoredRun, check_same_scenes, differences
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.runs import toy_runs as toy
from tests.helpers.runs.exported import SCENE, make_run

FRAMES = 20


def found(count: int) -> Scores:
    """One person who is found in so many of the frames."""
    frame, found = np.arange(1, FRAMES + 1), np.arange(1, count + 1)
    truth = TrueBoxes(
        frame=frame,
        id=np.ones(FRAMES),
        box=np.tile([9.0, 9.0, 9.0, 9.0], (FRAMES, 1)),
        counted=np.ones(FRAMES),
        visible=np.ones(FRAMES),
    )
    tracks = TrackBoxes(
        frame=found, id=np.ones(count), box=np.tile([9.0] * 4, (count, 1)), confidence=np.ones(count)
    )
    return evaluate(truth, tracks, frames=FRAMES)


def runs(tracker: str, **counts: int) -> list[ScoredRun]:
    return [ScoredRun(name, tracker, (name[0], int(name[1])), found(count)) for name, count in counts.items()]


def test_a_difference_is_over_the_scenes_that_both_saw_with_the_interval_of_the_pairs() -> None:
    groups = {
        "ours": runs("ours", a0=10, a1=12, a2=14, b0=20),
        "theirs": runs("theirs", a2=20, a0=12, a1=16, c0=1),
    }
    (one,) = differences(groups)
    assert (one.tracker, one.other, one.pairs) == ("theirs", "ours", 3)
    expected = bootstrap([10.0, 20.0, 30.0], np.random.default_rng(0))
    apart = one.figures["CR"]
    assert apart.interval.mean == pytest.approx(20.0)
    assert (apart.interval.low, apart.interval.high) == pytest.approx((expected.low, expected.high), abs=2.0)
    assert 10.0 - 1e-9 <= apart.interval.low < 20.0 < apart.interval.high <= 30.0 + 1e-9
    assert apart.p == pytest.approx(2 / 2**3)  # all three differ in one direction: one of 8 signs, two-sided


def test_a_scene_that_a_tracker_saw_twice_has_no_pair() -> None:
    groups = {"ours": runs("ours", a0=10) + runs("ours", a0=12), "theirs": runs("theirs", a0=12)}
    (one,) = differences(groups)
    assert one.pairs == 0
    assert np.isnan(one.figures["CR"].interval.mean)
    assert np.isnan(one.figures["CR"].p)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs of one tracker, one of another."""
    folder = tmp_path_factory.mktemp("trackers")
    scene = SCENE | {"duration_s": 1.0}
    for name, options in {
        "one": ("--seed", "0"),
        "two": ("--seed", "1"),
        "true": ("--seed", "1", "--tracker", "truth"),
    }.items():
        make_run(scene, folder / name, *options)
    return folder


@pytest.mark.slow
def test_runs_of_one_tracker_are_pooled_and_those_of_two_stand_side_by_side(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert run_cli("evaluate", folder / "one", folder / "two") == 0
    assert "people, 2 runs of detection" in capsys.readouterr().out
    assert run_cli("evaluate", folder / "one", folder / "two", folder / "true") == 0
    told = capsys.readouterr().out
    for part in (
        "detection, 2 runs",
        "truth, 1 run",
        "truth - detection, 1 pair",
        "one pair has no interval",
    ):
        assert part in told
    assert "mean of runs" not in told
    assert run_cli("evaluate", folder / "one", folder / "true") == 0
    assert "No two runs have the same scenario and seed" in capsys.readouterr().out


def document(capsys: pytest.CaptureFixture[str], *arguments: object) -> Any:
    """Give the one JSON document that a command prints."""
    capsys.readouterr()
    assert run_cli(*arguments, "--json") == 0
    told = capsys.readouterr()
    assert told.err == ""
    return json.loads(told.out)


def test_figures_as_json_are_those_of_metrics_json(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = document(capsys, "evaluate", folder / "two", folder / "true")
    for name, tracker in (("two", "detection"), ("true", "truth")):
        metrics = json.loads((folder / name / "metrics.json").read_text(encoding="utf-8"))
        (run,) = told["trackers"][tracker]["runs"]
        assert (run["run"], run["scene"], run["seed"]) == (str(folder / name), "tiny", 1)
        assert run["metrics"]["thesis"] == metrics["thesis"]
        assert told["trackers"][tracker]["all_frames"]["mot"] == metrics["mot"]
    (apart,) = told["differences"]
    assert (apart["tracker"], apart["from"], apart["pairs"]) == ("truth", "detection", 1)
    theirs, ours = (
        told["trackers"][tracker]["all_frames"]["thesis"]["CR_percent"] for tracker in ("truth", "detection")
    )
    mean, low, high = apart["metrics"]["CR_percent"]
    assert (mean, low, high) == (pytest.approx(theirs - ours), None, None)
    files = ("--truth", folder / "two" / "truth" / "gt.txt", "--tracks", folder / "two" / "tracks.txt")
    (alone,) = document(capsys, "evaluate", *files)["trackers"].values()
    assert alone["all_frames"]["thesis"] == told["trackers"]["detection"]["all_frames"]["thesis"]


@pytest.mark.thorough
def test_run_sweep_and_compare_print_one_document_or_nothing(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = folder / "tiny.yaml"
    told = document(capsys, "run", scene, "--tracker", "truth", "--out", tmp_path / "run", "--no-recording")
    assert told["metrics"] == json.loads((tmp_path / "run" / "metrics.json").read_text(encoding="utf-8"))
    assert (told["scenario"], told["seed"], told["tracker"]) == ("tiny", 0, "truth")
    many = ("--seeds", "1", "--workers", "1", "--out", tmp_path / "many")
    swept = document(capsys, "sweep", scene, "--tracker", "truth", *many)
    assert swept["trackers"]["truth"]["all_frames"]["thesis"] == told["metrics"]["thesis"]
    compare = ("compare", "--controllers", "follow_person@truth", scene, *many)
    (compared,) = document(capsys, *compare)["comparisons"]
    assert compared["scenario"] == "tiny"
    for command in (("sweep", scene, "--tracker", "truth", *many), compare, ("evaluate", folder / "one")):
        assert run_cli(*command, "--quiet") == 0
        told = capsys.readouterr()
        assert (told.out, told.err) == ("", "")


TOY_SCENE: dict[str, Any] = {
    "name": "toy",
    "description": "Two people stand.",
    "duration_s": 6.0,
    "place": {"kind": "room", "length_m": 8.0, "width_m": 6.0},
    "people": [{"name": "anna", "path": [{"at_m": [4.0, 0.0]}]}],
    "robot": {"at_m": [1.0, 0.0], "behaviour": "stand", "cameras": {}},
}
REAR = {"rear": {"kind": "colour"}}


def write(folder: Path, scene: dict[str, Any], **about: Any) -> dict[Path, tuple[str, int] | None]:
    """Leave what the check reads of a run."""
    folder.mkdir()
    (folder / "scenario.yaml").write_text(yaml.safe_dump(scene), encoding="utf-8")
    run = {"status": "complete", "frames": 90} | about
    (folder / "run.json").write_text(json.dumps(run), encoding="utf-8")
    return {folder: ("toy", 0)}


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"duration_s": 5.0}, "duration_s is 5.0, not 6.0"),
        ({"people": [{"name": "anna", "path": [{"at_m": [4.5, 0.0]}]}]}, "people[0].path[0].at_m[0] is 4.5"),
        ({"people": []}, "people is a list of 0, not a list of 1"),
        ({"lights": []}, "lights is a list of 0, not left out"),
        ({"robot": TOY_SCENE["robot"] | {"cameras": REAR}}, "robot.cameras.rear is {"),
    ],
)
def test_an_edited_scenario_of_the_same_name_is_refused(
    tmp_path: Path, change: dict[str, Any], says: str
) -> None:
    one, other = write(tmp_path / "one", TOY_SCENE), write(tmp_path / "other", TOY_SCENE | change)
    with refused(f"{tmp_path / 'other'}: ", f"{tmp_path / 'one'}: ", "toy, seed 0", says):
        check_same_scenes([one, other])
    check_same_scenes([one | other])  # of one tracker they are pooled, whatever it saw


def test_what_an_option_of_run_changes_makes_no_other_scene(tmp_path: Path) -> None:
    played = TOY_SCENE | {
        "description": "Two people stood.",
        "physics": "kinematic",
        "drawn": {"seed": 0, "versions": {"numpy": "1"}},
        "robot": TOY_SCENE["robot"] | {"behaviour": "patrol", "cameras": REAR},
    }
    one = write(tmp_path / "one", TOY_SCENE)
    check_same_scenes([one, write(tmp_path / "other", played, mounted_for_tracker=["rear"])])
    (seed,) = write(tmp_path / "seed", TOY_SCENE | {"duration_s": 9.0})
    check_same_scenes([one, {seed: ("toy", 1)}])
    check_same_scenes([one, write(tmp_path / "spoilt", {"name": "toy"})])


@pytest.mark.slow
def test_evaluate_and_report_look_at_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one = toy.write_run(tmp_path / "one", scenario=TOY_SCENE)
    other = toy.write_run(tmp_path / "other", scenario=TOY_SCENE | {"duration_s": 5.0}, tracker="mine")
    for command in (("evaluate",), ("report", "--out", tmp_path / "page.html")):
        assert_names(refusal(capsys, *command, one, other), "duration_s is 5.0, not 6.0")
    assert not (tmp_path / "page.html").exists()
    assert run_cli("evaluate", one) == 0
