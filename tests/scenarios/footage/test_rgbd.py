"""People in RGB-D pictures that others recorded."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
from PIL import Image

from peopleboy.scenarios.footage.options import FootageCamera, RgbdOptions, TrackOptions
from peopleboy.scenarios.footage.views import open_views
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, Frame, Odometry
from tests.helpers.calls.footage_calls import call, refusal
from tests.helpers.calls.refused import assert_names
from tests.helpers.images.rgbd_files import colours, depth_mm, write_counts, write_rgbd
from tests.helpers.runs.exported import make_run

SCENE: dict[str, Any] = {
    "name": "before_depth",
    "description": "Two people cross in front of a stationary depth camera.",
    "duration_s": 2.4,
    "place": {"kind": "room", "length_m": 9.0, "width_m": 7.0},
    "people": [
        {"name": "anna", "path": [{"at_m": [4.6, -1.4]}, {"at_m": [4.6, 1.4], "speed_m_s": 0.9}]},
        {"name": "ben", "path": [{"at_m": [6.0, 1.6]}, {"at_m": [6.0, -1.6], "speed_m_s": 0.9}]},
    ],
    "robot": {
        "at_m": [0.6, 0.0],
        "tracker": "rgbd",
        "cameras": {
            "thermal": {"kind": "thermal", "width_px": 80, "height_px": 60},
            "depth": {"kind": "depth", "width_px": 240, "height_px": 180},
        },
    },
}
LENS_M = 0.14  # the robot's depth camera, ahead of its centre
POSE = ("--camera-height-m", 1.2, "--pitch-deg", 0)
STAMPS = ["7.10", "7.20", "7.30", "7.40"]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_run(SCENE, tmp_path_factory.mktemp("depth") / "run", "--frames")


def frames(
    colour: Path, depth: Path, m_per_count: float = 0.001, camera: FootageCamera | None = None, **others: Any
) -> list[Frame]:
    rgbd = RgbdOptions(depth=depth, m_per_count=m_per_count, camera=camera or FootageCamera())
    return list(open_views(TrackOptions(footage=colour, out=colour.parent / "out", rgbd=rgbd, **others)))


def options(depth: Path, scale: object = 0.001) -> tuple[object, ...]:
    return "--depth", depth, "--depth-scale", scale, "--out", depth.parent / "out"


def refused_call(colour: Path, depth: Path, *arguments: object, scale: object = 0.001) -> str:
    """Give the one line of a call, which must leave nothing."""
    before = sorted(colour.parent.iterdir())
    told = refusal(colour, *options(depth, scale), *arguments)
    assert sorted(colour.parent.iterdir()) == before
    return told


def boxes(path: Path) -> dict[tuple[str, str], list[float]]:
    rows = [line.split(",") for line in path.read_text(encoding="utf-8").split()]
    return {(row[0], row[1]): [float(edge) for edge in row[2:6]] for row in rows}


def places(path: Path) -> dict[tuple[int, int], tuple[float, float]]:
    rows = pq.read_table(path / "tracks.parquet").to_pylist()
    return {(row["frame"], row["id"]): (row["place_x_m"], row["place_y_m"]) for row in rows}


@pytest.mark.thorough
def test_a_runs_pictures_give_the_people_of_the_run(run: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = call(
        run / "depth_colour",
        "--depth",
        run / "depth",
        "--depth-scale",
        0.001,
        *("--boxes", "torso"),
        "--out",
        out,
    )
    assert done.exit_code == 0, done.output
    told, known = boxes(out / "tracks.txt"), boxes(run / "tracks" / "depth.txt")
    assert len({number for _, number in known}) == 2
    assert len(known) > 50
    assert told.keys() == known.keys()
    # They differ by the noise of the odometry, which the run had.
    assert all(told[key] == pytest.approx(known[key], abs=4.0) for key in known)
    near, far = places(out), places(run)
    assert near.keys() == far.keys()
    gaps = np.array([np.subtract(far[key], near[key]) for key in far])
    assert np.median(gaps, axis=0) == pytest.approx([LENS_M, 0.0], abs=0.01)
    assert np.abs(gaps - [LENS_M, 0.0]).max() < 0.15
    rows = pq.read_table(out / "tracks.parquet").to_pylist()
    assert all(row["left_px"] is not None for row in rows)


def test_the_folder_says_how_it_was_made(tmp_path: Path) -> None:
    colour, depth = write_rgbd(tmp_path, counts_per_mm=5.0)
    done = call(
        colour, *options(depth, 0.0002), "--camera-height-m", 1.5, "--pitch-deg", 3, "--focal-px", 300
    )
    assert done.exit_code == 0, done.output
    out = tmp_path / "out"
    assert {path.name for path in out.iterdir()} == {
        *("tracks.txt", "tracks.parquet", "run.json", "contact_sheet.png", "latency.txt")
    }
    about = json.loads((out / "run.json").read_text())
    assert (about["tracker"], about["depth"], about["depth_scale_m"]) == ("rgbd", "depth", 0.0002)
    assert (about["frames"], about["width"], about["height"]) == (4, 320, 240)
    camera = about["camera"]
    assert (camera["height_m"], camera["pitch_deg"]) == (1.5, 3.0)
    assert camera["focal_px"] == pytest.approx(300)
    assert camera["centre_px"] == [159.5, 119.5]
    assert "depth" in done.stdout  # nobody has a head here


def test_the_sheet_shows_colours(tmp_path: Path) -> None:
    colour, depth = write_rgbd(tmp_path)
    assert call(colour, *options(depth)).exit_code == 0
    sheet = cv2.imread(str(tmp_path / "out" / "contact_sheet.png")).astype(int)
    assert ((sheet[..., 2] > 180) & (sheet[..., 0] < 60)).sum() > 1000


def test_the_tracker_sees_millimetres_and_colours_of_the_same_pixels(tmp_path: Path) -> None:
    seen = frames(*write_rgbd(tmp_path, counts_per_mm=5.0), 0.0002)
    assert [frame.time_s for frame in seen] == pytest.approx(np.arange(4) / 15)
    for k, frame in enumerate(seen):
        np.testing.assert_array_equal(frame.depth(DEPTH), depth_mm(k))
        np.testing.assert_array_equal(frame.rgb(DEPTH_COLOUR), colours(k))
        assert frame.odometry is None


def test_the_camera_looks_where_it_is_said_to(tmp_path: Path) -> None:
    camera = FootageCamera(height_m=1.5, pitch_deg=10.0, vertical_fov_deg=60.0)
    seen = frames(*write_rgbd(tmp_path, 1), camera=camera)[0].calibrations[DEPTH]
    assert seen.position_m == (0.0, 0.0, 1.5)
    away = 1.5 / math.tan(math.radians(10.0))
    assert seen.project(np.array([[away, 0.0, 0.0]]))[0] == pytest.approx([159.5, 119.5])
    lowest = 1.5 / math.tan(math.radians(40.0))
    assert seen.project(np.array([[lowest, 0.0, 0.0]]))[0] == pytest.approx([159.5, 239.5])


def test_a_pose_that_is_not_given_is_that_of_the_floor(tmp_path: Path) -> None:
    colour, depth = write_rgbd(tmp_path)
    (found,) = {frame.calibrations[DEPTH].position_m[2] for frame in frames(colour, depth)}
    assert found == pytest.approx(1.2, abs=0.02)
    assert_names(call(colour, *options(depth)).stderr, "note: camera", "above the floor", "--pitch-deg")
    camera = FootageCamera(height_m=1.5)
    (given,) = {frame.calibrations[DEPTH].position_m[2] for frame in frames(colour, depth, camera=camera)}
    assert given == 1.5
    for path in depth.iterdir():
        write_counts(path, np.full((240, 320), 2000.0))
    message = call(colour, *options(depth), "--overwrite").stderr
    assert_names(message, "note: camera: no floor", "1.2 m", "--camera-height-m")


def test_pictures_named_by_seconds_go_together_by_time_and_tell_it(tmp_path: Path) -> None:
    colour, depth = write_rgbd(tmp_path, stamps=STAMPS, depth_stamps=["7.12", "7.19", "7.33", "7.41"])
    write_counts(depth / "6.90.png", np.zeros((240, 320)))
    seen = frames(colour, depth)
    assert [frame.time_s for frame in seen] == pytest.approx([0.0, 0.1, 0.2, 0.3])
    for k, frame in enumerate(seen):
        np.testing.assert_array_equal(frame.depth(DEPTH), depth_mm(k))
    assert_names(refused_call(colour, depth, "--rate-hz", 10), "--rate-hz", "times")
    (depth / "7.33.png").rename(depth / "7.36.png")
    message = call(colour, *options(depth), *POSE).stderr
    assert_names(message, "note: ", colour / "7.30.png", "1 of 4 pictures")
    for name in ("7.12", "7.19"):
        (depth / f"{name}.png").unlink()
    assert_names(refused_call(colour, depth), "0.050 s", "3 of 4 pictures")


def test_who_looks_down_too_far_is_told(tmp_path: Path) -> None:
    colour, depth = write_rgbd(tmp_path, 1)
    assert "30 degrees" not in call(colour, *options(depth), "--pitch-deg", 30).stderr
    told = call(colour, *options(depth), "--pitch-deg", -40, "--overwrite").stderr
    assert "30 degrees of pitch" in told


def test_odometry_goes_to_the_tracker(tmp_path: Path) -> None:
    colour, depth = write_rgbd(tmp_path, 2)
    moved = tmp_path / "moved.csv"
    moved.write_text("advance_m,aside_m,turn_deg\n0,0,0\n0.05,0,180\n")
    seen = frames(colour, depth, odometry=moved)
    assert [frame.odometry for frame in seen] == [Odometry(), Odometry(advance_m=0.05, turn_rad=math.pi)]
    assert call(colour, *options(depth), "--odometry", moved).exit_code == 0
    moved.write_text("advance_m,aside_m,turn_deg\n0,0,0\n")
    assert_names(refused_call(colour, depth, "--odometry", moved, "--overwrite"), moved, "2", "got 1")


@pytest.mark.parametrize("scale", ["0", "-0.001", "nan", "inf", "1"])
def test_a_scale_that_cannot_be_is_refused(tmp_path: Path, scale: str) -> None:
    assert_names(refused_call(*write_rgbd(tmp_path), scale=scale), "--depth-scale", "0.001")


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--tracker", "contour"), ("contour", "'thermal'", "--depth")),
        (("--tracker", "handover"), ("handover", "'thermal'")),
        (("--polarity", "black-hot"), ("--depth", "--polarity")),
        (("--scale", "centikelvin"), ("--depth", "--scale")),
        (("--start", "10,10,20,20"), ("--start", "rgbd")),
        (("--focal-px", 300, "--vertical-fov-deg", 40), ("--focal-px", "--vertical-fov-deg")),
        (("--focal-px", 0), ("--focal-px",)),
        (("--vertical-fov-deg", 180), ("--vertical-fov-deg", "180")),
        (("--camera-height-m", -1), ("--camera-height-m", "-1")),
        (("--pitch-deg", "nan"), ("--pitch-deg", "nan")),
        (("--odometry", "none.csv"), ("none.csv",)),
    ],
)
def test_options_that_do_not_go_with_depth_are_refused(
    tmp_path: Path, arguments: tuple[object, ...], named: tuple[str, ...]
) -> None:
    assert_names(refused_call(*write_rgbd(tmp_path), *arguments), *named)


def test_depth_and_its_options_ask_for_each_other(tmp_path: Path) -> None:
    colour, depth = write_rgbd(tmp_path)
    out = ("--out", tmp_path / "out")
    assert_names(refusal(colour, *out, "--depth", depth), "--depth-scale", "0.001")
    assert_names(refusal(colour, *out, "--depth-scale", 1), "--depth FOLDER")
    assert_names(refusal(colour, *out, "--odometry", depth), "--odometry", "--depth or --panorama")
    assert_names(refusal(colour, *out, "--tracker", "rgbd"), "rgbd", "--depth")
    assert not (tmp_path / "out").exists()


def test_pictures_that_do_not_belong_together_are_refused(tmp_path: Path) -> None:
    colour, depth = write_rgbd(tmp_path)
    for number in (3, 4):
        (depth / f"{number}.png").unlink()
    assert_names(refused_call(colour, depth), depth, colour, "4", "got 2")
    for number in range(1, 5):
        write_counts(depth / f"{number}.png", np.full((120, 160), 4000))
    assert_names(refused_call(colour, depth), depth / "1.png", "320x240", "160x120")


@pytest.mark.parametrize(
    ("picture", "named"),
    [
        (np.full((240, 320), 90, np.uint8), ("16-bit", "uint8")),
        (np.full((240, 320), 2.5, np.float32), ("16-bit", "float32")),
        (np.full((240, 320), np.nan, np.float32), ("finite",)),
    ],
)
def test_depth_that_is_no_counts_is_refused(
    tmp_path: Path, picture: np.ndarray, named: tuple[str, ...]
) -> None:
    colour, depth = write_rgbd(tmp_path, 1)
    (depth / "1.png").unlink()
    Image.fromarray(picture).save(depth / "1.tiff")
    assert_names(refused_call(colour, depth), depth, *named)


def test_float_colours_a_run_and_a_file_in_place_of_a_folder_are_refused(tmp_path: Path) -> None:
    colour, depth = write_rgbd(tmp_path, 1)
    assert_names(refused_call(colour / "1.png", depth), "1.png", "folder")
    (colour / "run.json").touch()
    assert_names(refused_call(colour, depth), colour / "depth_colour")
    (colour / "run.json").unlink()
    (colour / "1.png").unlink()
    Image.fromarray(np.full((240, 320), 2.5, np.float32)).save(colour / "1.tiff")
    assert_names(refused_call(colour, depth), colour, "8-bit", "float32")


def test_the_depth_that_is_read_is_not_replaced(tmp_path: Path) -> None:
    colour, depth = write_rgbd(tmp_path, 1)
    told = refusal(colour, "--depth", depth, "--depth-scale", 0.001, "--out", depth, "--overwrite")
    assert_names(told, depth)
    assert (depth / "1.png").is_file()


@pytest.mark.slow
def test_boxes_of_others_are_scored_in_the_colour_picture(run: Path, tmp_path: Path) -> None:
    people = pq.read_table(run / "truth" / "depth.parquet").to_pylist()
    lines = [
        f"{row['frame']},{row['id']},{row['left_px']},{row['top_px']},{row['width_px']},{row['height_px']},1,1,1\n"
        for row in people
    ]
    truth = tmp_path / "gt.txt"
    truth.write_text("".join(lines), encoding="utf-8")
    arguments = ("--depth", run / "depth", "--depth-scale", 0.001, "--truth", truth)
    done = call(run / "depth_colour", *arguments, "--out", tmp_path / "out")
    assert done.exit_code == 0, done.output
    assert json.loads((tmp_path / "out" / "metrics.json").read_text())["mot"]["IDF1_percent"] > 80
