"""Everything but recordings works where rerun is not installed, and what needs it says so."""

import logging
import subprocess
import sys
from pathlib import Path

import pytest

from peopleboy.scenarios.recording import recording_file
from tests.helpers.calls.command_line import refusal
from tests.helpers.calls.refused import assert_names


def test_runs_reports_and_environments_load_no_rerun() -> None:
    code = (
        "import sys\n"
        "import peopleboy.scenarios.cli, peopleboy.scenarios.running.run\n"
        "import peopleboy.scenarios.environments.environment, peopleboy.scenarios.report.pictures\n"
        "import peopleboy.scenarios.finished_runs.import_tracks\n"
        "import peopleboy.scenarios.finished_runs.run_scene_model\n"
        "print('rerun' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert done.stdout == "False\n"


def test_a_recording_that_cannot_be_written_is_left_out_with_one_notice(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(recording_file, "is_installed", lambda: False)
    recording_file._note_once.cache_clear()
    with caplog.at_level(logging.WARNING):
        assert [recording_file.is_recorded(wanted) for wanted in (False, True, True)] == [False] * 3

    (line,) = caplog.messages
    assert_names(line, "rerun", "pip install 'peopleboy[viewer]'")


def test_the_live_viewer_names_the_extra_that_brings_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(recording_file, "is_installed", lambda: False)

    told = refusal(capsys, "run", "crossing_2", "--live", "--out", tmp_path / "run")

    assert_names(told, "--live", "peopleboy[viewer]")
    assert not list(tmp_path.iterdir())


def test_a_run_without_recording_names_the_extra_too(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "run.json").write_text("{}", encoding="utf-8")
    for is_there, words in ((False, "peopleboy[viewer]"), (True, "--no-recording")):
        monkeypatch.setattr(recording_file, "is_installed", lambda there=is_there: there)
        assert_names(refusal(capsys, "view", tmp_path), "recording.rrd", words)
