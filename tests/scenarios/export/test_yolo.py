"""YOLO folders, read by a loader of others', and held against the tables of the run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml
from supervision import DetectionDataset

from peopleboy.scenarios.export.yolo import EVERYTHING, LEAST_PX
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import SCENE, make_run

EDGES = tuple(f"visible_{edge}_px" for edge in ("left", "top", "width", "height"))
SIZES = {"thermal": (160, 120), "colour": (320, 240)}


def export(run: Path, form: str, camera: str, out: Path) -> Path:
    assert run_cli("export", run, "--format", form, "--camera", camera, "--out", out) == 0
    return out


def rows_of(run: Path, camera: str, least_px: float = LEAST_PX) -> dict[int, list[dict[str, Any]]]:
    """People of whom something is visible in a camera's image, this wide and high or more, by frame."""
    table = "truth.parquet" if camera == "thermal" else f"truth/{camera}.parquet"
    found: dict[int, list[dict[str, Any]]] = {}
    for row in pq.read_table(run / table).to_pylist():
        if row["visible_px"] and min(row["visible_width_px"], row["visible_height_px"]) >= least_px:
            found.setdefault(row["frame"], []).append(row)
    return found


@pytest.fixture(scope="module")
def poses(crossing: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(crossing, "yolo-pose", "colour", tmp_path_factory.mktemp("yolo") / "poses")


@pytest.mark.parametrize(("form", "camera"), [("yolo", "thermal"), ("yolo-pose", "colour")])
def test_a_loader_of_others_finds_the_boxes_of_the_table(
    form: str, camera: str, crossing: Path, poses: Path, tmp_path: Path
) -> None:
    folder = poses if form == "yolo-pose" else export(crossing, form, camera, tmp_path / form)
    settings = yaml.safe_load((folder / "data.yaml").read_text())
    images = folder / settings["val"]
    loaded = DetectionDataset.from_yolo(
        str(images), str(folder / "labels" / images.name), str(folder / "data.yaml")
    )
    assert (loaded.classes, len(loaded)) == (["person"], 60)
    truth = rows_of(crossing, camera)
    compared = 0
    for path, image, found in loaded:
        frame = int(Path(path).stem.rpartition("_")[2])
        width, height = SIZES[camera]
        assert image.shape == (height, width, 3)
        edges = EDGES if form == "yolo" else tuple(edge.replace("visible", "whole") for edge in EDGES)
        wanted = np.array([[row[edge] for edge in edges] for row in truth.get(frame, [])]).reshape(-1, 4)
        corner = wanted[:, :2] + 0.5
        inside = np.hstack([corner, corner + wanted[:, 2:]]).clip(0, (width, height) * 2)
        assert found.xyxy == pytest.approx(inside, abs=0.01)
        compared += len(wanted)
    assert compared > 60


def test_keypoints_are_the_joints_of_the_table(crossing: Path, poses: Path) -> None:
    settings = yaml.safe_load((poses / "data.yaml").read_text())
    assert settings["kpt_shape"] == [17, 3]
    flags = set()
    for frame, rows in rows_of(crossing, "colour").items():
        lines = (poses / "labels" / EVERYTHING / f"{crossing.name}_{frame:06d}.txt").read_text().splitlines()
        for line, row in zip(lines, rows, strict=True):
            values = np.array(line.split(), np.float64)
            assert len(values) == 5 + 17 * 3
            assert np.all((values >= 0.0) & ((values <= 1.0) | (np.arange(56) % 3 == 1)))
            points = values[5:].reshape(17, 3)
            joints = np.reshape(row["joints_px"], (17, 2))
            is_inside = np.all((joints > -0.5) & (joints < (319.5, 239.5)), axis=1)
            assert points[is_inside, :2] * SIZES["colour"] == pytest.approx(joints[is_inside] + 0.5, abs=0.01)
            wanted = np.where(is_inside, np.where(row["joint_is_visible"], 2, 1), 0)
            assert np.array_equal(points[:, 2], wanted)
            flags |= set(wanted.tolist())
    assert flags == {0, 1, 2}


def test_hidden_keypoints_lie_in_whole_boxes_and_visible_boxes_can_be_asked_for(
    crossing: Path, poses: Path, tmp_path: Path
) -> None:
    out = tmp_path / "visible"
    command = ("export", crossing, "--format", "yolo-pose", "--camera", "colour", "--boxes", "visible")
    assert run_cli(*command, "--out", out) == 0
    outside = {}
    for folder in (poses, out):
        points, beyond = 0, 0
        for path in (folder / "labels" / EVERYTHING).iterdir():
            for line in path.read_text().splitlines():
                values = np.array(line.split(), np.float64)
                joints = values[5:].reshape(17, 3)
                hidden = joints[joints[:, 2] == 1][:, :2]
                points += len(hidden)
                beyond += int((np.abs(hidden - values[1:3]) > values[3:5] / 2 + 0.01).any(axis=1).sum())
        outside[folder] = beyond / points
    assert outside[poses] < 0.02 < outside[out]
    assert (out / "data.yaml").read_text().startswith("# boxes enclose the visible part")


def test_a_mirror_swaps_left_and_right_and_nothing_else(poses: Path) -> None:
    flipped = yaml.safe_load((poses / "data.yaml").read_text())["flip_idx"]
    assert flipped == [0, 2, 1, 4, 3, 6, 5, 8, 7, 10, 9, 12, 11, 14, 13, 16, 15]


def test_images_are_those_of_the_run_and_each_has_its_labels(crossing: Path, poses: Path) -> None:
    images = sorted((poses / "images" / EVERYTHING).iterdir())
    assert {path.stem for path in images} == {path.stem for path in (poses / "labels" / EVERYTHING).iterdir()}
    for number in (1, 33):
        stored = cv2.imread(str(crossing / "colour" / f"{number:06d}.png"))
        assert np.array_equal(cv2.imread(str(images[number - 1])), stored)


@pytest.mark.parametrize(
    ("least_px", "asked"), [(3.0, ()), (0.0, ("--least-px", 0)), (30, ("--least-px", 30))]
)
def test_slivers_are_left_out_and_no_more_than_is_asked_for(
    least_px: float, asked: tuple[object, ...], crossing: Path, tmp_path: Path
) -> None:
    out = tmp_path / "boxes"
    assert run_cli("export", crossing, "--format", "yolo", *asked, "--out", out) == 0
    written = sum(path.read_text().count("\n") for path in (out / "labels" / EVERYTHING).iterdir())
    assert written == sum(map(len, rows_of(crossing, "thermal", least_px).values()))
    everybody = sum(map(len, rows_of(crossing, "thermal", 0.0).values()))
    assert (written < everybody) is (least_px > 0)
    said = json.loads((out / "export.json").read_text())
    assert said.get("least_px") == (least_px if asked else None)


def test_only_boxes_for_training_leave_out_slivers(
    crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    told = refusal(
        capsys, "export", crossing, "--format", "coco", "--least-px", 3, "--out", tmp_path / "coco"
    )
    assert_names(told, "--least-px 3", "coco")


def test_a_camera_of_16_bits_or_none_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cameras = {**SCENE["robot"]["cameras"], "depth": {"kind": "depth"}}
    scene = SCENE | {"duration_s": 0.2, "robot": SCENE["robot"] | {"cameras": cameras}}
    run = make_run(scene, tmp_path / "deep")
    for camera, words in (("depth", ("'depth'", "16-bit")), ("front", ("'front'", "thermal"))):
        told = refusal(capsys, "export", run, "--format", "yolo", "--camera", camera)
        assert_names(told, *words)
    assert not (tmp_path / "deep-yolo-depth").exists()
