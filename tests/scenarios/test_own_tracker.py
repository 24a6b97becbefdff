"""A tracker of one's own, which looks at no image, is in all that a run leaves and gives."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import ClassVar

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rerun.chunk import RrdReader

from peopleboy.geometry.camera_calibration import PinholeCalibration
from peopleboy.registry import Entry
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import thermal_box
from peopleboy.scenarios.running.run import run as run_scenario
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.scenarios.scores.evaluate_runs import BoxReference, read_reference_boxes
from peopleboy.sim.cameras.camera_config import ThermalConfig
from peopleboy.sim.cameras.kinds import KINDS
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import FloorPlace, Status, Track
from peopleboy.tracker.trackers import TRACKERS, make_tracker
from tests.helpers.calls.refused import refused
from tests.helpers.runs.exported import SCENE, export, make_run, run_cli


class Reckoner:
    """Believes that somebody stands 4 m ahead at the start, and reckons where that is as the robot moves."""

    cameras = ()

    def __init__(self, _rng: np.random.Generator) -> None:
        self._x, self._y = 4.0, 0.0

    def update(self, frame: Frame) -> tuple[Track, ...]:
        if (moved := frame.odometry) is not None:
            x, y = self._x - moved.advance_m, self._y - moved.aside_m
            cosine, sine = math.cos(moved.turn_rad), math.sin(moved.turn_rad)
            self._x, self._y = x * cosine + y * sine, y * cosine - x * sine
        place = FloorPlace(position_m=(self._x, self._y), covariance_m2=(0.01, 0.0, 0.01))
        return (Track(id=1, place=place, confidence=1.0, status=Status.TRACKED, age_s=frame.time_s),)


STANDING = SCENE | {
    "name": "standing",
    "duration_s": 2.0,
    "things": [],
    "people": [{"name": "anna", "path": [{"at_m": [4.6, 0.0]}]}],
    "robot": SCENE["robot"] | {"tracker": "reckoner"},
}


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(TRACKERS.shipped, "reckoner", Entry(Reckoner))
        folder = tmp_path_factory.mktemp("own") / "run"
        make_run(STANDING, folder)
        assert run_cli("run", folder.parent / "standing.yaml", "--out", folder, "--overwrite") == 0
        assert run_cli("report", folder, "--out", folder.parent / "page.html") == 0
        export(folder, "mcap", folder.parent / "mcap")
        return folder


@pytest.mark.slow
def test_it_is_scored_on_the_floor_in_metres(run: Path) -> None:
    metrics = json.loads((run / "metrics.json").read_text(encoding="utf-8"))
    assert json.loads((run / "run.json").read_text(encoding="utf-8"))["tracker"] == "reckoner"
    assert (
        metrics["thesis"]["CR_percent"]
        == metrics["thesis"]["CP_percent"]
        == metrics["mot"]["IDF1_percent"]
        == 100.0
    )
    assert metrics["floor"]["p95_error_m"] < 0.05
    assert metrics["floor"]["in_ellipse_percent"] > 95.0
    assert (run / "tracks.txt").read_text(encoding="utf-8") == ""


class Seer(Reckoner):
    """Knows of somebody behind the robot, too, whom no camera sees."""

    def update(self, frame: Frame) -> tuple[Track, ...]:
        behind = FloorPlace(position_m=(-1.0, 0.5), covariance_m2=(0.01, 0.0, 0.01))
        (ahead,) = super().update(frame)
        return (ahead, replace(ahead, id=2, place=behind))


def test_who_is_in_no_image_is_nobody_to_find_and_no_false_alarm(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(TRACKERS.shipped, "reckoner", Entry(Seer))
    robot = {
        name: value for name, value in STANDING["robot"].items() if name not in ("commands", "behaviour")
    }
    ben = {"name": "ben", "path": [{"at_m": [1.0, 0.5]}]}
    scene = STANDING | {"people": [*STANDING["people"], ben], "robot": robot | {"at_m": [2.0, 0.0]}}
    scene["people"][0] = {"name": "anna", "path": [{"at_m": [6.0, 0.0]}]}
    counts = json.loads((make_run(scene, tmp_path / "run") / "metrics.json").read_text(encoding="utf-8"))[
        "counts"
    ]
    assert (counts["targets"], counts["matches"], counts["false_alarms"], counts["ignored"]) == (
        30,
        30,
        0,
        30,
    )


def test_its_places_are_in_the_tables_and_no_boxes(run: Path) -> None:
    rows = pq.read_table(run / "tracks.parquet").to_pylist()
    assert len(rows) == 30
    assert all(row["left_px"] is None and math.hypot(row["place_x_m"], row["place_y_m"]) > 3 for row in rows)


def test_it_is_in_recording_and_report(run: Path) -> None:
    paths = {chunk.entity_path for chunk in RrdReader(run / "recording.rrd").stream()}
    assert "/world/robot/places" in paths
    page = (run.parent / "page.html").read_text(encoding="utf-8")
    assert "1 person, tracked to the end; no identity lost" in page
    assert "mean error" in page


def test_it_is_in_a_bag_with_its_covariances(run: Path) -> None:
    with next((run.parent / "mcap").rglob("*.mcap")).open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        told = [m for _, c, _, m in reader.iter_decoded_messages() if c.topic == "/tracks/places"]
    assert len(told) == 30
    (standing,) = told[0].detections
    assert (told[0].header.frame_id, standing.id) == ("base_link", "1")
    assert standing.results[0].pose.pose.position.x == 4.0
    assert standing.results[0].pose.covariance[0] == standing.results[0].pose.covariance[7] == 0.01


def test_one_in_a_module_of_one_s_own_is_found_by_name_in_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mine_for_test.py").write_text(
        "class Blind:\n    cameras = ('rear',)\n    def __init__(self, rng): pass\n"
        "    def update(self, frame): return ()\nclass Other:\n    def __init__(self, rng): pass\n"
        "def tired(): pass\n",
        encoding="utf-8",
    )
    monkeypatch.chdir(tmp_path)
    assert make_tracker("mine_for_test:Blind").cameras == ("rear",)
    for name, wrong in [
        ("mine_for_test:Nobody", "no 'Nobody'"),
        ("mine_for_test:Other", "`update(frame)`"),
        ("mine_for_test:tired", "numpy.random.Generator"),
        ("nowhere_at_all:Blind", "cannot be imported"),
        (":Blind", "cannot be imported"),
    ]:
        with refused(f"tracker '{name}'", wrong):
            make_tracker(name)


class Peeping(Reckoner):
    """Wants a camera that the scenario lacks, and boxes everybody's place in it."""

    cameras = ("thermal", "rear")

    def update(self, frame: Frame) -> tuple[Track, ...]:
        shape = frame.images["rear"].shape
        return tuple(
            replace(t, boxes={"rear": (0.0, 0.0, shape[1], shape[0])}) for t in super().update(frame)
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RearConfig(ThermalConfig):
    kind: ClassVar[str] = "rear"
    camera: Pinhole = field(default_factory=lambda: Pinhole(width=80, height=60, yaw_rad=math.pi))


@pytest.mark.slow
def test_a_camera_that_it_wants_is_mounted_and_nothing_else_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(KINDS, "rear", replace(KINDS["thermal"], config=RearConfig))
    monkeypatch.setitem(TRACKERS.shipped, "peeping", Entry(Peeping))
    monkeypatch.setitem(TRACKERS.shipped, "reckoner", Entry(Reckoner))
    plain = make_run(STANDING, tmp_path / "plain")
    more = make_run(STANDING, tmp_path / "more", "--tracker", "peeping")
    assert json.loads((more / "run.json").read_text(encoding="utf-8"))["mounted_for_tracker"] == ["rear"]
    assert "mounted_for_tracker" not in json.loads((plain / "run.json").read_text(encoding="utf-8"))
    for name in ("truth/gt.txt", "tracks.txt", "truth.parquet", "robot.parquet", "tracks.parquet"):
        assert (plain / name).read_bytes() == (more / name).read_bytes(), name
    assert len((more / "tracks" / "rear.txt").read_text(encoding="utf-8").splitlines()) == 30
    assert run_cli("evaluate", more, "--camera", "rear") == 0
    assert run_cli("evaluate", plain, "--camera", "rear") == 2
    with refused("'front'", "thermal, colour, rear"):
        read_reference_boxes(more, BoxReference("front"))
    assert run_cli("export", more, "--format", "mot", "--camera", "rear", "--out", tmp_path / "mot") == 0
    given = next((tmp_path / "mot" / "trackers").rglob("standing-0.txt")).read_text(encoding="utf-8")
    assert given == (more / "tracks" / "rear.txt").read_text(encoding="utf-8")
    metrics = json.loads((more / "metrics.json").read_text(encoding="utf-8"))
    assert metrics["cameras"]["rear"]["counts"]["candidates"] == 30
    # Its scenario.yaml plays the same again.
    assert run_cli("run", more / "scenario.yaml", "--tracker", "peeping", "--out", tmp_path / "again") == 0
    assert (tmp_path / "again" / "tracks" / "rear.txt").read_bytes() == (
        more / "tracks" / "rear.txt"
    ).read_bytes()


class Everywhen(Reckoner):
    """Boxes everybody's place in the image of a camera, whether it took one or not."""

    def update(self, frame: Frame) -> tuple[Track, ...]:
        return tuple(replace(t, boxes={"slow": (0.0, 0.0, 9.0, 9.0)}) for t in super().update(frame))


def test_boxes_are_scored_in_frames_in_which_a_slow_camera_took_an_image(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(TRACKERS.shipped, "everywhen", Entry(Everywhen))
    monkeypatch.setitem(TRACKERS.shipped, "reckoner", Entry(Reckoner))
    cameras = STANDING["robot"].get("cameras", {}) | {"slow": {"kind": "thermal", "rate_hz": 5}}
    scene = STANDING | {"robot": STANDING["robot"] | {"cameras": cameras}}
    run = make_run(scene, tmp_path / "run", "--tracker", "everywhen")
    assert len((run / "tracks" / "slow.txt").read_text(encoding="utf-8").splitlines()) == 30
    metrics = json.loads((run / "metrics.json").read_text(encoding="utf-8"))
    counts = metrics["cameras"]["slow"]["counts"]
    assert (counts["candidates"], counts["frames"]) == (10, 10)


def test_a_camera_of_which_there_is_no_kind_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(TRACKERS.shipped, "peeping", Entry(Peeping))
    (tmp_path / "standing.yaml").write_text(
        yaml.safe_dump(STANDING | {"robot": SCENE["robot"]}), encoding="utf-8"
    )
    with refused("camera 'rear'", "robot.cameras", "thermal, colour"):
        run_scenario(
            load_scenario(tmp_path / "standing.yaml"),
            RunOptions(seed=0, out=tmp_path / "run", tracker="peeping"),
        )
    assert not (tmp_path / "run").exists()


THERMAL_CAMERA = PinholeCalibration(Pinhole().intrinsics, Pinhole().robot_from_camera)


@pytest.mark.parametrize("bearing", [0.0, 0.3, -0.3])
def test_somebody_without_a_box_is_where_the_thermal_image_shows_one_who_stands_there(bearing: float) -> None:
    track = at(0.14 + 5.0 * math.cos(bearing), 5.0 * math.sin(bearing))
    left, top, width, height = thermal_box(track, THERMAL_CAMERA)
    depth = 5.0 * math.cos(bearing)
    assert left + width / 2.0 == pytest.approx(159.5 - Pinhole().focal_px * math.tan(bearing))
    assert height == pytest.approx(Pinhole().focal_px * 1.72 / depth)
    assert top + height == pytest.approx(119.5 + Pinhole().focal_px * 1.2 / depth)


@pytest.mark.parametrize(
    ("x", "y", "side"), [(-3.0, 0.5, -1), (-3.0, -0.5, 1), (0.0, 2.0, -1), (0.0, -2.0, 1)]
)
def test_somebody_behind_is_beside_the_image_on_that_side(x: float, y: float, side: int) -> None:
    left, _, width, height = thermal_box(at(x, y), THERMAL_CAMERA)
    assert math.isfinite(height)
    assert (left + width / 2.0 - 159.5) * side > 500.0


def test_somebody_of_whom_nothing_is_known_is_nowhere() -> None:
    assert thermal_box(replace(at(1.0, 0.0), place=None), THERMAL_CAMERA) is None


def at(x: float, y: float) -> Track:
    place = FloorPlace(position_m=(x, y), covariance_m2=(0.01, 0.0, 0.01))
    return Track(id=1, place=place, confidence=1.0, status=Status.TRACKED, age_s=0.0)
