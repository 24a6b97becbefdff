import json
from pathlib import Path

import pyarrow.parquet as pq
import pytest
import yaml

from peopleboy.sim.geometry.panorama import MIRRORS, Panorama
from peopleboy.studies.training.distance import DistanceTraining
from peopleboy.tracker.reproductions.panoramic import distance_network
from peopleboy.tracker.reproductions.panoramic.distance_network import DistanceModel, shipped_models
from peopleboy.tracker.reproductions.panoramic.paper_tracker import PanoramicPaperTracker
from peopleboy.tracker.sensors.panorama.panorama_view import choose_view
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
        "train",
        "distance",
        scenario,
        "--seeds",
        1,
        "--epochs",
        500,
        "--workers",
        1,
        "--out",
        out,
    )


@pytest.fixture(scope="module")
def lesson(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("lesson")
    assert train(write(folder), folder / "out") == 0
    return folder / "out"


@pytest.mark.slow
def test_it_leaves_a_network_that_knows_its_camera_and_what_it_was_trained_on(lesson: Path) -> None:
    model = DistanceModel.load(lesson / "distance-stroll.npz")
    assert (model.view.width_px, model.view.height_px) == (480, 120)
    top, middle, bottom = model.view.depression_deg
    assert 7.5 < top < middle < bottom < 55.5
    assert "stroll, seeds 0 to 0" in model.about["trained on"]
    assert model.about["excluded"].startswith("0 images")


def test_a_second_lesson_takes_the_examples_that_are_there_and_gives_the_same_file(lesson: Path) -> None:
    def files() -> dict[Path, bytes]:
        return {path: path.read_bytes() for path in lesson.rglob("*") if path.is_file()}

    before = files()
    assert len(before) == 2
    assert train(lesson.parent / "stroll.yaml", lesson) == 0
    assert files() == before


@pytest.mark.heavy
def test_a_run_is_tracked_with_the_network_near_the_truth(
    lesson: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shipped = {lesson / "distance-stroll.npz": DistanceModel.load(lesson / "distance-stroll.npz")}
    monkeypatch.setattr(distance_network, "shipped_models", lambda: shipped)
    out = tmp_path / "run"
    assert (
        run_cli("run", write(tmp_path), "--tracker", "panoramic-paper", "--out", out, "--no-recording") == 0
    )
    tracks = pq.read_table(out / "tracks.parquet").to_pylist()
    assert {row["id"] for row in tracks} == {1}
    seen = [row["frame"] for row in tracks]
    assert seen == list(range(seen[0], 136))  # once seen, never lost
    assert seen[0] == 7  # the first frame at 0.4 s
    assert json.loads((out / "metrics.json").read_text(encoding="utf-8"))["floor"]["mean_error_m"] < 0.15


@pytest.mark.parametrize("mirror", MIRRORS)
def test_a_network_for_every_mirror_that_has_a_name_comes_with_the_tracker(mirror: str) -> None:
    camera = Panorama(mirror=MIRRORS[mirror])
    calibration = camera.calibration
    assert calibration is not None
    views = [model.view for model in shipped_models().values()]
    assert (
        views[choose_view(views, (camera.height, camera.width), calibration)].mirror
        in {
            "default": "at 1.71 m that looks 8.1 to 54.7 deg down",
            "narrow": "at 1.71 m that looks 8.1 to 34.9 deg down",
        }.values()
    )
    tracker = make_tracker("panoramic-paper")
    assert isinstance(tracker, PanoramicPaperTracker)
    tracker.check_cameras({"panorama": calibration})


def test_a_shipped_network_replaces_the_one_for_its_mirror_only() -> None:
    models = shipped_models()
    for path, model in models.items():
        replaced = [other for other in models if DistanceTraining().is_replaced(other, model)]
        assert replaced == [path]


def own_mirror(folder: Path, **values: float) -> Path:
    camera = {"kind": "panorama", "mirror": values}
    return write(folder, robot={"at_m": [0.5, 0.0], "cameras": {"panorama": camera}})


OTHER = {"half_apex_deg": 65.0, "lens_half_angle_deg": 30.0}
FLAT = {"half_apex_deg": 46.0, "lens_half_angle_deg": 30.0}


@pytest.mark.thorough
def test_another_mirror_is_refused_in_a_line_before_anything_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = own_mirror(tmp_path, **OTHER)
    told = refusal(capsys, "run", scene, "--tracker", "panoramic-paper", "--out", tmp_path / "run")
    assert "peopleboy train distance" in told
    told = refusal(
        capsys, "sweep", scene, "--tracker", "panoramic-paper", "--out", tmp_path / "sweep", lines=1
    )
    assert "peopleboy train distance" in told
    assert not list(tmp_path.glob("run*"))
    assert not list(tmp_path.glob("sweep/*"))


def test_a_camera_that_is_not_panoramic_is_refused_before_anything_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    flat = {"panorama": {"kind": "colour"}}
    scene = write(tmp_path, robot={"at_m": [0.5, 0.0], "cameras": flat})
    told = refusal(capsys, "run", scene, "--tracker", "panoramic-paper", "--out", tmp_path / "run")
    assert "needs a panoramic camera" in told
    assert not (tmp_path / "run").exists()


REFUSED = {
    "not empty": (
        lambda folder: write(folder, people=[{"name": "anna", "path": [{"at_m": [2, 1]}]}]),
        "must be empty",
    ),
    "nobody": (lambda folder: write(folder, people=[]), "no person walks"),
    "no floor": (lambda folder: own_mirror(folder, **FLAT), "sees no floor"),
}


@pytest.mark.parametrize("why", REFUSED)
def test_a_scenario_from_which_nothing_can_be_learned_is_refused_and_leaves_nothing(
    why: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    make, words = REFUSED[why]
    told = refusal(capsys, "train", "distance", make(tmp_path), "--out", tmp_path / "out", "--seeds", 1)
    assert words in told
    assert not (tmp_path / "out").exists()


def test_it_reports_its_errors_and_the_command_that_compares_them(
    lesson: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert train(lesson.parent / "stroll.yaml", lesson) == 0
    told = capsys.readouterr()
    command, path = told.out.splitlines()
    assert "by blocks" in " ".join(told.err.split())
    assert "peopleboy reproduce --paper panoramic" in command
    assert Path(path) == lesson / "distance-stroll.npz"
