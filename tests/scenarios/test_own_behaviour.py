"""A behaviour of one's own drives in run, sweep and compare; its mistakes are told as those of trackers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml

from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.compare_controllers import Controller, parse_controller
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.percepts.percepts import free
from tests.helpers.runs.exported import FOLLOWING

BRIEF: dict[str, Any] = FOLLOWING | {"name": "brief", "duration_s": 1.0, "faults": []}
CREEPER = """\
from peopleboy import Command


class Creeper:
    mode, reason, following = "creep", "", None

    def __init__(self):
        self.sights = 0

    def command(self, percept):
        self.sights += 1
        if self.sights < 3:
            return Command(linear_m_s=0.1, angular_rad_s=0.0)
        return ANSWER
"""
GOOD = "Command(linear_m_s=0.1, angular_rad_s=0.0)"


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a scenario, in which the user is."""
    (tmp_path / "brief.yaml").write_text(yaml.safe_dump(BRIEF), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write_creeper(home: Path, module: str, answer: str = GOOD) -> str:
    (home / f"{module}.py").write_text(CREEPER.replace("ANSWER", answer), encoding="utf-8")
    return f"{module}:Creeper"


def about(folder: Path) -> dict[str, Any]:
    said: dict[str, Any] = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    return said


@pytest.mark.slow
def test_it_drives_a_run_which_is_scored_and_reported_as_others_are(home: Path) -> None:
    name = write_creeper(home, "creeper_run")
    assert run_cli("run", "brief.yaml", "--behaviour", name, "--tracker", "truth", "--no-recording") == 0
    folder = home / "runs" / "brief-0-truth-creeper_run.Creeper"
    assert about(folder)["behaviour"] == name
    robot = pq.read_table(folder / "robot.parquet")
    assert set(robot["mode"].to_pylist()) == {"creep"}
    np.testing.assert_allclose(robot["command_linear_m_s"].to_numpy(), 0.1)
    assert "followed" in json.loads((folder / "metrics.json").read_text(encoding="utf-8"))["following"]
    assert run_cli("evaluate", folder) == 0
    assert run_cli("report", folder) == 0
    # Its scenario stays data.
    assert "Creeper" not in (folder / "scenario.yaml").read_text(encoding="utf-8")
    assert load_scenario(folder / "scenario.yaml").robot.behaviour == "follow_person"


def test_one_in_a_scenario_file_is_refused_as_any_code_is(home: Path) -> None:
    name = write_creeper(home, "creeper_file")
    scene = BRIEF | {"robot": BRIEF["robot"] | {"behaviour": name}}
    (home / "code.yaml").write_text(yaml.safe_dump(scene), encoding="utf-8")
    with refused("code.yaml", "robot.behaviour", name):
        load_scenario(home / "code.yaml")


def test_a_sweep_with_it_goes_on_and_is_none_with_another(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write_creeper(home, "creeper_sweep")
    options = ("brief.yaml", "--tracker", "truth", "--workers", "1", "--seeds", "1", "--out", "runs")
    assert run_cli("sweep", *options, "--behaviour", name) == 0
    first = (home / "runs" / "brief-0" / "run.json").stat().st_mtime_ns
    assert run_cli("sweep", *options, "--behaviour", name) == 0
    assert (home / "runs" / "brief-0" / "run.json").stat().st_mtime_ns == first
    assert_names(refusal(capsys, "sweep", *options), "brief-0", f"behaviour '{name}'", "--overwrite")


@pytest.mark.slow
def test_it_is_compared_with_others_by_the_scenario_s_own_task(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write_creeper(home, "creeper_compare")
    controllers = f"follow_person@truth,{name}@truth"
    options = ("brief.yaml", "--seeds", "1", "--workers", "1", "--out", "compared")
    assert run_cli("compare", "--controllers", controllers, *options) == 0
    assert f"{name}@truth" in capsys.readouterr().out
    kept = json.loads((home / "compared" / "brief" / "comparison.json").read_text(encoding="utf-8"))
    theirs, ours = (kept["controllers"][f"{who}@truth"]["mean"] for who in (name, "follow_person"))
    assert theirs.keys() >= ours.keys()  # comfort is that of a robot that moves
    assert theirs["mean_distance_error_m"] != ours["mean_distance_error_m"]
    assert parse_controller(f"{name}@truth") == Controller(name, "truth")


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        ("None", ("must return a Command", "None")),
        ("Command(linear_m_s=float('nan'), angular_rad_s=0.0)", ("finite", "nan")),
        (
            "setattr(self, 'following', 'anna') or Command(linear_m_s=0.0, angular_rad_s=0.0)",
            ("'anna'", "id"),
        ),
        ("setattr(self, 'mode', None) or Command(linear_m_s=0.0, angular_rad_s=0.0)", ("mode", "None")),
        ("setattr(self, 'mode', 'a\\nb') or Command(linear_m_s=0.0, angular_rad_s=0.0)", ("mode", "word")),
        (
            "setattr(self, 'following', 999) or Command(linear_m_s=0.0, angular_rad_s=0.0)",
            ("999", "the id of a track that there was, 1"),
        ),
    ],
)
def test_a_wrong_value_is_told_in_a_line(
    answer: str, says: tuple[str, ...], home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write_creeper(home, f"wrong_creeper_{len(answer)}", answer)
    told = refusal(capsys, "run", "brief.yaml", "--behaviour", name, "--tracker", "truth", "--out", "run")
    assert_names(told, f"frame 3: behaviour '{name}': ", *says)
    assert about(home / "run")["status"] == "failed"


def test_an_error_of_it_ends_the_run_in_a_marked_folder_with_its_traceback(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write_creeper(home, "creeper_fails", "percept.nothing")
    options = ("--behaviour", name, "--tracker", "truth", "--no-recording", "--out", "run")
    assert run_cli("run", "brief.yaml", *options) == 1
    told = capsys.readouterr().err
    assert_names(told, f"frame 3: behaviour '{name}' failed", "creeper_fails.py, line 14", "run/run.json")
    assert "return percept.nothing" in about(home / "run")["error"]["traceback"]


def test_what_is_no_behaviour_is_refused_and_what_is_one_is_under_guard(home: Path) -> None:
    (home / "no_behaviour.py").write_text(
        "class Some:\n    def command(self, percept): pass\ndef two(a, b): pass\n", encoding="utf-8"
    )
    for name, wrong in [("Some", "`following`"), ("two", "without an argument"), ("None", "'None'")]:
        with refused(f"behaviour 'no_behaviour:{name}'", wrong):
            make_behaviour(f"no_behaviour:{name}")
    name = write_creeper(home, "creeper_guarded", "Command(linear_m_s=9.0, angular_rad_s=0.0)")
    behaviour = make_behaviour(name)
    for _ in range(4):
        command = behaviour.command(free())
    assert command.linear_m_s < 1.0
    assert behaviour.is_limited


def test_suites_keep_their_own_drives(capsys: pytest.CaptureFixture[str]) -> None:
    assert_names(refusal(capsys, "run", "dataset1", "--behaviour", "stand"), "--behaviour stand", "dataset1")
