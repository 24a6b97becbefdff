from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

from peopleboy.scenarios.export.coco import annotations_file
from peopleboy.scenarios.export.replay import replay
from peopleboy.scenarios.run_folder.finished_run import open_run
from peopleboy.sim.geometry.pinhole import transform
from tests.helpers.calls.command_line import run_cli

# What pycocotools decodes into is older than numpy 2.
pytestmark = pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")

EDGES = ("left_px", "top_px", "width_px", "height_px")


@pytest.fixture
def coco(coco_folder: Path, capsys: pytest.CaptureFixture[str]) -> COCO:
    loaded = COCO(str(coco_folder / annotations_file()))
    capsys.readouterr()
    return loaded


@pytest.fixture(scope="module")
def people(crossing: Path) -> dict[tuple[int, int], dict[str, Any]]:
    rows = pq.read_table(crossing / "truth.parquet").to_pylist()
    return {(row["frame"], row["id"]): row for row in rows}


def box(row: dict[str, Any], prefix: str) -> np.ndarray:
    """A box of the table, with pixels counted from the image's corner."""
    return np.array([row[f"{prefix}{edge}"] for edge in EDGES]) + np.array([0.5, 0.5, 0.0, 0.0])


def row_of(coco: COCO, one: dict[str, Any], people: dict[Any, Any]) -> dict[str, Any]:
    return people[coco.imgs[one["image_id"]]["frame_id"], one["track_id"]]


@pytest.mark.slow
def test_everybody_who_is_visible_has_an_annotation_with_the_boxes_of_the_table(
    coco: COCO, people: dict[Any, Any]
) -> None:
    assert len(coco.anns) == sum(row["visible_px"] > 0 for row in people.values()) > 60
    for one in coco.anns.values():
        row = row_of(coco, one, people)
        for name, prefix in (("bbox", "visible_"), ("whole_bbox", "whole_"), ("body_bbox", "")):
            assert one[name] == pytest.approx(box(row, prefix), abs=0.01)
        for name in ("name", "visible_fraction", "occluded_fraction", "occluder", "distance_m", "is_counted"):
            assert one[name] == row[name]
        assert one["hidden_by"] == dict(row["hidden_by"])


def test_masks_are_the_pixels_at_which_people_are_seen(coco: COCO, crossing: Path) -> None:
    for tick in replay(open_run(crossing)):
        found = np.zeros_like(tick.truth.instance)
        for one in coco.imgToAnns[tick.frame]:
            mask = coco.annToMask(one).astype(bool)
            found[mask] = one["track_id"]
            v, u = np.nonzero(mask)
            around = (u.min(), v.min(), u.max() - u.min() + 1, v.max() - v.min() + 1)
            assert (one["area"], tuple(one["bbox"])) == (mask.sum(), around)
        assert np.array_equal(found, tick.truth.instance)


def test_keypoints_are_the_joints_of_the_table(coco: COCO, people: dict[Any, Any]) -> None:
    seen = {0: 0, 1: 0, 2: 0}
    for one in coco.anns.values():
        row = row_of(coco, one, people)
        points = np.reshape(one["keypoints"], (17, 3))
        joints = np.reshape(row["joints_px"], (17, 2))
        is_inside = np.all((joints > -0.5) & (joints < (159.5, 119.5)), axis=1)
        assert points[is_inside, :2] == pytest.approx(joints[is_inside] + 0.5, abs=0.01)
        expected = np.where(is_inside, np.where(row["joint_is_visible"], 2, 1), 0)
        assert np.array_equal(points[:, 2], expected)
        assert not points[~is_inside].any()
        assert one["num_keypoints"] == is_inside.sum()
        for flag in seen:
            seen[flag] += int((expected == flag).sum())
    assert all(seen.values())


def test_labels_of_the_colour_image_are_those_of_its_own_table(
    coco_folder: Path, crossing: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    colour = COCO(str(coco_folder / annotations_file(camera="colour")))
    capsys.readouterr()
    rows = pq.read_table(crossing / "truth" / "colour.parquet").to_pylist()
    people = {(row["frame"], row["id"]): row for row in rows}
    assert len(colour.anns) == sum(row["visible_px"] > 0 for row in rows) > 60
    for one in colour.anns.values():
        row = row_of(colour, one, people)
        for name, prefix in (("bbox", "visible_"), ("whole_bbox", "whole_"), ("body_bbox", "")):
            assert one[name] == pytest.approx(box(row, prefix), abs=0.01)
        points = np.reshape(one["keypoints"], (17, 3))
        is_told = points[:, 2] > 0
        joints = np.reshape(row["joints_px"], (17, 2))
        assert points[is_told, :2] == pytest.approx(joints[is_told] + 0.5, abs=0.01)
        assert colour.annToMask(one).sum() == row["visible_px"]


def test_every_image_is_under_a_licence_that_is_told(coco: COCO) -> None:
    (licence,) = coco.dataset["licenses"]
    assert {image["license"] for image in coco.imgs.values()} == {licence["id"]}
    assert licence["url"].startswith("https://")


def test_the_cameras_project_the_joints_in_space_onto_the_keypoints(coco: COCO) -> None:
    camera = coco.dataset["videos"][0]["cameras"]["thermal"]
    for one in coco.anns.values():
        camera_from_world = np.linalg.inv(coco.imgs[one["image_id"]]["world_from_camera"])
        seen = transform(camera_from_world, np.array(one["joints_m"])) @ np.array(camera["intrinsics"]).T
        points = np.reshape(one["keypoints"], (17, 3))
        is_inside = points[:, 2] > 0
        assert points[is_inside, :2] == pytest.approx((seen[:, :2] / seen[:, 2:])[is_inside], abs=0.02)


def test_who_is_wholly_hidden_is_told_with_the_image(coco: COCO, people: dict[Any, Any]) -> None:
    hidden = 0
    for image in coco.imgs.values():
        for one in image["hidden_people"]:
            row = people[image["frame_id"], one["track_id"]]
            assert (row["visible_px"], one["occluder"]) == (0, row["occluder"])
            assert one["whole_bbox"] == pytest.approx(box(row, "whole_"), abs=0.01)
            hidden += 1
    assert hidden > 0


@pytest.mark.parametrize("kind", ["bbox", "segm", "keypoints"])
def test_pycocotools_gives_the_truth_full_marks(
    kind: str, coco: COCO, coco_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    truth = json.loads((coco_folder / annotations_file()).read_text())["annotations"]
    found = [one | {"score": 1.0} for one in truth if kind != "keypoints" or one["num_keypoints"] > 0]
    evaluation = COCOeval(coco, coco.loadRes(found), kind)
    evaluation.evaluate()
    evaluation.accumulate()
    evaluation.summarize()
    capsys.readouterr()
    assert evaluation.stats[0] == pytest.approx(1.0)


def test_the_images_are_those_of_the_run(coco: COCO, coco_folder: Path, crossing: Path) -> None:
    assert len(coco.imgs) == 60
    for number in (1, 30, 60):
        image = coco.imgs[number]
        for kind, key in (
            ("thermal", "file_name"),
            ("thermal16", "thermal16_file_name"),
            ("colour", "colour_file_name"),
        ):
            ours = cv2.imread(str(coco_folder / "images" / image[key]), cv2.IMREAD_UNCHANGED)
            theirs = cv2.imread(str(crossing / kind / f"{number:06d}.png"), cv2.IMREAD_UNCHANGED)
            assert np.array_equal(ours, theirs)
        size = (image["height"], image["width"])
        assert (
            size == cv2.imread(str(coco_folder / "images" / image["file_name"]), cv2.IMREAD_UNCHANGED).shape
        )


def test_kept_images_and_masks_give_what_a_replay_gives(
    crossing: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    without = tmp_path / crossing.name
    shutil.copytree(crossing, without, ignore=shutil.ignore_patterns("instance"))
    assert run_cli("export", without, "--format", "coco", "--out", tmp_path / "coco", "--every", 9) == 0
    # What renders again is taken away.
    monkeypatch.setattr("peopleboy.scenarios.export.export_runs.counted", lambda _report: None)
    assert run_cli("export", crossing, "--format", "coco", "--out", tmp_path / "kept", "--every", 9) == 0
    played, kept = (
        {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
        for folder in (tmp_path / "coco", tmp_path / "kept")
    )
    assert played == kept
    assert len(list((tmp_path / "kept" / "images").glob("*/thermal/*.png"))) == 7


def test_annotations_have_the_attributes_of_the_person(coco: COCO, crossing: Path) -> None:
    people = {person["name"]: person for person in open_run(crossing).played["people"]}
    for one in coco.anns.values():
        found, person = one["attributes"], people[one["name"]]
        assert (found["sex"], found["age"], found["build"]) == (person["sex"], "adult", person["build"])
        assert {name: found[name] for name in person["clothes"]} == person["clothes"]
        assert one["posture"]
