"""Tests of `--gallery`: the same people in another walk keep their ids, and what is refused."""

import json
from collections import Counter
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from benchmarks.gallery import score
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from tests.helpers.calls.command_line import refusal

SCENE = """
name: returning
description: Two people cross a room, one after the other.
duration_s: 8.0
place: {kind: room, length_m: 8.0, width_m: 8.0}
people:
  - name: anna
    sex: female
    build: average
    height_m: 1.68
    clothes:
      {top: shirt, bottom: trousers, shoes: trainers, hair: long, top_colour: red, bottom_colour: black}
    jitter_m: 0.2
    speed_jitter: 0.1
    path:
      - {at_m: [4.5, -2.0]}
      - {at_m: [4.5, 2.0], speed_m_s: 1.0}
  - name: bernd
    sex: male
    build: average
    height_m: 1.84
    clothes: {top: jacket, bottom: jeans, shoes: boots, hair: short, top_colour: navy, bottom_colour: white}
    jitter_m: 0.2
    speed_jitter: 0.1
    enter_s: 3.0
    path:
      - {at_m: [5.5, 3.0]}
      - {at_m: [5.5, -2.5], speed_m_s: 1.0}
robot: {at_m: [0.6, 0.0]}
"""


def scene(path: Path) -> Path:
    path.write_text(SCENE, encoding="utf-8")
    return path


def ids_by_name(folder: Path) -> dict[str, int]:
    """Return the most frequent id of the tracks at each person."""
    at: dict[int, list[tuple[float, str]]] = {}
    for one in pq.read_table(folder / "truth.parquet").to_pylist():
        if one["left_px"] is not None:
            at.setdefault(one["frame"], []).append((one["left_px"] + one["width_px"] / 2.0, one["name"]))
    found: dict[str, Counter[int]] = {}
    for one in pq.read_table(folder / "tracks.parquet").to_pylist():
        middle_px = one["left_px"] + one["width_px"] / 2.0
        name = min((abs(x_px - middle_px), name) for x_px, name in at[one["frame"]])[1]
        found.setdefault(name, Counter())[one["id"]] += 1
    return {name: ids.most_common(1)[0][0] for name, ids in found.items()}


def test_an_id_of_two_people_is_right_for_the_one_who_had_it_longer() -> None:
    first = {"anna": Counter({1: 9}), "bernd": Counter({1: 2, 2: 8})}
    second = {"anna": Counter({1: 6, 2: 4}), "bernd": Counter({2: 6, 7: 4})}
    result = score([first, second])
    assert (result["later visits"], result["right"], result["boxes"]) == (2, 2, 20)
    assert [result[name] for name in ("right id", "wrong person", "new id")] == [60.0, 20.0, 20.0]


def test_people_of_an_earlier_run_keep_their_ids(tmp_path: Path) -> None:
    scenario, gallery = load_scenario(scene(tmp_path / "returning.yaml")), tmp_path / "gallery.json"
    for seed in (1, 2):
        out = tmp_path / str(seed)
        run(scenario, RunOptions(seed=seed, out=out, record=False, gallery=gallery))
        assert ids_by_name(out) == {"anna": 1, "bernd": 2}
    assert json.loads(gallery.read_text(encoding="utf-8"))["people"][0]["id"] == 1
    assert not list(tmp_path.glob("*.part"))
    without = tmp_path / "without"
    run(scenario, RunOptions(seed=1, out=without, record=False))
    assert (without / "tracks.txt").read_bytes() == (tmp_path / "1" / "tracks.txt").read_bytes()


@pytest.mark.parametrize(
    ("tracker", "name", "fault"),
    [
        ("contour", "gallery.json", "tracker 'contour' has no gallery of people"),
        ("laser", "gallery.json", "tracker 'laser' has no colours"),
        ("truth", "gallery.json", "tracker 'truth' has no gallery of people"),
        ("detection", "missing/gallery.json", "there is no folder"),
        ("detection", "run/gallery.json", "lies in the output folder"),
        ("detection", "returning.yaml", "is not a gallery of people"),
    ],
)
def test_it_is_refused_before_anything_is_written(
    tmp_path: Path, tracker: str, name: str, fault: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = scene(tmp_path / "returning.yaml"), tmp_path / "run"
    before = path.read_bytes()
    command = ["run", str(path), "--tracker", tracker, "--out", str(out), "--gallery", str(tmp_path / name)]
    assert fault in refusal(capsys, *command)
    assert not out.exists()
    assert path.read_bytes() == before


def test_suites_have_no_gallery(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "is for single runs" in refusal(
        capsys, "run", "dataset1", "--gallery", str(tmp_path / "gallery.json")
    )
