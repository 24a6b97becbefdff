"""Exports of rendered sets keep what is for training apart from what is for tests."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
import yaml
from pycocotools.coco import COCO
from trackers.eval import evaluate_mot_sequences
from trackeval.datasets import MotChallenge2DBox

from peopleboy.scenarios.export.splits import SPLITS
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names
from tests.helpers.runs.exported import SCENE, export

FRAMES = 3
SMALL = {kind: {"kind": kind, "width_px": 96, "height_px": 72} for kind in ("thermal", "colour")}
SHORT = SCENE | {
    "name": "short",
    "duration_s": FRAMES / 15,
    "robot": SCENE["robot"] | {"cameras": SMALL},
}
SEEDS = {"train": range(5), "val": [5], "test": [6]}
NAMES = {split: [f"short-{seed}" for seed in seeds] for split, seeds in SEEDS.items()}


@pytest.fixture(scope="module")
def people(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rendered set that has all splits."""
    home = tmp_path_factory.mktemp("split")
    (home / "short.yaml").write_text(yaml.safe_dump(SHORT))
    order = (home / "short.yaml", "--seeds", 7, "--workers", 1, "--out", home / "people")
    assert run_cli("render", *order) == 0
    return home / "people"


@pytest.mark.thorough
def test_coco_has_annotations_and_images_of_each_split_apart(
    people: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = export(people, "coco", tmp_path / "coco")
    for folder in (out / "annotations", out / "annotations" / "colour"):
        told = {path.name for path in folder.iterdir() if path.is_file()}
        assert told == {f"person_keypoints_{split}.json" for split in SPLITS}
    for split in SPLITS:
        coco = COCO(str(out / "annotations" / f"person_keypoints_{split}.json"))
        capsys.readouterr()
        files = {image["file_name"] for image in coco.loadImgs(coco.getImgIds())}
        assert {file.split("/")[0] for file in files} == set(NAMES[split])
        assert [video["name"] for video in coco.dataset["videos"]] == NAMES[split]
        assert len(coco.imgs) == FRAMES * len(NAMES[split])
        home = out / "images" / split
        assert files == {path.relative_to(home).as_posix() for path in home.glob("*/thermal/*.png")}
        assert len(coco.getAnnIds()) >= len(coco.imgs)


@pytest.mark.slow
@pytest.mark.parametrize("split", SPLITS)
def test_trackeval_and_trackers_find_each_split_by_its_name(
    split: str, mot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    truth, results = mot / "gt" / "mot_challenge", mot / "trackers" / "mot_challenge"
    settings = {"BENCHMARK": "peopleboy", "SPLIT_TO_EVAL": split, "PRINT_CONFIG": False}
    folders = {"GT_FOLDER": str(truth), "TRACKERS_FOLDER": str(results)}
    data = MotChallenge2DBox(settings | folders)
    capsys.readouterr()
    assert (data.seq_list, data.tracker_list) == (NAMES[split], ["truth"])
    assert data.seq_lengths == dict.fromkeys(NAMES[split], FRAMES)
    name = f"peopleboy-{split}"
    found = evaluate_mot_sequences(
        truth / name, results / name / "truth" / "data", seqmap=truth / "seqmaps" / f"{name}.txt"
    )
    assert sorted(found.sequences) == NAMES[split]
    assert found.aggregate.CLEAR.CLR_FN == 0


@pytest.fixture(scope="module")
def mot(people: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return export(people, "mot", tmp_path_factory.mktemp("split_mot") / "mot")


@pytest.mark.slow
def test_yolo_names_the_folders_of_each_split(people: Path, tmp_path: Path) -> None:
    out = export(people, "yolo", tmp_path / "yolo")
    settings = yaml.safe_load((out / "data.yaml").read_text())
    assert {split: settings[split] for split in SPLITS} == {split: f"images/{split}" for split in SPLITS}
    for split in SPLITS:
        stems = {f"{run}_{number:06d}" for run in NAMES[split] for number in range(1, FRAMES + 1)}
        for kind in ("images", "labels"):
            assert {path.stem for path in (out / kind / split).iterdir()} == stems


def test_other_formats_keep_runs_apart_and_say_which_split_they_are_of(people: Path, tmp_path: Path) -> None:
    out = export(people, "viper", tmp_path / "viper")
    assert json.loads((out / "export.json").read_text())["splits"] == NAMES
    assert {path.parent.name for path in out.glob("*/truth.xgtf")} == {
        run for own in NAMES.values() for run in own
    }


def test_runs_named_one_by_one_keep_their_split(people: Path, tmp_path: Path) -> None:
    assert (
        run_cli(
            "export", people / "short-0", people / "short-6", "--format", "coco", "--out", tmp_path / "two"
        )
        == 0
    )
    assert {path.name for path in (tmp_path / "two" / "images").iterdir()} == {"train", "test"}


def test_a_split_of_one_s_own_is_followed(people: Path, tmp_path: Path) -> None:
    for run in ("short-0", "short-1"):
        shutil.copytree(people / run, tmp_path / "own" / run)
    (tmp_path / "own" / "splits").mkdir()
    for split, run in (("train", "short-1"), ("val", ""), ("test", "short-0")):
        (tmp_path / "own" / "splits" / f"{split}.txt").write_text(f"{run}\n")
    (tmp_path / "own" / "dataset.json").write_text("{}")
    out = export(tmp_path / "own", "viper", tmp_path / "viper")
    assert json.loads((out / "export.json").read_text())["splits"] == {
        "train": ["short-1"],
        "test": ["short-0"],
    }


def test_a_run_without_split_is_not_mixed_with_those_of_a_set(
    people: Path, crossing: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    order = ("--format", "viper", "--out", tmp_path / "viper")
    assert_names(refusal(capsys, "export", people, crossing, *order), crossing)
    shutil.copytree(people, tmp_path / "people")
    shutil.copytree(people / "short-0", tmp_path / "people" / "short-9")
    assert_names(refusal(capsys, "export", tmp_path / "people", *order), "short-9", "none")
    (tmp_path / "people" / "splits" / "val.txt").write_text("short-0\n")
    told = refusal(capsys, "export", tmp_path / "people" / "short-0", *order)
    assert_names(told, "short-0", "train", "val")
    assert [path.name for path in tmp_path.iterdir()] == ["people"]


def test_a_set_that_was_cut_off_is_refused_but_its_runs_are_not(
    people: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(people, tmp_path / "people")
    (tmp_path / "people" / "dataset.json").unlink()
    order = ("--format", "viper", "--out", tmp_path / "viper")
    told = refusal(capsys, "export", tmp_path / "people", *order)
    assert_names(told, tmp_path / "people", "peopleboy render")
    assert run_cli("export", tmp_path / "people" / "short-5", *order) == 0
    assert json.loads((tmp_path / "viper" / "export.json").read_text())["splits"] == {"val": ["short-5"]}
