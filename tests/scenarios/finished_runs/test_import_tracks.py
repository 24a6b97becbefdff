"""Tracks made elsewhere become a run's folder that everything takes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from rerun.chunk import RrdReader

from peopleboy.scenarios.run_folder.finished_run import open_whole_runs
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import FOLLOWING, export, make_run

SCENE: dict[str, Any] = FOLLOWING | {"duration_s": 2.0, "faults": []}


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run whose robot follows what it was told."""
    folder = tmp_path_factory.mktemp("adopt") / "driven"
    return make_run(SCENE, folder, "--tracker", "truth", "--frames")


@pytest.fixture(scope="module")
def adopted(driven: Path) -> Path:
    """The same images with tracks that are beside the people by 3 px, and end early."""
    theirs = driven.parent / "theirs.txt"
    rows = [line.split(",") for line in (driven / "tracks.txt").read_text(encoding="utf-8").splitlines()]
    lines = [",".join([f, "7", str(float(x) + 3.0), *rest]) for f, _, x, *rest in rows if int(f) <= 20]
    theirs.write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert run_cli("import-tracks", driven, theirs, "--name", "mine") == 0
    return driven.parent / "tiny_following-0-mine"


def said(folder: Path, name: str = "run.json") -> dict[str, Any]:
    content: dict[str, Any] = json.loads((folder / name).read_text(encoding="utf-8"))
    return content


@pytest.mark.slow
def test_truth_images_and_scenario_are_those_of_the_run(driven: Path, adopted: Path) -> None:
    names = ["scenario.yaml", "truth/gt.txt", "thermal/000009.png", "colour/000009.png"]
    names += ["truth.parquet", "robot.parquet", "truth/colour.parquet"]
    for name in names:
        assert (adopted / name).read_bytes() == (driven / name).read_bytes(), name
    assert len(list((adopted / "thermal").iterdir())) == 30


def test_the_tracks_are_theirs_and_what_they_lack_is_unknown(driven: Path, adopted: Path) -> None:
    rows = pq.read_table(adopted / "tracks.parquet").to_pylist()
    assert len(rows) == len((adopted / "tracks.txt").read_text(encoding="utf-8").splitlines()) == 20
    assert {(row["id"], row["status"], row["place_x_m"], row["occluder"]) for row in rows} == {
        (7, "unknown", None, None)
    }
    assert rows[-1]["age_s"] == pytest.approx(19 / 15)
    about = said(adopted)
    assert about["tracker"] == "mine"
    assert about["adopted"] == {
        "tracks": "theirs.txt",
        "camera": "thermal",
        "driven_by": "truth",
        "unknown": ["status", "place", "occluder", "posture"],
    }
    metrics = said(adopted, "metrics.json")
    assert "following" in said(driven, "metrics.json")
    assert "following" not in metrics
    assert "floor" not in metrics
    assert metrics["counts"]["candidates"] == 20
    lost = [line for line in open_whole_runs([adopted])[0].events if line.kind == "lost"]
    assert [(line.frame, line.who) for line in lost] == [(21, "track 7")]
    assert "gives no reason" in lost[0].why


@pytest.mark.slow
def test_everything_takes_it(driven: Path, adopted: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_cli("evaluate", adopted) == 0
    assert run_cli("report", driven, adopted, "--out", driven.parent / "page.html") == 0
    assert "tracks of mine are imported: their status, place, occluder and posture are unknown" in (
        capsys.readouterr().err
    )
    assert "theirs.txt, imported" in (driven.parent / "page.html").read_text(encoding="utf-8")
    assert "/thermal/tracks" in "\n".join(
        chunk.entity_path for chunk in RrdReader(adopted / "recording.rrd").stream()
    )
    export(adopted, "mot", driven.parent / "mot")
    export(adopted, "coco", driven.parent / "coco")


@pytest.mark.parametrize(
    ("line", "options", "says"),
    [
        ("31,1,9,9,9,9,1,-1,-1,-1", (), ("theirs.txt", "frame 30", "got 31")),
        ("0,1,9,9,9,9,1,-1,-1,-1", (), ("theirs.txt:1", "from 1")),
        ("1,0,9,9,9,9,1,-1,-1,-1", (), ("ids", "at least 1")),
        ("1,1,900,9,9,9,1,-1,-1,-1", (), ("160 x 120", "'thermal'", "100%")),
        ("1,1,9,9", (), ("theirs.txt:1", "got 4")),
        (
            "1,1,9,9,9,9,1,-1,-1,-1",
            ("--camera", "rear"),
            ("--camera: unknown camera 'rear'", "thermal, colour"),
        ),
        ("1,1,9,9,9,9,1,-1,-1,-1", ("--name", "contour"), ("--name contour", "of PeopleBoy")),
        ("1,1,9,9,9,9,1,-1,-1,-1", ("--name", "a:b"), ("--name 'a:b'", "letters")),
    ],
)
def test_what_cannot_be_of_the_run_is_refused_in_a_line_and_leaves_nothing(
    driven: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    line: str,
    options: tuple[str, ...],
    says: tuple[str, ...],
) -> None:
    (tmp_path / "theirs.txt").write_text(f"{line}\n", encoding="utf-8")
    out = tmp_path / "out"
    told = refusal(
        capsys, "import-tracks", driven, tmp_path / "theirs.txt", "--name", "mine", "--out", out, *options
    )
    assert_names(told, *says)
    assert not out.exists()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["theirs.txt"]


def test_boxes_may_be_in_the_image_of_another_camera(driven: Path, tmp_path: Path) -> None:
    (tmp_path / "theirs.txt").write_text("1,1,9,9,9,9,1,-1,-1,-1\n", encoding="utf-8")
    options = ("--name", "mine", "--camera", "colour", "--no-recording", "--out", tmp_path / "out")
    assert run_cli("import-tracks", driven, tmp_path / "theirs.txt", *options) == 0
    assert run_cli("evaluate", tmp_path / "out", "--camera", "colour") == 0
    assert not (tmp_path / "out" / "recording.rrd").exists()
