"""People in the images of 360-degree cameras that others recorded."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
from numpy.typing import NDArray

from peopleboy.scenarios.footage.options import PanoramaOptions, TrackOptions
from peopleboy.scenarios.footage.views import open_views
from peopleboy.tracker.sensors.panorama.panorama_view import all_round
from peopleboy.tracker.sensors.panorama.unrolling import PanoramaKind, PanoramaUnrolling
from tests.helpers.calls.footage_calls import call, refusal
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import make_run

HEIGHT_M = 1.1
MIRROR = {"half_apex_deg": 70.0, "lens_half_angle_deg": 65.0, "lens_m": 0.001, "apex_m": HEIGHT_M}
"""Of the all-round view."""
SCENE: dict[str, Any] = {
    "name": "around",
    "description": "Two people walk around a standing robot.",
    "duration_s": 5.0,
    "place": {"kind": "room", "length_m": 9.0, "width_m": 8.0},
    "people": [
        {"name": "anna", "path": [{"at_m": [7.2, -2.0]}, {"at_m": [7.2, 2.0], "speed_m_s": 0.8}]},
        {"name": "ben", "path": [{"at_m": [2.0, 2.6]}, {"at_m": [2.0, -1.4], "speed_m_s": 0.8}]},
    ],
    "robot": {
        "at_m": [4.5, 0.0],
        "tracker": "panoramic",
        "cameras": {
            "thermal": {"kind": "thermal", "width_px": 80, "height_px": 60},
            "panorama": {"kind": "panorama", "height_px": 180, "rate_hz": 5, "mirror": MIRROR},
        },
    },
}
SETTLED = 15
"""Frame from which both people have a track."""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_run(SCENE, tmp_path_factory.mktemp("around") / "run", "--frames")


def as_equirectangular(view: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Convert an image of the all-round view to an equirectangular one from -50 to 15 degrees."""
    seen = all_round(HEIGHT_M)
    flat = PanoramaUnrolling.of(PanoramaKind.EQUIRECTANGULAR, (720, 130), (-50.0, 15.0), HEIGHT_M).calibration
    v, u = np.mgrid[:130, :720]
    points = flat.rays(np.column_stack([u.ravel(), v.ravel()]).astype(float)) + seen.position_m
    columns, rows = seen.project(points).T.reshape(2, 130, 720).astype(np.float32)
    return np.asarray(cv2.remap(view, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE))


def write_equirectangular(run: Path, folder: Path) -> Path:
    folder.mkdir()
    for path in sorted((run / "panorama").glob("*.png")):
        cv2.imwrite(str(folder / path.name), as_equirectangular(np.asarray(cv2.imread(str(path)), np.uint8)))
    return folder


def places(path: Path) -> dict[int, list[tuple[float, float]]]:
    """Return the positions in each frame, those behind the camera first."""
    rows = [row for row in pq.read_table(path / "tracks.parquet").to_pylist() if row["status"] != "tentative"]
    return {
        frame: sorted((row["place_x_m"], row["place_y_m"]) for row in rows if row["frame"] == frame)
        for frame in {row["frame"] for row in rows}
    }


@pytest.mark.slow
def test_an_equirectangular_film_gives_the_people_of_the_run(run: Path, tmp_path: Path) -> None:
    film, out = write_equirectangular(run, tmp_path / "film"), tmp_path / "out"
    done = call(
        film, "--panorama", "equirectangular", "--elevation-deg", -50, 15, "--camera-height-m", HEIGHT_M,
        "--rate-hz", 5, "--out", out,
    )  # fmt: skip
    assert done.exit_code == 0, done.output
    found = places(out)
    for frame in range(SETTLED, 25):
        time_s = (frame - 1) / 5.0
        # Ben walks behind the robot, anna ahead of it; left is positive.
        people = [(-2.5, 2.6 - 0.8 * time_s), (2.7, -2.0 + 0.8 * time_s)]
        assert np.array(found[frame]) == pytest.approx(np.array(people), abs=0.4)
    lines = [line.split(",") for line in (out / "tracks.txt").read_text().split()]
    assert {line[1] for line in lines if int(line[0]) >= SETTLED} == {"1", "2"}
    assert all(0 <= float(line[2]) <= 720 and float(line[5]) <= 130 for line in lines)
    about = json.loads((out / "run.json").read_text())
    assert (about["panorama"], about["elevation_deg"]) == ("equirectangular", [-50.0, 15.0])
    assert (about["width"], about["height"], about["camera"]) == (720, 130, {"height_m": HEIGHT_M})


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--panorama", "equirectangular"), ("--panorama", "--camera-height-m")),
        (("--elevation-deg", -50, 15), ("--elevation-deg", "--panorama")),
        (("--panorama", "mirror", "--camera-height-m", 1.2), ("mirror", "elevations")),
        (("--panorama", "equirectangular", "--camera-height-m", 2.8), ("0.5 to 2 m", "2.80 m")),
        (("--panorama", "equirectangular", "--camera-height-m", 1.2, "--pitch-deg", 3), ("--panorama",)),
        (("--panorama", "equirectangular", "--camera-height-m", 1.2, "--tracker", "detection"), ("thermal",)),
        (("--panorama", "equirectangular", "--camera-height-m", 1.2, "--scale", "centikelvin"), ("--scale",)),
        (("--panorama", "equirectangular", "--camera-height-m", 1.2, "--depth", "."), ("--depth",)),
        (("--tracker", "panoramic"), ("panoramic", "--panorama KIND")),
    ],
)
def test_what_makes_no_sense_is_refused(
    tmp_path: Path, arguments: tuple[object, ...], named: tuple[str, ...]
) -> None:
    film = tmp_path / "film"
    film.mkdir()
    for number in range(2):
        cv2.imwrite(str(film / f"{number}.png"), np.full((120, 240, 3), 90 + number, np.uint8))
    more = ("--depth-scale", 0.001) if "--depth" in arguments else ()
    assert_names(refusal(film, *arguments, *more, "--out", tmp_path / "out"), *named)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["film"]


def test_odometry_is_passed_on(tmp_path: Path) -> None:
    film, moved = tmp_path / "film", tmp_path / "moved.csv"
    film.mkdir()
    for number in range(2):
        cv2.imwrite(str(film / f"{number}.png"), np.full((120, 240, 3), 90 + number, np.uint8))
    moved.write_text("advance_m,aside_m,turn_deg\n0,0,0\n0.05,0,180\n")
    panorama = PanoramaOptions(kind=PanoramaKind.EQUIRECTANGULAR, height_m=1.0)
    options = TrackOptions(footage=film, out=tmp_path / "out", panorama=panorama, odometry=moved)
    frames = list(open_views(options))
    assert frames[1].odometry is not None
    assert frames[1].odometry.turn_rad == pytest.approx(math.pi)
    assert frames[0].images["panorama"].shape == (120, 240, 3)
