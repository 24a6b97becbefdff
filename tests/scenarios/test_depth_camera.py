"""A run with a depth camera, and all that it leaves; scenes whose depth cameras are refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, ClassVar

import av
import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rerun.chunk import RrdReader

from peopleboy.registry import Entry
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.sim.cameras.camera_config import DepthConfig
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.tracker.frame import DEPTH as DEPTH_CAMERA
from peopleboy.tracker.frame import DEPTH_COLOUR, Frame
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import TRACKERS
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import CAMERAS, SCENE, export, make_run

DEPTH = {"kind": "depth", "width_px": 161, "height_px": 121, "rate_hz": 5}
SEEN: dict[str, Any] = SCENE | {
    "name": "seen",
    "duration_s": 1.0,
    "robot": SCENE["robot"] | {"cameras": {**CAMERAS, "depth": DEPTH}},
    "faults": [{"kind": "camera_black", "from_s": 0.75}],
}
DUE = [1, 4, 7, 10, 13]
BLACK = 13


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    scene = tmp_path_factory.mktemp("depth") / "seen.yaml"
    scene.write_text(yaml.safe_dump(SEEN), encoding="utf-8")
    assert run_cli("run", scene, "--out", scene.parent / "seen-0", "--frames") == 0
    return scene.parent / "seen-0"


def image(run: Path, folder: str, frame: int) -> np.ndarray:
    return cv2.imread(str(run / folder / f"{frame:06d}.png"), cv2.IMREAD_UNCHANGED)


@pytest.mark.slow
def test_its_folders_have_millimetres_and_colours_and_the_truth(run: Path) -> None:
    for folder, shape, dtype in (("depth", (121, 161), np.uint16), ("depth_colour", (121, 161, 3), np.uint8)):
        assert [int(path.stem) for path in sorted((run / folder).glob("*.png"))] == DUE
        assert (image(run, folder, 1).shape, image(run, folder, 1).dtype) == (shape, dtype)
    people = pq.read_table(run / "truth" / "depth.parquet").to_pylist()
    assert {row["frame"] for row in people} == {*DUE}
    for row in (row for row in people if row["frame"] == 1 and row["visible_fraction"] > 0.9):
        left, top = row["visible_left_px"] + 0.5, row["visible_top_px"] + 0.5
        depth = image(run, "depth", 1)[
            round(top) : round(top + row["visible_height_px"]),
            round(left) : round(left + row["visible_width_px"]),
        ]
        nearest_m = np.quantile(depth[depth > 0], 0.05) / 1000.0
        lens_m = SCENE["robot"]["at_m"][0] + DepthConfig().camera.position_m[0]
        assert nearest_m == pytest.approx(row["x_m"] - lens_m - 0.2, abs=0.2)
    assert len((run / "truth" / "depth.gt.txt").read_text(encoding="utf-8").splitlines()) == len(people)


def test_a_black_camera_reads_no_depth(run: Path) -> None:
    assert not image(run, "depth", BLACK).any()
    assert image(run, "depth", 10).any()


def test_the_recording_has_depth_in_metres_and_points_in_the_world(run: Path) -> None:
    told: dict[str, int] = {}
    points, colours = np.empty((0, 3)), []
    for chunk in RrdReader(run / "recording.rrd").stream():
        told[chunk.entity_path] = told.get(chunk.entity_path, 0) + (not chunk.is_static and chunk.num_rows)
        table = chunk.to_record_batch()
        for name in table.schema.names:
            if chunk.entity_path == "/world/points/depth" and name.endswith("positions"):
                points = np.concatenate([points, *(np.array(row) for row in table[name].to_pylist() if row)])
            if chunk.entity_path == "/world/points/depth" and name.endswith("colors"):
                colours += [colour for row in table[name].to_pylist() for colour in row]
    assert told["/world/robot/depth/image"] == told["/world/points/depth"] == len(DUE)
    assert len(points) == len(colours) > 10_000
    # A room of 8 x 6 m, 2.7 m high.
    inside = (np.array([-0.3, -3.3, -0.15]) < points) & (points < np.array([8.3, 3.3, 2.9]))
    assert inside.mean(axis=0).min() > 0.99
    assert (np.abs(points[:, 2]) < 0.02).sum() > 1000


@pytest.mark.slow
def test_the_sheet_the_report_and_a_film_show_it(run: Path, tmp_path: Path) -> None:
    assert run_cli("report", run, "--out", tmp_path / "page.html") == 0
    assert "161x121 pixels, 5 a second (depth)" in (tmp_path / "page.html").read_text(encoding="utf-8")
    assert run_cli("export", run, "--format", "mp4", "--camera", "depth", "--out", tmp_path / "films") == 0
    with av.open(str(tmp_path / "films" / "seen-0.mp4")) as film:
        first = next(film.decode(video=0)).to_ndarray(format="rgb24")[40:]
    colour = first.reshape(-1, 3).astype(int)
    assert (np.ptp(colour, axis=1) > 60).mean() > 0.3


def test_coco_names_its_files_and_mot_has_its_millimetres(run: Path, tmp_path: Path) -> None:
    coco = export(run, "coco", tmp_path / "coco")
    content = json.loads((coco / "annotations" / "depth" / "person_keypoints.json").read_text())
    assert [one["frame_id"] for one in content["images"]] == DUE
    assert np.shape(content["videos"][0]["cameras"]["depth"]["intrinsics"]) == (3, 3)
    for key in ("file_name", "depth_colour_file_name"):
        assert (coco / "images" / content["images"][0][key]).is_file()
    stored = cv2.imread(str(coco / "images" / content["images"][0]["file_name"]), cv2.IMREAD_UNCHANGED)
    assert np.array_equal(stored, image(run, "depth", 1))
    assert run_cli("export", run, "--format", "mot", "--camera", "depth", "--out", tmp_path / "mot") == 0
    (first,) = (tmp_path / "mot").rglob("img1/000001.png")
    assert np.array_equal(cv2.imread(str(first), cv2.IMREAD_UNCHANGED), image(run, "depth", 1))


def test_mcap_has_its_depth_its_colours_and_their_points(run: Path, tmp_path: Path) -> None:
    found: dict[str, list[Any]] = {}
    with (export(run, "mcap", tmp_path / "mcap") / "seen-0" / "seen-0.mcap").open("rb") as file:
        for _, channel, _, message in make_reader(
            file, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages():
            found.setdefault(channel.topic, []).append(message)
    for topic in ("image_raw", "colour/image_raw/compressed", "points", "camera_info"):
        assert len(found[f"/depth/{topic}"]) == len(DUE), topic
        assert {one.header.frame_id for one in found[f"/depth/{topic}"]} == {"depth_optical"}
    depth, info, cloud = (found[f"/depth/{topic}"][1] for topic in ("image_raw", "camera_info", "points"))
    assert (depth.encoding, depth.step, depth.is_bigendian) == ("16UC1", 322, 0)
    read = np.frombuffer(bytes(depth.data), "<u2").reshape(depth.height, depth.width)
    assert np.array_equal(read, image(run, "depth", DUE[1]))
    assert [(one.name, one.offset) for one in cloud.fields] == [("x", 0), ("y", 4), ("z", 8), ("rgb", 12)]
    points = np.frombuffer(bytes(cloud.data), "<f4").reshape(cloud.width, 4)
    assert cloud.row_step == cloud.width * cloud.point_step == len(cloud.data)
    pixels = points[:, :3] @ np.reshape(info.k, (3, 3)).T
    columns, rows = np.rint(pixels[:, :2] / pixels[:, 2:]).astype(int).T
    assert np.array_equal(np.rint(1000.0 * points[:, 2]), read[rows, columns])
    blue = np.ascontiguousarray(points[:, 3]).view(np.uint32) & 255
    assert np.array_equal(blue, image(run, "depth_colour", DUE[1])[rows, columns, 0])
    assert not found["/depth/points"][-1].width


@pytest.mark.slow
def test_a_rendered_set_counts_its_millimetres(tmp_path: Path) -> None:
    scene, out = tmp_path / "seen.yaml", tmp_path / "set"
    scene.write_text(yaml.safe_dump(SEEN | {"faults": []}), encoding="utf-8")
    assert run_cli("render", scene, "--frames", "--seeds", "1", "--workers", "1", "--out", out) == 0
    assert "| depth images, mean ± deviation [mm] |" in (out / "README.md").read_text(encoding="utf-8")
    statistics = json.loads((out / "dataset.json").read_text(encoding="utf-8"))["statistics"]["all"]
    (first,) = out.glob("*/depth/000001.png")
    assert statistics["image_mean"]["depth"] == [
        pytest.approx(cv2.imread(str(first), cv2.IMREAD_UNCHANGED).mean(), abs=0.01)
    ]


def test_an_environment_gives_its_millimetres(run: Path) -> None:
    env = PeopleBoyEnv(run.parent / "seen.yaml", observation="pixels", image_size=(96, 64))
    seen, _ = env.reset(seed=0)
    space = env.observation_space["depth"]
    assert (space.shape, space.dtype) == ((64, 96, 1), np.uint16)
    assert space.contains(seen["depth"])
    assert seen["depth"].max() > 1000
    assert "depth_colour" not in seen
    env.close()


def test_a_scene_changes_all_its_settings_and_a_tracker_may_ask_for_one(run: Path, tmp_path: Path) -> None:
    said = {
        "kind": "depth", "sensor": "tof", "scale": 3, "nearest_m": 0.3, "farthest_m": 5, "colour": False,
        "width_px": 176, "height_px": 144, "pitch_deg": 12,
    }  # fmt: skip
    scene = SCENE | {"robot": SCENE["robot"] | {"cameras": {"swiss": said}}}
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(scene), encoding="utf-8")
    camera = load_scenario(tmp_path / "scene.yaml").world(0).robot.cameras["swiss"]
    assert isinstance(camera, DepthConfig)
    assert (camera.sensor, camera.scale, camera.nearest_m, camera.farthest_m) == ("tof", 3.0, 0.3, 5.0)
    assert (camera.colour, camera.camera.width, camera.camera.height) == (False, 176, 144)
    usual = open_run(run).scenario.mounting(("depth",))
    assert usual.world(0).robot.cameras["depth"].camera.width == 161
    mounted = load_scenario("single_follow").mounting(("depth",)).world(0).robot.cameras["depth"]
    assert mounted == DepthConfig()
    assert isinstance(mounted.camera, Pinhole)
    assert (mounted.camera.width, mounted.camera.height, mounted.camera.position_m[2]) == (640, 480, 1.2)


class Floor:
    """A tracker that sees nobody, and keeps the heights [m] of what it sees in the lowest rows."""

    cameras = (DEPTH_CAMERA,)
    heights: ClassVar[list[np.ndarray]] = []

    def __init__(self, rng: np.random.Generator) -> None:
        del rng

    def update(self, frame: Frame) -> tuple[Track, ...]:
        depth, colour = frame.depth(DEPTH_CAMERA), frame.rgb(DEPTH_COLOUR)
        assert colour.shape == (*depth.shape, 3)
        calibration = frame.calibrations[DEPTH_CAMERA]
        rows, columns = np.nonzero(depth[400:])
        z = depth[400:][rows, columns, None] / 1000.0
        rays = calibration.rays(np.stack([columns, rows + 400], axis=1).astype(float))
        self.heights.append((np.array(calibration.position_m) + z * rays)[:, 2])
        return ()


def test_a_tracker_that_wants_depth_is_given_the_usual_camera_and_finds_the_floor(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(TRACKERS.shipped, "floor", Entry(Floor))
    monkeypatch.setattr(Floor, "heights", [])
    make_run(SCENE | {"duration_s": 0.4, "things": []}, tmp_path / "run", "--tracker", "floor")
    told = json.loads((tmp_path / "run" / "run.json").read_text(encoding="utf-8"))
    assert told["mounted_for_tracker"] == ["depth"]
    assert len(Floor.heights) == 6
    assert np.median(np.concatenate(Floor.heights)) == pytest.approx(0.0, abs=0.003)
    assert np.abs(np.quantile(np.concatenate(Floor.heights), (0.05, 0.5))).max() < 0.02


@pytest.mark.parametrize(
    ("settings", "names"),
    [
        ({"scale": -1}, ("scale", "-1")),
        ({"sensor": "laser"}, ("sensor", "kinect", "laser")),
        ({"nearest_m": 4.0, "farthest_m": 2.0}, ("farthest_m", "2.0", "nearest_m")),
        ({"rate_hz": 4}, ("rate_hz", "4", "5")),
        ({"width_px": 5000}, ("width_px", "5000")),
        ({"width_px": 4096, "height_px": 4096}, ("pixels",)),
        ({"width_px": 64.5}, ("width_px",)),
        ({"blur_px": 1.0}, ("blur_px",)),
    ],
)
def test_what_no_depth_camera_has_is_refused_in_one_line(
    settings: dict[str, Any], names: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = SCENE | {"robot": SCENE["robot"] | {"cameras": {"depth": {"kind": "depth", **settings}}}}
    (tmp_path / "bad.yaml").write_text(yaml.safe_dump(scene), encoding="utf-8")
    said = refusal(capsys, "run", tmp_path / "bad.yaml", "--out", tmp_path / "none")
    assert_names(said, "robot.cameras.depth", *names)
    assert not (tmp_path / "none").exists()


def test_a_depth_camera_must_not_take_the_folder_of_another_s_colours(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cameras = {"depth": {"kind": "depth"}, "depth_colour": {"kind": "colour"}}
    scene = SCENE | {"robot": SCENE["robot"] | {"cameras": cameras}}
    (tmp_path / "bad.yaml").write_text(yaml.safe_dump(scene), encoding="utf-8")
    said = refusal(capsys, "run", tmp_path / "bad.yaml", "--out", tmp_path / "none")
    assert_names(said, "depth_colour", "choose another")
