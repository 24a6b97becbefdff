"""Runs of scenes that only share a name and seed are not compared."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from peopleboy.scenarios.scores.same_scenes import check_same_scenes
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.runs import toy_runs as toy

SCENE: dict[str, Any] = {
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
        ({"robot": SCENE["robot"] | {"cameras": REAR}}, "robot.cameras.rear is {"),
    ],
)
def test_an_edited_scenario_of_the_same_name_is_refused(
    tmp_path: Path, change: dict[str, Any], says: str
) -> None:
    one, other = write(tmp_path / "one", SCENE), write(tmp_path / "other", SCENE | change)
    with refused(f"{tmp_path / 'other'}: ", f"{tmp_path / 'one'}: ", "toy, seed 0", says):
        check_same_scenes([one, other])
    check_same_scenes([one | other])  # of one tracker they are pooled, whatever it saw


def test_what_an_option_of_run_changes_makes_no_other_scene(tmp_path: Path) -> None:
    played = SCENE | {
        "description": "Two people stood.",
        "physics": "kinematic",
        "drawn": {"seed": 0, "versions": {"numpy": "1"}},
        "robot": SCENE["robot"] | {"behaviour": "patrol", "cameras": REAR},
    }
    one = write(tmp_path / "one", SCENE)
    check_same_scenes([one, write(tmp_path / "other", played, mounted_for_tracker=["rear"])])
    (seed,) = write(tmp_path / "seed", SCENE | {"duration_s": 9.0})
    check_same_scenes([one, {seed: ("toy", 1)}])
    check_same_scenes([one, write(tmp_path / "spoilt", {"name": "toy"})])


@pytest.mark.slow
def test_evaluate_and_report_look_at_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one = toy.write_run(tmp_path / "one", scenario=SCENE)
    other = toy.write_run(tmp_path / "other", scenario=SCENE | {"duration_s": 5.0}, tracker="mine")
    for command in (("evaluate",), ("report", "--out", tmp_path / "page.html")):
        assert_names(refusal(capsys, *command, one, other), "duration_s is 5.0, not 6.0")
    assert not (tmp_path / "page.html").exists()
    assert run_cli("evaluate", one) == 0
