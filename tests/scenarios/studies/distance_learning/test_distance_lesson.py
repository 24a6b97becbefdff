import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml

from peopleboy.scenarios.loop.calibrations import calibration_of
from peopleboy.sim.cameras.camera_config import PanoramaConfig
from peopleboy.tracker.panoramic.paper import appearance_file
from peopleboy.tracker.panoramic.paper.appearance_file import SHIPPED, AppearanceModel
from peopleboy.tracker.panoramic.paper.panorama_view import check_view
from peopleboy.tracker.panoramic.paper.paper_tracker import PanoramicPaperTracker
from peopleboy.tracker.trackers import make_tracker
from tests.helpers.calls.command_line import refusal, run_cli

WALK = {
    "name": "stroll",
    "description": "One person comes and goes before a panoramic camera.",
    "duration_s": 9.0,
    "place": {"kind": "room", "length_m": 5.0, "width_m": 6.0},
    "people": [
        {
            "name": "anna",
            "enter_s": 0.4,
            "path": [
                {"at_m": [2.0, -2.0]},
                {"at_m": [4.0, 0.0]},
                {"at_m": [2.2, 1.8]},
                {"at_m": [2.0, -1.0]},
            ],
        }
    ],
    "robot": {"at_m": [0.5, 0.0]},
}


def write(folder: Path, **changes: object) -> Path:
    path = folder / "stroll.yaml"
    path.write_text(yaml.safe_dump(WALK | changes), encoding="utf-8")
    return path


def train(scenario: Path, out: Path) -> int:
    return run_cli(
        "train-distance", scenario, "--seeds", 1, "--epochs", 500, "--no-trials", "--workers", 1, "--out", out
    )


@pytest.fixture(scope="module")
def lesson(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lesson")
    assert train(write(folder), folder / "out") == 0
    return folder / "out"


def test_it_leaves_a_network_that_knows_its_camera_and_what_it_was_trained_on(lesson: Path) -> None:
    model = AppearanceModel.load(lesson / "panoramic-paper.json")
    assert (model.view.width_px, model.view.height_px) == (480, 120)
    top, middle, bottom = model.view.depression_deg
    assert 7.5 < top < middle < bottom < 55.5
    assert "stroll, seeds 0 to 0" in model.about["trained on"]
    assert model.about["left out"].startswith("0 images")


def test_a_second_lesson_takes_the_examples_that_are_there_and_gives_the_same_file(lesson: Path) -> None:
    before = {path.name: path.read_bytes() for path in lesson.iterdir()}
    assert train(lesson.parent / "stroll.yaml", lesson) == 0
    assert {path.name: path.read_bytes() for path in lesson.iterdir()} == before


def test_a_run_is_tracked_with_the_network_near_the_truth(
    lesson: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(appearance_file, "SHIPPED", lesson / "panoramic-paper.json")
    out = tmp_path / "run"
    assert run_cli("run", write(tmp_path), "--tracker", "panoramic-paper", "--out", out, "--no-rrd") == 0
    tracks = pq.read_table(out / "tracks.parquet").to_pylist()
    assert {row["id"] for row in tracks} == {1}
    seen = [row["frame"] for row in tracks]
    assert seen == list(range(seen[0], 136))  # once seen, never lost
    assert seen[0] == 7  # the first frame at 0.4 s
    assert json.loads((out / "metrics.json").read_text(encoding="utf-8"))["floor"]["mean error"] < 0.15


def test_the_network_that_comes_with_the_tracker_is_of_the_usual_camera() -> None:
    camera = PanoramaConfig().camera
    calibration = calibration_of(camera)
    check_view(AppearanceModel.load(SHIPPED).view, (camera.height, camera.width), calibration)
    assert isinstance(make_tracker("panoramic-paper", np.random.default_rng(0)), PanoramicPaperTracker)


def test_another_mirror_is_refused_in_a_line(
    lesson: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(appearance_file, "SHIPPED", lesson / "panoramic-paper.json")
    narrow = {"panorama": {"kind": "panorama", "mirror": "narrow"}}
    scene = write(tmp_path, robot={"at_m": [0.5, 0.0], "cameras": narrow})
    told = refusal(capsys, "run", scene, "--tracker", "panoramic-paper", "--out", tmp_path / "run")
    assert "peopleboy train-distance" in told


def test_a_scenario_that_does_not_begin_empty_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    people = [{"name": "anna", "path": [{"at_m": [2.0, 1.0]}]}]
    told = refusal(
        capsys, "train-distance", write(tmp_path, people=people), "--out", tmp_path / "out", "--seeds", 1
    )
    assert "must be empty" in told
