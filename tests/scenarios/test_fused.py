"""A run with heat, depth and colour at once, whose cameras fail for a while."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
import yaml
from rerun.chunk import RrdReader

from tests.helpers.calls.command_line import run_cli

SCENE: dict[str, Any] = {
    "name": "walks_across",
    "description": "A person walks across before the robot; the cameras are black for a while.",
    "duration_s": 4.0,
    "place": {"kind": "room", "length_m": 8.0, "width_m": 7.0},
    "people": [
        {
            "name": "anna",
            "path": [{"at_m": [4.6, 1.0]}, {"at_m": [4.6, -1.2], "speed_m_s": 0.6}],
        }
    ],
    "robot": {"at_m": [0.8, 0.0]},
    "faults": [{"kind": "camera_black", "from_s": 2.0, "lasts_s": 0.6}],
}


@pytest.fixture(scope="module")
def walked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("walked")
    path = folder / "scene.yaml"
    path.write_text(yaml.safe_dump(SCENE), encoding="utf-8")
    assert run_cli("run", path, "--tracker", "fused", "--out", folder / "run") == 0
    return folder / "run"


def rows(path: Path) -> list[dict[str, Any]]:
    return pq.read_table(path).to_pylist()  # type: ignore[no-any-return]


@pytest.mark.slow
def test_a_person_keeps_its_number_over_a_failure_of_all_cameras(walked: Path) -> None:
    tracks = rows(walked / "tracks.parquet")
    frames = {row["frame"] for row in tracks}
    assert {row["id"] for row in tracks} == {1}
    assert set(range(8, 31)) <= frames
    assert set(range(45, 61)) <= frames
    assert not frames & {38, 39}  # black for long enough that nobody may be claimed


def test_its_boxes_lie_on_the_person(walked: Path) -> None:
    truth = {row["frame"]: row for row in rows(walked / "truth.parquet")}
    for row in rows(walked / "tracks.parquet"):
        true = truth[row["frame"]]
        if not 30 < row["frame"] < 45:
            middle = row["left_px"] + row["width_px"] / 2
            assert middle == pytest.approx(true["left_px"] + true["width_px"] / 2, abs=4)
            assert row["height_px"] == pytest.approx(true["height_px"], rel=0.08)


def test_its_recording_shows_what_both_parts_explain(walked: Path) -> None:
    shown = {str(chunk.entity_path) for chunk in RrdReader(walked / "recording.rrd").stream()}
    parts = ("thermal/particles/people", "thermal/tracks/contours", "depth/explained/lines")
    assert {f"/world/robot/{part}" for part in parts} <= shown
