import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from examples import price_of_perception
from examples.follower_view import SIZE, FollowerView
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from tests.helpers.runs.exported import make_run
from tests.helpers.some_of import some_of

SCENE = """
name: tiny
description: Somebody stands before the robot.
duration_s: 2.0
place: {kind: corridor, length_m: 9.0, width_m: 3.0}
people: [{name: anna, path: [{at_m: [6.5, 0.3], face: robot}]}]
robot: {at_m: [1.5, 0.0], behaviour: follow_person}
"""

WALKING: dict[str, Any] = {
    "name": "walking",
    "description": "Somebody walks past a robot that stands.",
    "duration_s": 2.5,
    "place": {"kind": "room", "length_m": 9.0, "width_m": 6.0},
    "robot": {"at_m": [1.0, 0.0]},
}


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


@pytest.mark.slow
def test_all_three_pairs_of_eyes_find_a_person_in_plain_sight(scene: Path) -> None:
    done = CliRunner().invoke(price_of_perception.main, [str(scene), "--seeds", "1"])
    assert done.exit_code == 0, done.output
    lines = done.output.splitlines()
    assert lines[1].split() == ["truth", "tracks", "pixels"]
    assert next(line for line in lines if "found" in line).split().count("100.00") == 3
    assert CliRunner().invoke(price_of_perception.main, ["--eyes", "nose"]).exit_code == 2


def test_the_warm_patch_is_where_the_true_person_is(scene: Path) -> None:
    env = PeopleBoyEnv(scene, observation="pixels")
    observation, info = env.reset(seed=0)
    box = info["truth"].people[0].box
    x, height = price_of_perception.see_warmth(observation)
    assert x == pytest.approx((box[0] + box[2] / 2.0 - 159.5) / 160.0, abs=0.05)
    assert height == pytest.approx(box[3] / 240.0, abs=0.08)
    env.close()


def test_the_view_of_the_follower_stays_within_its_space_and_remembers_where_the_person_was(
    scene: Path,
) -> None:
    env = FollowerView(PeopleBoyEnv(scene, observation="truth"))
    seen, _ = env.reset(seed=0)
    assert seen[0] == 1.0
    while seen[0]:  # turn away to the right: the person leaves to the left
        seen, *_ = env.step(np.array([0.0, -1.0], np.float32))
        assert seen.shape == (SIZE,)
        assert env.observation_space.contains(seen)
    assert seen[6] == -1.0
    env.close()


def test_a_follower_is_trained_kept_without_pickles_and_compared(scene: Path, tmp_path: Path) -> None:
    pytest.importorskip("stable_baselines3")
    from examples import train_follower

    kept = tmp_path / "follower.npz"
    options = [str(scene), "--seeds", "1", "--out", str(kept)]
    assert CliRunner().invoke(train_follower.main, [*options, "--steps", "0"]).exit_code == 2
    trained = CliRunner().invoke(train_follower.main, [*options, "--steps", "1"])
    assert trained.exit_code == 0, trained.output
    again = CliRunner().invoke(train_follower.main, [*options, "--steps", "0"])
    assert "learned - written" in again.output
    assert trained.output.endswith(again.output)
    with np.load(kept, allow_pickle=False) as weights:
        assert all(weights[name].dtype == np.float32 for name in weights)


ACROSS: dict[str, Any] = WALKING | {
    "people": [{"name": "anna", "path": [{"at_m": [4.5, -1.2]}, {"at_m": [4.5, 1.2], "speed_m_s": 1.0}]}]
}


@pytest.mark.slow
def test_our_tracking_follows_the_detections_of_others_across(tmp_path: Path) -> None:
    run = make_run(ACROSS, tmp_path / "run", "--detector", "examples.detectors:MovingBlobs")
    metrics = json.loads((run / "metrics.json").read_text(encoding="utf-8"))
    assert metrics["thesis"]["CR_percent"] > 30.0
    assert metrics["counts"]["tracks"] == 1


@pytest.mark.slow
@pytest.mark.parametrize("name", some_of(["BackgroundSort", "HogByteTrack"], 2))
def test_trackers_of_others_find_somebody_who_walks_across(name: str, tmp_path: Path) -> None:
    pytest.importorskip("trackers")
    run = make_run(ACROSS, tmp_path / "run", "--tracker", f"examples.peers:{name}")
    metrics = json.loads((run / "metrics.json").read_text(encoding="utf-8"))
    assert metrics["thesis"]["CR_percent"] > 30.0
    assert metrics["thesis"]["CP_percent"] > 40.0
