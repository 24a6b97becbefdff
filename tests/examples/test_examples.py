import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from examples.warm_patch import WarmPatch
from peopleboy import Frame
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


def test_the_warm_patch_is_where_the_true_person_is(scene: Path) -> None:
    tracker = WarmPatch(np.random.default_rng(0))
    env = PeopleBoyEnv(scene, observation="pixels")
    observation, info = env.reset(seed=0)
    found = tracker.update(Frame.from_image(observation["thermal"][:, :, 0], 0.0))
    left, _, width, height = info["truth"].people[0].box
    (x, _, wide, tall), *_ = [track.boxes["thermal"] for track in found]
    assert x + wide / 2.0 == pytest.approx(left + width / 2.0, abs=8.0)
    assert tall == pytest.approx(height, abs=20.0)
    assert tracker.update(Frame.from_image(np.zeros((240, 320), np.uint8), 0.1)) == ()
    env.close()


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
