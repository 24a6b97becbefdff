"""An episode is saved as the run that it was."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
import yaml

from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from tests.helpers.calls.command_line import run_cli
from tests.helpers.calls.refused import refused
from tests.helpers.runs.exported import SCENE
from tests.helpers.some_of import some_of

STEPS = 20
LATE = {"name": "clara", "enter_s": 1.6, "path": [{"at_m": [6.5, 1.0]}]}
FOLLOWED: dict[str, Any] = SCENE | {
    "name": "followed",
    "duration_s": 2.0,
    "people": [{"name": "anna", "path": [{"at_m": [4.5, 0.2]}, {"at_m": [7.0, 0.2], "speed_m_s": 0.7}]}],
    "things": [],
    "robot": {"at_m": [0.6, 0.0], "behaviour": "follow_person"},
}


def played(folder: Path, observation: str, steps: int = STEPS, **changes: Any) -> PeopleBoyEnv:
    path = folder / "followed.yaml"
    path.write_text(yaml.safe_dump(FOLLOWED | changes), encoding="utf-8")
    env = PeopleBoyEnv(path, observation=observation)
    env.reset(seed=3)
    for step in range(steps):
        env.step(np.array([0.5, 0.1 * np.sin(step)], np.float32))
    return env


@pytest.mark.thorough
@pytest.mark.parametrize("observation", some_of(["tracks", "truth"], 2))
def test_its_figures_are_those_of_the_episode_and_it_is_looked_into_as_any_run(
    observation: str, tmp_path: Path
) -> None:
    env = played(tmp_path, observation)
    env.save(tmp_path / "saved", record=False)
    metrics = json.loads((tmp_path / "saved" / "metrics.json").read_text(encoding="utf-8"))
    figures = env.metrics()["following"]
    assert metrics["following"]["wrong_person_s"] is None
    for name in ("min_distance_m", "collisions"):
        assert metrics["following"][name] == pytest.approx(figures[name], abs=1e-9), name
    for name in ("jerk_m_s3", "personal_s", "personal_intrusions"):
        comfort = env.metrics()["comfort"][name]
        assert metrics["comfort"][name] == pytest.approx(comfort, abs=1e-9), name
    if observation == "tracks":
        assert metrics["following"]["followed"] == pytest.approx(figures["followed"])
    robot = pq.read_table(tmp_path / "saved" / "robot.parquet")
    assert robot.num_rows == STEPS + 1
    about = json.loads((tmp_path / "saved" / "run.json").read_text(encoding="utf-8"))
    assert (about["seed"], about["tracker"]) == (3, "detection" if observation == "tracks" else "truth")
    assert run_cli("evaluate", tmp_path / "saved") == 0
    assert run_cli("export", tmp_path / "saved", "--format", "coco", "--out", tmp_path / "coco") == 0


@pytest.mark.slow
def test_a_whole_episode_has_the_frames_of_a_run_and_who_is_still_to_come_comes(tmp_path: Path) -> None:
    played(tmp_path, "truth", steps=30).save(tmp_path / "whole", record=False)
    assert pq.read_table(tmp_path / "whole" / "robot.parquet").num_rows == 30
    env = played(tmp_path, "truth", steps=5, people=[*FOLLOWED["people"], LATE])
    env.save(tmp_path / "cut", record=False)
    assert pq.read_table(tmp_path / "cut" / "robot.parquet").num_rows == 25
    assert run_cli("export", tmp_path / "cut", "--format", "coco", "--out", tmp_path / "coco") == 0


def test_an_earlier_run_is_replaced_only_when_asked(tmp_path: Path) -> None:
    env = played(tmp_path, "truth", steps=1)
    (tmp_path / "saved").mkdir()
    with refused("save", "exists already", "overwrite=True"):
        env.save(tmp_path / "saved", record=False)


def test_what_no_run_can_be_is_refused_in_a_line(tmp_path: Path) -> None:
    env = played(tmp_path, "truth", steps=1)
    env.reset(seed=1, options={"warmer_k": [-2.0, 2.0]})
    with refused("save", "options"):
        env.save(tmp_path / "varied")
    quick = PeopleBoyEnv(tmp_path / "followed.yaml", observation="truth", physics_hz=60)
    with refused("reset"):
        quick.save(tmp_path / "none")
    quick.reset(seed=1)
    with refused("physics_hz=240", "60"):
        quick.save(tmp_path / "quick")
    small = PeopleBoyEnv(tmp_path / "followed.yaml", observation="tracks", image_size=(160, 120))
    small.reset(seed=1)
    with refused("(160, 120)"):
        small.save(tmp_path / "small")
    assert not [path for path in tmp_path.iterdir() if path.is_dir()]
