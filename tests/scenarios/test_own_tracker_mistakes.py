"""What a user is told whose tracker raises an error, or gives what cannot be used."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from peopleboy.own_code import load_own
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.run_folder.finished_run import read_run
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names, refused
from tests.helpers.runs.exported import SCENE
from tests.helpers.some_of import some_of

BRIEF: dict[str, Any] = SCENE | {"name": "brief", "duration_s": 0.5}
TRACKER = """\
import numpy as np
from peopleboy.tracker.track import FloorPlace, Status, Track


def track(**changes):
    usual = dict(id=1, boxes={"thermal": (9, 9, 20, 40)}, confidence=1.0, status=Status.TRACKED, age_s=0.0)
    return Track(**(usual | changes))


class Mine:
    cameras = ("thermal",)

    def __init__(self, rng):
        self.frames = 0

    def update(self, frame):
        self.frames += 1
        return (track(),) if self.frames < 3 else self.answer(frame)

    def answer(self, frame):
        return ANSWER
"""
WRONG = {
    "None": ("tuple of Track", "NoneType"),
    "[track()]": ("tuple of Track", "list"),
    "(1,)": ("tuple of Track", "int"),
    "(track(id=0),)": ("from 1", "0"),
    "(track(id=1.5),)": ("whole number", "1.5"),
    "(track(id=True),)": ("whole number", "True"),
    "(track(id=2**70),)": ("whole number", str(2**53), str(2**70)),
    "(track(age_s=-1.0),)": ("seconds from 0", "-1.0"),
    "(track(occluder=0),)": ("id of a track", "0"),
    "(track(place=(4.0, 1.0)),)": ("FloorPlace", "(4.0, 1.0)"),
    "(track(place=FloorPlace(position_m=(1.0, 0.0), covariance_m2=(1.0, 2.0, 1.0))),)": ("xx >= 0", "2.0"),
    "(track(id=7), track(id=7))": ("differ", "7 twice"),
    "(track(boxes={'thermal': (0, 0, float('nan'), 5)}),)": ("track 1", "'thermal'", "finite", "nan"),
    "(track(boxes={'thermal': (0, 0, -1, 5)}),)": ("width >= 0", "-1"),
    "(track(boxes={'thermal': (2e6, 0, 5, 5)}),)": ("'thermal'", "1e+06 pixels", "2000000.0"),
    "(track(boxes={'thermal': (0, 0, 5)}),)": ("left, top, width", "(0, 0, 5)"),
    "(track(boxes={'thermal': np.arange(4)}),)": ("must be a tuple", "[0 1 2 3]"),
    "(track(boxes=(0, 0, 5, 5)),)": ("by camera",),
    "(track(boxes={'rear': (0, 0, 5, 5)}),)": ("'rear'", "colour, thermal"),
    "(track(confidence=float('inf')),)": ("from 0 to 1", "inf"),
    "(track(confidence='sure'),)": ("from 0 to 1", "'sure'"),
    "(track(status='tracked'),)": ("Status.TRACKED", "'tracked'"),
    "(track(place=FloorPlace(position_m=(1.0, None), covariance_m2=(1.0, 0.0, 1.0))),)": ("metres", "None"),
    "(track(occluder='anna'),)": ("occluder", "'anna'"),
    "frame.grey('rear')": ("'rear'", "colour"),
}


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a scenario, in which the user is."""
    (tmp_path / "brief.yaml").write_text(yaml.safe_dump(BRIEF), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write_tracker(home: Path, answer: str, module: str) -> str:
    (home / f"{module}.py").write_text(TRACKER.replace("ANSWER", answer), encoding="utf-8")
    return f"{module}:Mine"


@pytest.mark.parametrize("answer", some_of(WRONG, 4))
def test_a_wrong_value_is_told_in_a_line_with_what_would_be_right(
    answer: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write_tracker(home, answer, f"wrong_{list(WRONG).index(answer)}")
    told = refusal(capsys, "run", "brief.yaml", "--tracker", name, "--no-recording", "--out", "run")
    assert_names(told, f"frame 3: tracker '{name}': ", *WRONG[answer])
    about = json.loads(Path("run/run.json").read_text(encoding="utf-8"))
    assert (about["status"], about["frames"]) == ("failed", 2)
    assert about["error"]["message"] in told
    with refused("run.json", "failed", name):
        read_run(Path("run"))


def test_an_environment_refuses_a_wrong_value_too(home: Path) -> None:
    name = write_tracker(home, "(track(id='1'),)", "in_environment")
    env = PeopleBoyEnv("brief.yaml", observation="tracks", tracker=name)
    env.reset(seed=0)
    with refused(f"tracker '{name}'", "whole number", "'1'"):
        for _ in range(3):
            env.step([0.0, 0.0])


def test_numbers_of_numpy_are_right_ones(home: Path) -> None:
    name = write_tracker(
        home,
        "(track(id=np.int64(4), boxes={'thermal': tuple(np.arange(4))}, confidence=np.float32(0.5)),)",
        "numpy_one",
    )
    assert run_cli("run", "brief.yaml", "--tracker", name, "--no-recording", "--out", "run") == 0


def test_an_error_of_theirs_ends_the_run_in_a_marked_folder_with_its_traceback(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write_tracker(home, "frame.nothing", "failing")
    assert run_cli("run", "brief.yaml", "--tracker", name, "--out", "run") == 1
    told = capsys.readouterr().err
    assert_names(
        told, f"frame 3: tracker '{name}' failed", "AttributeError", "failing.py, line 21", "run/run.json"
    )
    about = json.loads(Path("run/run.json").read_text(encoding="utf-8"))
    assert (about["status"], about["frames"]) == ("failed", 2)
    assert about["error"]["message"] in told
    assert "return frame.nothing" in about["error"]["traceback"]
    assert "checked_tracker.py" in about["error"]["traceback"]
    # It is done again once that is mended.
    (home / "failing.py").write_text(TRACKER.replace("ANSWER", "()"), encoding="utf-8")
    assert run_cli("evaluate", "run") == 2


def test_who_writes_into_an_image_spoils_none_and_is_told_so(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write_tracker(home, "frame.grey('thermal').fill(0)", "writing")
    assert run_cli("run", "brief.yaml", "--tracker", name, "--no-recording", "--out", "run") == 1
    assert_names(
        capsys.readouterr().err, f"frame 3: tracker '{name}' failed", "read-only", "writing.py, line 21"
    )


@pytest.mark.parametrize(
    ("answer", "says"), [("Status.HIDDEN", "AttributeError: HIDDEN"), ("exit(0)", "SystemExit: 0")]
)
def test_an_error_is_told_by_the_line_of_theirs_and_none_ends_the_program(
    answer: str, says: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write_tracker(home, answer, f"elsewhere_{len(answer)}")  # both are raised in Python's own library
    assert run_cli("run", "brief.yaml", "--tracker", name, "--no-recording", "--out", "run") == 1
    assert_names(capsys.readouterr().err, says, f"elsewhere_{len(answer)}.py, line 21")


def test_in_a_sweep_the_failed_runs_are_named_with_where_their_tracebacks_are(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = write_tracker(home, "1 / 0", "dividing")
    options = ("--tracker", name, "--seeds", "1", "--workers", "1", "--out", "runs")
    assert run_cli("sweep", "brief.yaml", *options) == 1
    told = capsys.readouterr().err
    for part in ("1 of 1 failed", "brief-0", "frame 3", name, "ZeroDivisionError", "brief-0/run.json"):
        assert part in told
    name = write_tracker(home, "None", "nothing_told")
    assert_names(refusal(capsys, "sweep", "brief.yaml", *options[2:], "--tracker", name), "frame 3", name)


@pytest.mark.parametrize("path", ["mine.py", "../own/mine.py", "./mine", "C:\\own\\mine.py"])
def test_a_path_is_refused_with_the_module_to_give(path: str) -> None:
    with refused(f"tracker {f'{path}:Mine'!r}", "file's path", "give mine:Mine"):
        load_own("tracker", f"{path}:Mine", "so")


@pytest.mark.parametrize(
    ("code", "says"),
    [
        ("1 / 0", ("cannot be imported", "ZeroDivisionError")),
        ("def Mine(rng): raise KeyError('weights')", ("cannot be made", "KeyError", "weights")),
        (
            "class Mine:\n  cameras = 'thermal'\n  __init__ = update = lambda s, r: None",
            ("tuple of names",),
        ),
        ("def Mine(rng):\nx", ("cannot be imported", "IndentationError", "line 2")),
        ("Mine = 3", ("cannot be made", "not callable")),
    ],
)
def test_what_cannot_be_made_is_a_line_and_leaves_nothing(
    code: str, says: tuple[str, ...], home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    module = f"unmade_{abs(hash(code))}"
    (home / f"{module}.py").write_text(code, encoding="utf-8")
    told = refusal(capsys, "run", "brief.yaml", "--tracker", f"{module}:Mine", "--out", "run")
    assert_names(told, f"tracker '{module}:Mine'", *says)
    assert not Path("run").exists()
