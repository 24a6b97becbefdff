"""A toy camera of a kind and a geometry of its own: one registration, and it is in all that a run leaves."""

from __future__ import annotations

import configparser
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar
from xml.etree import ElementTree

import av
import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from mcap.reader import make_reader
from rerun.chunk import RrdReader

from peopleboy.scenarios.drawing.contact_sheet import read_tiles
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.sim.cameras.camera_config import CameraConfig
from peopleboy.sim.cameras.imaging.camera_view import CameraView
from peopleboy.sim.cameras.kinds import KINDS, CameraKind
from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.rendering.renderer import PINHOLE_RENDERER, Renderer, Scene
from peopleboy.sim.rendering.view import View
from tests.helpers.calls.command_line import refusal
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import CAMERAS, SCENE, export, run_cli


@dataclass(frozen=True, slots=True, kw_only=True)
class Ring:
    """Looks all round, backwards at its ends: each column is a pinhole of one pixel's width."""

    width: int = 64
    height: int = 48
    position_m: tuple[float, float, float] = (0.0, 0.0, 1.4)

    def column(self, u: float) -> Pinhole:
        turn = math.pi - math.tau * (u + 0.5) / self.width
        return Pinhole(width=1, height=self.height, position_m=self.position_m, yaw_rad=turn)

    @property
    def calibration(self) -> None:
        return None

    @property
    def robot_from_camera(self) -> Matrix:
        return self.column((self.width - 1) / 2.0).robot_from_camera

    def project(self, camera_points: Matrix) -> Matrix:
        x, y, z = np.moveaxis(camera_points, -1, 0)
        u = (np.arctan2(x, z) / math.tau + 0.5) * self.width - 0.5
        return np.stack([u, self.column(0).focal_px * y / np.hypot(x, z) + (self.height - 1) / 2.0], axis=-1)


class RingRenderer(Renderer):
    def view(self, scene: Scene, camera: Ring, world_from_camera: Matrix) -> View:
        world_from_robot = world_from_camera @ np.linalg.inv(camera.robot_from_camera)
        lenses = [camera.column(u) for u in range(camera.width)]
        slits = [
            PINHOLE_RENDERER.view(scene, lens, world_from_robot @ lens.robot_from_camera) for lens in lenses
        ]
        layers = ([getattr(slit, name) for slit in slits] for name in ("part", "depth", "normal", "cover"))
        return View(*(np.concatenate(layer, axis=1) for layer in layers))


@dataclass(frozen=True, slots=True, kw_only=True)
class RingConfig(CameraConfig):
    kind: ClassVar[str] = "ring"
    camera: Ring = field(default_factory=Ring)


class NearSensor:
    def __init__(self, config: RingConfig, name: str, seed: int) -> None:
        del config, name, seed

    def take(self, glimpse: CameraView) -> tuple[np.ndarray, ...]:
        return (np.uint8(255.0 * np.clip(1.0 - glimpse.view.depth / 10.0, 0.0, 1.0)),)

    def skip(self) -> None:
        pass


TOY = CameraKind(config=RingConfig, sensor=NearSensor, renderer=RingRenderer())
ROUND = SCENE | {
    "name": "round",
    "duration_s": 1.0,
    "place": {"kind": "room", "length_m": 12.0, "width_m": 6.0},
    "things": [],
    "people": [
        {"name": "anna", "path": [{"at_m": [9.5, -0.4]}]},
        {"name": "carl", "path": [{"at_m": [6.0, 2.5]}]},
    ],
    "robot": {"at_m": [6.0, 0.0], "cameras": {**CAMERAS, "all": {"kind": "ring", "rate_hz": 5}}},
}
VIPER_OBJECT = "{http://lamp.cfar.umd.edu/viper#}object"
DUE = [1, 4, 7, 10, 13]


@pytest.fixture(scope="module", autouse=True)
def _toy() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(KINDS, "ring", TOY)
        yield


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    scene = tmp_path_factory.mktemp("toy") / "round.yaml"
    scene.write_text(yaml.safe_dump(ROUND), encoding="utf-8")
    assert run_cli("run", scene, "--out", scene.parent / "round-0", "--frames") == 0
    return scene.parent / "round-0"


@pytest.mark.slow
def test_its_folder_has_images_and_the_truth_of_them(run: Path) -> None:
    assert [int(path.stem) for path in sorted((run / "all").glob("*.png"))] == DUE
    image = cv2.imread(str(run / "all" / "000001.png"), cv2.IMREAD_UNCHANGED)
    assert image.shape == (48, 64)
    people = pq.read_table(run / "truth" / "all.parquet").to_pylist()
    assert [row["frame"] for row in people] == [frame for frame in DUE for _ in range(2)]
    for row, ahead, distance in ((people[0], 32, 3.5), (people[1], 16, 2.5)):
        middle = row["visible_left_px"] + row["visible_width_px"] / 2.0
        assert middle == pytest.approx(ahead, abs=2.0)
        assert row["visible_fraction"] == 1.0
        assert row["joints_px"][0] == pytest.approx(middle, abs=2.0)
        top = round(row["visible_top_px"] + row["visible_height_px"] / 2.0)
        near = image[top : top + 3, round(middle) - 1 : round(middle) + 1].max()
        assert near == pytest.approx(255.0 - 25.5 * distance, abs=12.0)
    assert len((run / "truth" / "all.gt.txt").read_text(encoding="utf-8").splitlines()) == 2 * len(DUE)


@pytest.mark.slow
def test_the_recording_the_sheet_and_the_report_have_it(run: Path) -> None:
    told: dict[str, int] = {}
    for chunk in RrdReader(run / "recording.rrd").stream():
        told[chunk.entity_path] = told.get(chunk.entity_path, 0) + (not chunk.is_static and chunk.num_rows)
    assert told["/world/robot/all/image"] == told["/world/robot/all/truth/boxes"] == len(DUE)
    tile = read_tiles(run / "contact_sheet.png")[0].picture
    assert tile.height == 3 * round(tile.width * 3 / 4) + 2 * 3
    assert run_cli("report", run, "--out", run / "page.html") == 0
    assert "64x48 pixels, 5 a second (all)" in (run / "page.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_formats_that_tell_of_all_cameras_tell_of_it(run: Path, tmp_path: Path) -> None:
    coco = export(run, "coco", tmp_path / "coco")
    content = json.loads((coco / "annotations" / "all" / "person_keypoints.json").read_text())
    assert [image["frame_id"] for image in content["images"]] == DUE
    assert len(content["annotations"]) == 2 * len(DUE)
    assert "intrinsics" not in content["videos"][0]["cameras"]["all"]
    with (export(run, "mcap", tmp_path / "mcap") / "round-0" / "round-0.mcap").open("rb") as file:
        told = [channel.topic for _, channel, _ in make_reader(file).iter_messages()]
    assert told.count("/all/image_raw/compressed") == told.count("/truth/all/people") == len(DUE)
    assert "/all/camera_info" not in told


@pytest.mark.slow
def test_formats_that_tell_of_one_camera_can_tell_of_it(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for form in ("mot", "viper", "mp4"):
        assert run_cli("export", run, "--format", form, "--camera", "all") == 0
    mot, viper, films = (run.parent / f"round-0-{form}-all" for form in ("mot", "viper", "mp4"))
    (sequence,) = (mot / "gt" / "mot_challenge" / "peopleboy-all").iterdir()
    about = configparser.ConfigParser()
    about.read(sequence / "seqinfo.ini")
    told = {key: int(about["Sequence"][key]) for key in ("frameRate", "seqLength", "imWidth", "imHeight")}
    assert told == {"frameRate": 5, "seqLength": len(DUE), "imWidth": 64, "imHeight": 48}
    lines = (sequence / "gt" / "gt.txt").read_text(encoding="utf-8").splitlines()
    assert [int(line.split(",")[0]) for line in lines] == [1, 1, 2, 2, 3, 3, 4, 4, 5, 5]
    for number, frame in enumerate(DUE, start=1):
        image = (sequence / "img1" / f"{number:06d}.png").read_bytes()
        assert image == (run / "all" / f"{frame:06d}.png").read_bytes()
    assert not (mot / "trackers").exists()
    things = ElementTree.parse(viper / "round-0" / "truth.xgtf").iter(VIPER_OBJECT)
    assert [thing.get("framespan") for thing in things] == ["1:5", "1:5"]
    assert not (viper / "round-0" / "tracks.xgtf").exists()
    with av.open(str(films / "round-0.mp4")) as film:
        assert film.streams.video[0].average_rate == 5
        assert sum(1 for _ in film.decode(video=0)) == len(DUE)
    out = ("--out", tmp_path / "none")
    for form, camera, name in (("mot", "rear", "thermal, colour, all"), ("coco", "all", "coco")):
        said = refusal(capsys, "export", run, "--format", form, "--camera", camera, *out)
        assert_names(said, "camera", camera, name)
    assert not (tmp_path / "none").exists()


def test_an_environment_gives_its_images(run: Path) -> None:
    env = PeopleBoyEnv(run.parent / "round.yaml", observation="pixels", image_size=(80, 60))
    seen, _ = env.reset(seed=0)
    env.close()
    assert seen["all"].shape == (60, 80, 1)


def test_keys_that_it_has_not_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for key, value in (("vertical_fov_deg", 60.0), ("netd_k", 0.1)):
        robot = {**ROUND["robot"], "cameras": {"all": {"kind": "ring", key: value}}}
        (tmp_path / "bad.yaml").write_text(yaml.safe_dump(ROUND | {"robot": robot}), encoding="utf-8")
        said = refusal(capsys, "run", tmp_path / "bad.yaml", "--out", tmp_path / "none")
        assert_names(said, "robot.cameras", "all", key)
    assert not (tmp_path / "none").exists()
