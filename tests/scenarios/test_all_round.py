"""A run in which somebody comes from aside into the thermal image, and cameras that are refused."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from PIL import Image
from rerun.chunk import RrdReader

from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names

SCENE: dict[str, Any] = {
    "name": "comes_round",
    "description": "A person walks from beside the robot into its thermal image.",
    "duration_s": 5.4,
    "place": {"kind": "room", "length_m": 9.0, "width_m": 8.0},
    "people": [
        {
            "name": "anna",
            "enter_s": 0.6,
            "path": [
                {"at_m": [4.6, 2.6]},
                {"at_m": [6.6, 0.9], "speed_m_s": 0.9},
                {"at_m": [6.7, -0.3], "speed_m_s": 0.9},
            ],
        }
    ],
    "robot": {
        "at_m": [3.5, 0.0],
        "cameras": {"thermal": {"kind": "thermal"}, "panorama": {"kind": "panorama", "rate_hz": 5}},
    },
}


def scene_file(folder: Path, **cameras: object) -> Path:
    path = folder / "scene.yaml"
    robot = SCENE["robot"] | ({"cameras": cameras} if cameras else {})
    path.write_text(yaml.safe_dump(SCENE | {"robot": robot}), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def came(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("came")
    assert run_cli("run", scene_file(folder), "--tracker", "handover", "--out", folder / "run") == 0
    return folder / "run"


def rows(path: Path) -> list[dict[str, Any]]:
    return pq.read_table(path).to_pylist()  # type: ignore[no-any-return]


@pytest.mark.slow
def test_who_comes_from_the_panorama_into_the_thermal_image_keeps_its_number(came: Path) -> None:
    tracks = rows(came / "tracks.parquet")
    assert {row["id"] for row in tracks} == {1}
    first = min(row["frame"] for row in tracks)
    warm = [row["frame"] for row in tracks if row["left_px"] is not None]
    seen = [row["frame"] for row in rows(came / "truth.parquet") if row["visible_fraction"] >= 0.9]
    assert first < min(seen) - 10
    assert set(range(max(seen) - 5, max(seen) + 1)) <= set(warm)
    around = np.loadtxt(came / "tracks" / "panorama.txt", delimiter=",", ndmin=2)
    assert set(around[:, 1]) == {1}
    assert around[:, 0].min() == first


def test_its_places_are_where_the_person_is_before_and_after(came: Path) -> None:
    poses = {
        row["frame"]: (row["x_m"], row["y_m"], row["heading_rad"]) for row in rows(came / "robot.parquet")
    }
    people = {row["frame"]: (row["x_m"], row["y_m"]) for row in rows(came / "truth.parquet")}
    off = []
    for row in rows(came / "tracks.parquet"):
        x, y, heading = poses[row["frame"]]
        turn = np.array([[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]])
        place = (x, y) + turn @ (row["place_x_m"], row["place_y_m"])
        off.append(np.linalg.norm(place - people[row["frame"]]))
    assert np.median(off) < 0.25
    assert np.max(off) < 0.7


@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")
def test_its_recording_draws_what_both_sensors_see_by(came: Path) -> None:
    told: dict[str, int] = {}
    for chunk in RrdReader(came / "recording.rrd").stream():
        told[chunk.entity_path] = told.get(chunk.entity_path, 0) + (not chunk.is_static and chunk.num_rows)
    for layer in ("panorama/explained/background", "panorama/explained/lines", "thermal/tracks/contours"):
        assert told[f"/world/robot/{layer}"] > 5, layer
    with Image.open(came / "contact_sheet.png") as sheet:
        assert min(sheet.size) > 300


@pytest.mark.thorough
def test_the_same_run_in_a_fresh_process_gives_the_same_tracks(came: Path, tmp_path: Path) -> None:
    out = tmp_path / "again"
    call = ["run", came.parent / "scene.yaml", "--tracker", "handover", "--out", out, "--no-recording"]
    subprocess.run([sys.executable, "-m", "peopleboy", *map(str, call)], check=True, capture_output=True)
    for name in ("tracks.txt", "tracks/panorama.txt", "tracks.parquet", "truth.parquet"):
        assert (out / name).read_bytes() == (came / name).read_bytes(), name


@pytest.mark.parametrize("tracker", ["panoramic", "handover"])
@pytest.mark.parametrize(
    ("camera", "named"),
    [
        ({"kind": "panorama", "mirror": {"apex_m": 2.4}}, ("panoramic camera", "0.5 to 2 m", "2.4")),
        ({"kind": "colour"}, ("'panorama'", "calibrated panoramic camera")),
    ],
    ids=["too high", "a flat one"],
)
def test_a_camera_that_cannot_be_used_is_refused_before_anything_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], tracker: str, camera: object, named: tuple[str, ...]
) -> None:
    path = scene_file(tmp_path, panorama=camera)
    said = refusal(capsys, "run", path, "--tracker", tracker, "--out", tmp_path / "none")
    assert_names(said, *named)
    assert not (tmp_path / "none").exists()


@pytest.mark.slow
@pytest.mark.parametrize("camera", [{"mirror": {"apex_m": 1.3}}, {"width_px": 720, "height_px": 180}])
def test_people_are_tracked_with_other_cameras(tmp_path: Path, camera: dict[str, object]) -> None:
    path, out = scene_file(tmp_path, panorama={"kind": "panorama", **camera}), tmp_path / "out"
    assert run_cli("run", path, "--tracker", "panoramic", "--out", out, "--no-recording") == 0
    lines = (out / "tracks" / "panorama.txt").read_text().split()
    assert len(lines) > 20
    assert run_cli("evaluate", out, "--camera", "panorama") == 0
