"""Data sets for others: split, counted, checked."""

import json
import re
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.scenarios.export.dataset_checks import _check_images
from peopleboy.scenarios.export.datasheet import measure, write_datasheet
from peopleboy.scenarios.export.splits import SPLITS, lacking_splits, split_lines, split_of
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.random_worlds.distribution import Distribution
from peopleboy.tracker.evaluation.mot_files import read_truth
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names

SCENE = """
name: tiny
description: One person walks past.
duration_s: 0.4
place: {kind: room, length_m: 8.0, width_m: 6.0}
people:
  - name: anna
    path: [{at_m: [4.0, -1.0]}, {at_m: [4.0, 1.0]}]
robot:
  at_m: [0.6, 0.0]
  cameras:
    thermal: {kind: thermal, width_px: 160, height_px: 120}
    rear: {kind: thermal, width_px: 160, height_px: 120, mount_m: [-0.3, 0, 1.3], yaw_deg: 180, rate_hz: 5}
"""


@pytest.fixture(scope="module")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    home = tmp_path_factory.mktemp("rendered")
    (home / "tiny.yaml").write_text(SCENE)
    assert (
        run_cli("render", home / "tiny.yaml", "--frames", "--seeds", 2, "--workers", 1, "--out", home / "set")
        == 0
    )
    return home


@given(st.integers(1, 60))
def test_every_seed_is_in_one_split_and_stays_there(seeds: int) -> None:
    names = [f"tiny-{seed}" for seed in range(seeds)]
    lines = {split: split_lines(names, range(seeds), split).split() for split in SPLITS}
    assert sorted(name for own in lines.values() for name in own) == sorted(names)
    assert all(f"tiny-{seed}" in lines[split_of(seed)] for seed in range(seeds))
    said, told, _ = lacking_splits(range(seeds)).partition(" empty; ")
    assert {split for split in SPLITS if split in said} == {split for split in SPLITS if not lines[split]}
    if told:
        enough = int(lacking_splits(range(seeds)).split()[-1])
        assert lacking_splits(range(enough)) == "" != lacking_splits(range(enough - 1))


def test_what_is_lacking_is_said_in_one_line() -> None:
    assert lacking_splits(range(3)) == "val and test are empty; give --seeds 7"
    assert lacking_splits(range(6)) == "test is empty; give --seeds 7"
    assert lacking_splits(range(12, 13)) == "train and test are empty; give --seeds 3"


@pytest.mark.slow
def test_a_set_is_sound_and_its_numbers_are_those_of_its_files(rendered: Path) -> None:
    folder = rendered / "set"
    about = json.loads((folder / "dataset.json").read_text())
    assert about["runs"] == ["tiny-0", "tiny-1"]
    assert [check["failures"] for check in about["checks"]] == [[]] * len(about["checks"])
    whole = about["statistics"]["all"]
    boxes = sum(len(read_truth(folder / run / "truth" / "gt.txt")) for run in about["runs"])
    assert whole["content"]["frames"] == 12
    assert sum(bar["boxes"] for bar in whole["visible"]) == boxes
    assert sum(bar["boxes"] for bar in whole["distance"]) == boxes
    assert sum(whole["hidden_mostly_by"].values()) == boxes
    first = [cv2.imread(str(folder / run / "colour" / "000001.png"))[..., ::-1] for run in about["runs"]]
    assert np.allclose(whole["image_mean"]["colour"], np.mean(first, axis=(0, 1, 2)), atol=0.01)
    assert "FAILED" not in (folder / "README.md").read_text()
    assert "| runs | 2 | 2 |" in (folder / "README.md").read_text()
    assert (
        f"peopleboy render {rendered / 'tiny.yaml'} --frames --seeds 2" in (folder / "README.md").read_text()
    )


def test_its_sheet_tells_each_camera_s_images_and_one_that_sees_nothing_warm_is_sound(rendered: Path) -> None:
    sheet = (rendered / "set" / "README.md").read_text()
    said = "160x120 pixels, 15 a second (thermal), or 320x240 pixels, 15 a second (colour)"
    assert f"Images are {said}, or 160x120 pixels, 5 a second (rear), and have" in sheet
    assert "| `rear16/` | 16-bit, hundredths of a kelvin |" in sheet
    cold = [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in rendered.glob("set/*/rear/*.png")]
    assert len(cold) == 2 * 2
    assert np.quantile(cold, 0.99) == 0


def test_a_split_without_images_has_a_dash_in_the_sheet(rendered: Path, tmp_path: Path) -> None:
    runs = [rendered / "set" / name for name in ("tiny-0", "tiny-1")]
    bare = tmp_path / "tiny-1"
    shutil.copytree(runs[1], bare, ignore=shutil.ignore_patterns("*.png"))
    about = json.loads((rendered / "set" / "dataset.json").read_text())
    about |= {"asked": {}, "choice": None, "size_mb": 1, "lacking": "", "drawn": {}}
    statistics = {"all": measure(runs), "test": measure([bare])}
    sheet = tmp_path / "README.md"
    write_datasheet(sheet, statistics, (), about, [load_scenario(rendered / "tiny.yaml")], Distribution())
    lines = [line for line in sheet.read_text().splitlines() if "images, mean" in line]
    assert lines
    assert all(line.endswith("| - |") for line in lines)


def test_an_image_without_content_is_found(rendered: Path) -> None:
    run = rendered / "set" / "tiny-0"
    kinds = {"rear": np.uint8, "rear_scene": np.uint8, "rear16": np.uint16}
    kept = {name: (run / name / "000001.png").read_bytes() for name in kinds}
    for name, dtype in kinds.items():
        assert _check_images(run) == []
        cv2.imwrite(str(run / name / "000001.png"), np.full((120, 160), 7, dtype))
    assert _check_images(run) == ["rear: 000001.png has no content"]
    for name, content in kept.items():
        (run / name / "000001.png").write_bytes(content)


def test_a_call_that_is_refused_leaves_a_finished_set_as_it_was(rendered: Path) -> None:
    folder = rendered / "set"
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    order = (rendered / "tiny.yaml", "--seeds", 9, "--workers", 1, "--out", folder)
    assert run_cli("render", *order, "--tracker", "thesis") == 2
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def test_a_set_grows_without_rendering_again_and_broken_images_are_found(
    rendered: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = rendered / "set"
    stamp = (folder / "tiny-1" / "run.json").stat().st_mtime_ns
    image = folder / "tiny-1" / "thermal" / "000001.png"
    image.write_bytes(b"")
    (folder / "export-coco").mkdir()
    with (folder / "export-coco" / "images.bin").open("wb") as export:
        export.truncate(500_000_000)
    order = (rendered / "tiny.yaml", "--frames", "--seeds", 3, "--workers", 1, "--out", folder)
    assert run_cli("render", *order) == 1
    told, sheet = capsys.readouterr().out, (folder / "README.md").read_text()
    assert "FAILED: every image exists" in told
    assert f"\n{lacking_splits(range(3))}\n" in told
    assert f"**{lacking_splits(range(3))}.**" in sheet
    assert 0 < int(re.search(r"The runs take (\d+) MB", sheet)[1]) < 100
    assert (folder / "tiny-1" / "run.json").stat().st_mtime_ns == stamp
    assert (folder / "splits" / "train.txt").read_text().split() == ["tiny-0", "tiny-1", "tiny-2"]


def test_a_folder_of_something_else_is_refused_and_left_alone(
    rendered: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "thesis.txt").write_text("do not lose me")
    assert_names(refusal(capsys, "render", rendered / "tiny.yaml", "--out", tmp_path), tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_without_the_physics_that_it_asks_for_nothing_is_left(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    own = "name: own\ndescription: With its physics.\nlike: crossing_2\nphysics: bullet\n"
    Path("own.yaml").write_text(own, encoding="utf-8")
    assert_names(refusal(capsys, "render", "own.yaml", "--seeds", 2), "PyBullet", "3.11", "kinematic")
    assert [path.name for path in tmp_path.iterdir()] == ["own.yaml"]
