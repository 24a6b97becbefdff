from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import pytest

from peopleboy.scenarios.commands.export import FORMATS
from peopleboy.scenarios.export import coco
from peopleboy.scenarios.export.formats import WRITERS
from peopleboy.scenarios.run_folder.whole_folder import whole_folder
from tests.helpers.exported import export, run_cli

FORM = ("--format", "viper")


def refusal(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """The one line that a call ends with."""
    capsys.readouterr()
    assert run_cli("export", *arguments) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1, told
    return told


def copy(run: Path, to: Path) -> Path:
    shutil.copytree(run, to, ignore=shutil.ignore_patterns("thermal*", "colour"))
    return to


def test_the_command_offers_what_there_is() -> None:
    assert tuple(WRITERS) == FORMATS


def test_bad_input_is_one_line(crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "there is no such folder" in refusal(capsys, tmp_path / "nothing", *FORM)
    (tmp_path / "empty").mkdir()
    assert "give the folder of a finished run" in refusal(capsys, tmp_path / "empty", *FORM)
    assert "'mp3' is not one of" in refusal(capsys, crossing, "--format", "mp3")
    assert "Missing argument" in refusal(capsys, *FORM)
    assert "Missing option '--format'" in refusal(capsys, crossing)


def test_a_run_that_was_cut_off_is_refused(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = copy(crossing, tmp_path / "run")
    about = json.loads((run / "run.json").read_text()) | {"status": "cut off"}
    (run / "run.json").write_text(json.dumps(about))
    assert "this run was cut off" in refusal(capsys, run, *FORM)


def test_files_that_are_missing_or_broken_are_named(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = copy(crossing, tmp_path / "run")
    (run / "truth.parquet").write_bytes(b"PAR1 but no table")
    assert "truth.parquet: cannot be read as a table of a run" in refusal(capsys, run, *FORM)
    (run / "tracks.txt").unlink()
    assert "tracks.txt: there is no such file" in refusal(capsys, run, "--format", "mot")
    (run / "tracks.txt").touch()
    (run / "run.json").write_text('{"status": "complete", "frames": 60}')
    assert "run.json: missing key 'scenario'; missing key 'seed'" in refusal(capsys, run, *FORM)
    (run / "scenario.yaml").unlink()
    assert "scenario.yaml: there is no such file" in refusal(capsys, run, *FORM)
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_two_runs_of_one_name_are_refused(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    again = copy(crossing, tmp_path / crossing.name)
    assert "is called tiny-3 too" in refusal(capsys, crossing, again, *FORM)


def test_nothing_is_replaced_but_an_export_and_that_only_if_asked(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = export(crossing, "viper", tmp_path / "out")
    assert "exists already; give --overwrite" in refusal(capsys, crossing, *FORM, "--out", out)
    assert run_cli("export", crossing, *FORM, "--out", out, "--overwrite") == 0
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("years of work")
    assert "is no export" in refusal(capsys, crossing, *FORM, "--out", tmp_path / "mine", "--overwrite")
    assert (tmp_path / "mine" / "thesis.tex").read_text() == "years of work"
    assert "is no export" in refusal(capsys, crossing, *FORM, "--out", tmp_path / "mine" / "thesis.tex")


def test_an_export_that_fails_leaves_nothing_and_keeps_the_earlier_one(
    crossing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "coco"
    with whole_folder(out, {}, overwrite=False) as folder:
        (folder / "earlier").touch()

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(coco, "write_images", fail)
    told = refusal(capsys, crossing, "--format", "coco", "--out", out, "--overwrite")
    assert "No space left on device" in told
    assert [path.name for path in tmp_path.iterdir()] == ["coco"]
    assert sorted(path.name for path in out.iterdir()) == ["earlier", "export.json"]


def test_a_missing_package_is_named_with_the_extra_that_brings_it(
    crossing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for form, package in (("mp4", "av"), ("mcap", "rosbags")):
        monkeypatch.setitem(sys.modules, package, None)
        told = refusal(capsys, crossing, "--format", form, "--out", tmp_path / form)
        assert f"--format {form} needs the package {package}: pip install '.[export]'" in told


def test_a_folder_of_runs_is_exported_whole_beside_them(crossing: Path, tmp_path: Path) -> None:
    for name in ("one", "two"):
        copy(crossing, tmp_path / "suite" / name)
    assert run_cli("export", tmp_path / "suite", *FORM) == 0
    out = tmp_path / "suite" / "export-viper"
    assert sorted(path.name for path in out.iterdir()) == ["export.json", "one", "two"]
    assert json.loads((out / "export.json").read_text())["runs"] == ["one", "two"]
    assert run_cli("export", tmp_path / "suite" / "one", *FORM) == 0
    assert (tmp_path / "suite" / "one-viper" / "one" / "truth.xgtf").is_file()
