"""A benchmark's results, one file for each sequence, become a folder of runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from peopleboy.scenarios.export.mot import gt_text
from peopleboy.scenarios.export.replay import with_people
from peopleboy.scenarios.run_folder.finished_run import open_whole_runs
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import SCENE, export, make_run

BRIEF: dict[str, Any] = SCENE | {"duration_s": 0.6}
SEQUENCES = ("tiny-0", "tiny-1")


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two runs of a scene, whose images somebody took away."""
    folder = tmp_path_factory.mktemp("adopt_all") / "runs"
    folder.mkdir()
    for seed, name in enumerate(("first", "second")):
        make_run(BRIEF, folder / name, "--tracker", "truth", "--seed", seed)
    return folder


@pytest.fixture(scope="module")
def exported(runs: Path) -> Path:
    """The folder of results that an export of the runs has, in TrackEval's layout."""
    export(runs, "mot", runs.parent / "mot")
    (results,) = (runs.parent / "mot").glob("trackers/*/*/truth")
    return results


@pytest.mark.thorough
def test_results_in_the_layout_of_an_export_come_back_as_runs_with_the_same_tracks(
    runs: Path, exported: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_cli("import-tracks", runs, exported, "--name", "mine", "--no-recording") == 0
    told = capsys.readouterr().out
    adopted = open_whole_runs([runs.parent / "runs-mine" / name for name in SEQUENCES])
    for run, name, source in zip(adopted, SEQUENCES, ("first", "second"), strict=True):
        assert f"{name}: People were found in 100 %" in told
        assert run.about.tracker == "mine"
        theirs = (exported / "data" / f"{name}.txt").read_text(encoding="utf-8").splitlines()
        boxes = [line.split(",")[:6] for line in (run.folder / "tracks.txt").read_text("utf-8").splitlines()]
        assert boxes == [line.split(",")[:6] for line in theirs]
        (driven,) = open_whole_runs([runs / source])
        assert gt_text(with_people(run, "thermal")) == gt_text(with_people(driven, "thermal"))
    assert run_cli("evaluate", runs, runs.parent / "runs-mine") == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("names", "says"),
    [
        (("tiny-0",), ("theirs", "no tiny-1.txt", "second")),
        (("tiny-0", "tiny-1", "tiny-7"), ("tiny-7.txt", "no run with that name", "tiny-0, tiny-1")),
        ((), ("theirs", "SEQUENCE.txt", "data")),
    ],
)
def test_a_folder_that_is_not_of_these_runs_is_refused_and_leaves_nothing(
    runs: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    names: tuple[str, ...],
    says: tuple[str, ...],
) -> None:
    (tmp_path / "theirs").mkdir()
    for name in names:
        (tmp_path / "theirs" / f"{name}.txt").write_text("1,1,9,9,9,9,1,-1,-1,-1\n", encoding="utf-8")
    out = tmp_path / "out"
    told = refusal(capsys, "import-tracks", runs, tmp_path / "theirs", "--name", "mine", "--out", out)
    assert_names(told, *says)
    assert not out.exists()


def test_a_spoilt_file_among_good_ones_is_found_before_anything_is_written(
    runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, line in zip(SEQUENCES, ("1,1,9,9,9,9,1,-1,-1,-1", "1,1,9,9"), strict=True):
        (tmp_path / f"{name}.txt").write_text(f"{line}\n", encoding="utf-8")
    out = tmp_path / "out"
    told = refusal(capsys, "import-tracks", runs, tmp_path, "--name", "mine", "--out", out)
    assert_names(told, "tiny-1.txt:1", "got 4")
    assert not out.exists()
