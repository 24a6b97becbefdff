"""A third camera, which only a scenario file mentions, is in all that a run leaves and gives."""

from __future__ import annotations

import json
from pathlib import Path

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
from peopleboy.scenarios.export.video import BAR_PX, HEIGHT_PX
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.runs.exported import SCENE, export, run_cli

# It looks back, where only carl is, at every third instant.
REAR = {"kind": "thermal", "width_px": 160, "height_px": 120, "mount_m": [-0.3, 0.0, 1.3], "yaw_deg": 180.0}
TALL = {"kind": "thermal", "width_px": 16, "height_px": 2048, "rate_hz": 1}
WIDE = {"kind": "colour", "width_px": 2048, "height_px": 16, "rate_hz": 1}
CARL = {"name": "carl", "path": [{"at_m": [1.0, 0.3]}, {"at_m": [1.0, 1.0], "speed_m_s": 0.5}]}
BEHIND = SCENE | {
    "name": "behind",
    "duration_s": 1.0,
    "place": {"kind": "room", "length_m": 12.0, "width_m": 6.0},
    "things": [],
    "people": [{"name": "anna", "path": [{"at_m": [9.5, -0.4]}]}, CARL],
    "robot": {
        "at_m": [6.0, 0.0],
        "cameras": {**SCENE["robot"]["cameras"], "rear": {**REAR, "rate_hz": 5}, "tall": TALL, "wide": WIDE},
        "behaviour": "scripted",
        "commands": [{"from_s": 0.0, "linear_m_s": 0.1, "angular_deg_s": 5.0}],
    },
}
DUE = [1, 4, 7, 10, 13]


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("further") / "behind.yaml"
    path.write_text(yaml.safe_dump(BEHIND), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def run(scene: Path) -> Path:
    folder = scene.parent / "behind-0"
    assert run_cli("run", scene, "--out", folder, "--frames") == 0
    return folder


def names(folder: Path) -> list[int]:
    return [int(path.stem) for path in sorted(folder.glob("*.png"))]


@pytest.mark.slow
def test_the_run_has_its_images_when_they_are_due_and_its_truth(run: Path) -> None:
    assert names(run / "rear") == names(run / "rear16") == DUE
    assert names(run / "thermal") == names(run / "colour") == list(range(1, 16))
    people = pq.read_table(run / "truth" / "rear.parquet").to_pylist()
    assert [row["frame"] for row in people if row["name"] == "carl" and row["visible_px"] > 300] == DUE
    assert not any(row["visible_px"] for row in people if row["name"] == "anna")
    lines = (run / "truth" / "rear.gt.txt").read_text(encoding="utf-8").splitlines()
    assert {int(line.split(",")[1]) for line in lines} == {2}


def test_carl_is_warm_where_the_truth_s_box_is(run: Path) -> None:
    row = next(row for row in pq.read_table(run / "truth" / "rear.parquet").to_pylist() if row["id"] == 2)
    left, top, width, height = (
        round(row[f"visible_{edge}_px"]) for edge in ("left", "top", "width", "height")
    )
    image = cv2.imread(str(run / "rear" / "000001.png"), cv2.IMREAD_GRAYSCALE).astype(float)
    inside = image[top : top + height, left : left + width]
    assert inside.mean() > 3.0 * np.delete(image, np.s_[left - 2 : left + width + 2], axis=1).mean()


def test_the_recording_has_a_view_of_it(run: Path) -> None:
    told: dict[str, int] = {}
    for chunk in RrdReader(run / "recording.rrd").stream():
        told[chunk.entity_path] = told.get(chunk.entity_path, 0) + (not chunk.is_static and chunk.num_rows)
    assert told["/world/robot/rear/image"] == told["/world/robot/rear/truth/boxes"] == len(DUE)


def test_coco_has_its_images_and_masks(run: Path, tmp_path: Path) -> None:
    out = export(run, "coco", tmp_path / "coco")
    content = json.loads((out / "annotations" / "rear" / "person_keypoints.json").read_text())
    assert [image["frame_id"] for image in content["images"]] == DUE
    assert all((out / "images" / image["file_name"]).is_file() for image in content["images"])
    assert all((out / "images" / image["thermal_file_name"]).is_file() for image in content["images"])
    assert {one["name"] for one in content["annotations"]} == {"carl"}
    own = json.loads((out / "annotations" / "person_keypoints.json").read_text())
    assert ["rear_file_name" in image for image in own["images"]] == [k in DUE for k in range(1, 16)]


def test_a_bag_has_its_topics(run: Path, tmp_path: Path) -> None:
    out = export(run, "mcap", tmp_path / "mcap")
    with (out / "behind-0" / "behind-0.mcap").open("rb") as file:
        told = [channel.topic for _, channel, _ in make_reader(file).iter_messages()]
    for topic in ("/rear/image_raw/compressed", "/rear/camera_info", "/truth/rear/people"):
        assert told.count(topic) == len(DUE)


@pytest.mark.slow
@pytest.mark.parametrize("camera", ["tall", "wide"])
def test_sheets_and_films_stay_in_shape(run: Path, tmp_path: Path, camera: str) -> None:
    tile = read_tiles(run / "contact_sheet.png")[0].picture
    assert tile.height < 4.0 * tile.width
    assert run_cli("export", run, "--format", "mp4", "--camera", camera, "--out", tmp_path / "film") == 0
    with av.open(str(tmp_path / "film" / "behind-0.mp4")) as film:
        (frame,) = film.decode(video=0)
    assert frame.height == HEIGHT_PX + BAR_PX
    assert frame.width <= 4 * HEIGHT_PX


def test_an_environment_gives_its_newest_image(scene: Path) -> None:
    env = PeopleBoyEnv(scene, observation="pixels", image_size=(80, 60))
    first, _ = env.reset(seed=1)
    assert env.observation_space.contains(first)
    images = [first, *(env.step([0.2, 0.5])[0] for _ in range(3))]
    env.close()
    is_old = [np.array_equal(one["rear"], first["rear"]) for one in images]
    assert is_old == [True, True, True, False]


def test_what_it_sees_depends_neither_on_others_nor_on_who_looked_before(scene: Path) -> None:
    config = load_scenario(scene).world(0)
    seen = []
    for asked in (["rear"], ["colour", "thermal", "rear"], []):
        with SimulatedWorld(config) as world:
            for tick in range(4):
                images = world.observe().images
                assert ("rear" in images) == (tick in (0, 3))
                for name in (name for name in asked if name in images):
                    images[name]
                if tick < 3:
                    world.step(0.1, 0.2)
            seen.append((images["rear"].tobytes(), images["rear_c"].tobytes(), images["thermal"].tobytes()))
    assert seen[0] == seen[1] == seen[2]
