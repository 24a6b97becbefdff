from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import pytest

from peopleboy.scenarios.cli import main
from peopleboy.scenarios.export import coco
from peopleboy.scenarios.export.formats import FORMATS, takes
from peopleboy.scenarios.run_folder.atomic_output import atomic_folder
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import export

FORM = ("--format", "viper")


def copy(run: Path, to: Path) -> Path:
    shutil.copytree(run, to, ignore=shutil.ignore_patterns("thermal*", "colour"))
    return to


def test_every_format_has_a_writer() -> None:
    assert all(callable(FORMATS[name]) for name in FORMATS)
    assert [name for name in FORMATS if takes(name, "boxes")] == ["mot", "yolo", "yolo-pose"]
    assert [name for name in FORMATS if takes(name, "least_px")] == ["yolo", "yolo-pose"]


def test_bad_input_is_one_line(crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "empty").mkdir()
    for name in ("nothing", "empty"):
        assert_names(refusal(capsys, "export", tmp_path / name, *FORM), tmp_path / name)
    assert_names(refusal(capsys, "export", crossing, "--format", "mp3"), "--format", "'mp3'", *FORMATS)
    assert_names(refusal(capsys, "export", *FORM), "RUNS")
    assert_names(refusal(capsys, "export", crossing), "--format", *FORMATS)


def test_a_run_that_was_cut_off_is_exported_with_a_note(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = copy(crossing, tmp_path / "run")
    about = json.loads((run / "run.json").read_text()) | {"status": "cut off"}
    (run / "run.json").write_text(json.dumps(about))
    with pytest.raises(SystemExit, match="0"):
        main(["export", str(run), *FORM])
    note = f"{run}: incomplete: {about['frames']} of {about['planned_frames']} frames"
    assert note in capsys.readouterr().err


def test_files_that_are_missing_or_broken_are_named(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = copy(crossing, tmp_path / "run")
    (run / "truth.parquet").write_bytes(b"PAR1 but no table")
    assert_names(refusal(capsys, "export", run, *FORM), run / "truth.parquet")
    (run / "tracks.txt").unlink()
    assert_names(refusal(capsys, "export", run, "--format", "mot"), run / "tracks.txt")
    (run / "tracks.txt").touch()
    (run / "run.json").write_text('{"status": "complete", "frames": 60}')
    assert_names(refusal(capsys, "export", run, *FORM), run / "run.json", "'scenario'", "'seed'")
    (run / "scenario.yaml").unlink()
    assert_names(refusal(capsys, "export", run, *FORM), run / "scenario.yaml")
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_two_runs_of_one_name_are_refused(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    again = copy(crossing, tmp_path / crossing.name)
    assert_names(refusal(capsys, "export", crossing, again, *FORM), again, "tiny-3")
    assert_names(refusal(capsys, "export", crossing, *FORM, "--boxes", "whole"), "--boxes whole", "mot")


def test_nothing_is_replaced_but_an_export_and_that_only_if_asked(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = export(crossing, "viper", tmp_path / "out")
    assert_names(refusal(capsys, "export", crossing, *FORM, "--out", out), out, "--overwrite")
    assert run_cli("export", crossing, *FORM, "--out", out, "--overwrite") == 0
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("years of work")
    for place in (tmp_path / "mine", tmp_path / "mine" / "thesis.tex"):
        assert_names(refusal(capsys, "export", crossing, *FORM, "--out", place, "--overwrite"), place)
    assert (tmp_path / "mine" / "thesis.tex").read_text() == "years of work"


def test_an_export_that_fails_leaves_nothing_and_keeps_the_earlier_one(
    crossing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "coco"
    with atomic_folder(out, {}, overwrite=False) as folder:
        (folder / "earlier").touch()

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(coco, "write_aside", fail)
    told = refusal(capsys, "export", crossing, "--format", "coco", "--out", out, "--overwrite")
    assert_names(told, "No space left on device")
    assert [path.name for path in tmp_path.iterdir()] == ["coco"]
    assert sorted(path.name for path in out.iterdir()) == ["earlier", "export.json"]


def test_a_missing_package_is_named_with_the_extra_that_brings_it(
    crossing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for form, package in (("mp4", "av"), ("mcap", "rosbags")):
        monkeypatch.setitem(sys.modules, package, None)
        told = refusal(capsys, "export", crossing, "--format", form, "--out", tmp_path / form)
        assert_names(told, f"--format {form}", package, f"pip install {package}")
        assert not list(tmp_path.iterdir())


def test_a_folder_of_runs_is_exported_whole_beside_them(crossing: Path, tmp_path: Path) -> None:
    for name in ("one", "two"):
        copy(crossing, tmp_path / "suite" / name)
    assert run_cli("export", tmp_path / "suite", *FORM) == 0
    out = tmp_path / "suite" / "export-viper"
    assert sorted(path.name for path in out.iterdir()) == ["export.json", "one", "two"]
    assert json.loads((out / "export.json").read_text())["runs"] == ["one", "two"]
    assert run_cli("export", tmp_path / "suite" / "one", *FORM) == 0
    assert (tmp_path / "suite" / "one-viper" / "one" / "truth.xgtf").is_file()
