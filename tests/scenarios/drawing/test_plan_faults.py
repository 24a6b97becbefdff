from pathlib import Path

import cv2
import pytest
import yaml

from tests.helpers.calls.command_line import run_cli

SCENE = {
    "name": "faulty",
    "description": "A person who walks into a wall.",
    "duration_s": 5.0,
    "place": {"kind": "room", "length_m": 8.0, "width_m": 6.0},
    "people": [{"name": "anna", "path": [{"at_m": [3.0, 1.0]}, {"at_m": [5.0, 9.0]}]}],
    "robot": {"at_m": [1.0, 0.0]},
}


def reds(path: Path) -> int:
    """Count the pixels of the colour that marks faults."""
    return int((cv2.imread(str(path)) == (0, 0, 224)).all(axis=2).sum())


def test_a_refused_scenario_is_drawn_with_its_faults_marked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, plan = tmp_path / "faulty.yaml", tmp_path / "plan.png"
    file.write_text(yaml.safe_dump(SCENE), encoding="utf-8")
    assert run_cli("show", file, "--out", plan) == 2
    drawn, fault = capsys.readouterr().err.splitlines()
    assert str(plan) in drawn
    assert "people[0].path[1].at_m: (5, 9) is outside the floor" in fault
    assert reds(plan) > 100
    good = SCENE | {"people": [{"name": "anna", "path": [{"at_m": [3.0, 1.0]}, {"at_m": [5.0, 2.0]}]}]}
    file.write_text(yaml.safe_dump(good), encoding="utf-8")
    assert run_cli("show", file, "--out", plan) == 0
    assert reds(plan) < 20


def test_a_file_that_is_no_scenario_is_refused_without_a_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "faulty.yaml"
    file.write_text(yaml.safe_dump(SCENE | {"duration_s": "long"}), encoding="utf-8")
    assert run_cli("show", file, "--out", tmp_path / "plan.png") == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not (tmp_path / "plan.png").exists()
