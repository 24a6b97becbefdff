"""Data sets of chosen frames: rendered so, and chosen from whole runs."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml

from peopleboy.scenarios.export.replay import replay
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.scenarios.run_folder.image_files import image_file
from peopleboy.tracker.evaluation.mot_files import read_truth
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import FOLLOWING, SCENE

SMALL = {kind: {"kind": kind, "width_px": 96, "height_px": 72} for kind in ("thermal", "colour")}
SCENES = {
    scene["name"]: scene | {"duration_s": 1.0, "robot": scene["robot"] | {"cameras": SMALL}}
    for scene in (SCENE, FOLLOWING | {"faults": [{"kind": "camera_frozen", "from_s": 0.5}]})
}
CHOICE = ("--frames", "--every", 2, "--frames-per-world", 3)


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A set of one scenario that is scripted, and one that follows a person and has a fault."""
    home = tmp_path_factory.mktemp("chosen")
    for name, scene in SCENES.items():
        (home / f"{name}.yaml").write_text(yaml.safe_dump(scene))
    order = [home / f"{name}.yaml" for name in SCENES]
    assert run_cli("render", *order, *CHOICE, "--seeds", 1, "--workers", 1, "--out", home / "set") == 0
    return home / "set"


def test_only_the_chosen_frames_are_written(rendered: Path) -> None:
    for run in (open_run(rendered / f"{name}-0", may_be_sampled=True) for name in SCENES):
        assert len(run.kept_frames) == 3
        assert all(frame % 2 == 1 for frame in run.kept_frames)
        assert set(read_truth(run.folder / "truth" / "gt.txt").frame) <= set(run.kept_frames)
        for camera in run.robot.cameras:
            files = [path.name for path in sorted((run.folder / camera).iterdir())]
            assert files == [image_file(frame) for frame in run.kept_frames]
    about = json.loads((rendered / "dataset.json").read_text())
    assert about["choice"] == {"every": 2, "frames_per_world": 3}
    assert about["statistics"]["all"]["content"]["frames"] == 6
    assert "--frames --every 2 --frames-per-world 3 --seeds 1" in (rendered / "README.md").read_text()


@pytest.mark.parametrize("name", SCENES)
def test_a_replay_gives_the_same_images(rendered: Path, name: str) -> None:
    run = open_run(rendered / f"{name}-0", may_be_sampled=True)
    for tick, frame in zip(replay(run), run.kept_frames, strict=True):
        assert tick.frame == frame
        for camera in ("thermal", "colour"):
            image = cv2.imread(str(run.folder / camera / image_file(frame)), cv2.IMREAD_UNCHANGED)
            again = tick.observation.images[camera]
            assert np.array_equal(image, again[..., ::-1] if again.ndim == 3 else again)


def test_an_export_contains_the_chosen_frames(rendered: Path, tmp_path: Path) -> None:
    assert run_cli("export", rendered, "--format", "yolo", "--out", tmp_path / "all") == 0
    order = ("--format", "yolo", "--frames-per-world", 1, "--out", tmp_path / "one")
    assert run_cli("export", rendered, *order) == 0
    every, one = (
        {path.stem for path in (tmp_path / folder / "images" / "train").iterdir()}
        for folder in ("all", "one")
    )
    assert (len(every), len(one)) == (6, 2)
    assert one < every
    assert json.loads((tmp_path / "one" / "export.json").read_text())["choice"] == {"frames_per_world": 1}


def test_what_is_not_a_sequence_is_refused_as_one(
    rendered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = rendered / "tiny-0"
    for order in (
        ("evaluate", run),
        ("export", run, "--format", "mot", "--out", tmp_path / "mot"),
        ("export", run, "--format", "yolo", "--most-people", 1, "--least-people", 2),
    ):
        refusal(capsys, *order)
    printed = refusal(capsys, "export", run, "--format", "viper", "--every", 2, "--out", tmp_path / "viper")
    assert_names(printed, "--every 2", "viper", "sequences")
    printed = refusal(capsys, "export", run, "--format", "coco", "--least-people", 9, "--out", tmp_path / "c")
    assert_names(printed, "--least-people 9", "no frame")
    printed = refusal(
        capsys, "render", rendered.parent / "tiny.yaml", "--every", 2, "--out", tmp_path / "set"
    )
    assert_names(printed, "--every 2", "--frames")
    assert list(tmp_path.iterdir()) == []


def test_another_choice_is_not_mixed_into_a_set(rendered: Path, capsys: pytest.CaptureFixture[str]) -> None:
    order = (rendered.parent / "tiny.yaml", "--frames", "--seeds", 1, "--out", rendered)
    assert_names(refusal(capsys, "render", *order), "another choice of frames", "--out")
