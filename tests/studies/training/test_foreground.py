from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.studies.training.foreground import MaskScores, score_masks
from peopleboy.studies.training.panorama_sequences import PanoramaSequence, render_panoramas
from peopleboy.studies.training.random_scenes import random_scene
from peopleboy.tracker.sensors.panorama.people_foreground import ForegroundModel
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import refused


def train(out: Path) -> int:
    size = ("--seeds", 1, "--validation", 1, "--rounds", 1, "--workers", 1)
    return run_cli("train", "foreground", *size, "--out", out)


@pytest.fixture(scope="module")
def lesson(tmp_path_factory):
    out = tmp_path_factory.mktemp("lesson") / "out"
    assert train(out) == 0
    return out


@pytest.mark.thorough
def test_it_leaves_a_network_that_knows_its_camera_and_the_scenes_that_it_saw(lesson):
    model = ForegroundModel.load(lesson / "foreground.npz")
    assert (model.view.width_px, model.view.height_px) == (480, 120)
    assert "seeds from 100" in model.about["trained on"]
    assert any("people found" in words for words in model.about.values())
    assert sorted(path.name for path in (lesson / "sequences-mirror").iterdir()) == [
        "scene_0.npz", "scene_0.yaml", "scene_100.npz", "scene_100.yaml",
    ]  # fmt: skip
    assert load_scenario(lesson / "sequences-mirror" / "scene_100.yaml").spec == load_scenario_of(100)


def load_scenario_of(seed):
    return parse_scenario(random_scene(seed), source="drawn", folder=Path()).spec


@pytest.mark.thorough
def test_another_lesson_uses_the_films_that_are_there_and_writes_the_same_bytes(lesson):
    first = (lesson / "foreground.npz").read_bytes()
    filmed = (lesson / "sequences-mirror" / "scene_100.npz").stat().st_mtime_ns
    assert train(lesson) == 0
    assert (lesson / "foreground.npz").read_bytes() == first
    assert (lesson / "sequences-mirror" / "scene_100.npz").stat().st_mtime_ns == filmed


def test_a_perfect_answer_is_judged_perfect_and_none_as_none(lesson):
    film = PanoramaSequence.load(lesson / "sequences-mirror" / "scene_100.npz")
    perfect, nothing = MaskScores(), MaskScores()
    score_masks(film, [(who > 0).astype(np.float32) for who in film.person], perfect)
    score_masks(film, [np.zeros(who.shape, np.float32) for who in film.person], nothing)
    assert perfect.both == perfect.either > 0
    assert not any(perfect.foot_px)
    assert np.allclose(perfect.column_px, 0.0)
    assert (nothing.both, nothing.false_px) == (0, 0)


@pytest.mark.slow
def test_scenes_differ_and_most_robots_drive():
    scenes = [random_scene(seed) for seed in range(100, 130)]
    assert random_scene(100) == scenes[0]
    assert 10 <= sum("commands" in scene["robot"] for scene in scenes) <= 28
    assert len({scene["place"]["kind"] for scene in scenes}) >= 3
    assert {len(scene.get("people", [])) for scene in scenes} >= {1, 2, 3, 4}


def test_a_robot_that_needs_eyes_is_refused():
    with refused("follow_visitors", "stands or is scripted"):
        render_panoramas(load_scenario("follow_visitors"), 0)


def test_a_folder_that_cannot_be_written_is_refused(tmp_path, capsys):
    (tmp_path / "file").write_text("in the way")
    told = refusal(capsys, "train", "foreground", "--out", tmp_path / "file" / "out")
    assert "cannot write here" in told
