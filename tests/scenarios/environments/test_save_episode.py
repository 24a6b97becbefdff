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
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.report.findings.run_findings import analyse_run, headline
from peopleboy.scenarios.run_folder.finished_run import cameras_of, open_run
from peopleboy.scenarios.running.run import run as run_scenario
from peopleboy.scenarios.running.run_options import RunOptions
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
def test_a_saved_run_has_the_frames_of_the_episode_though_people_are_still_to_come(tmp_path: Path) -> None:
    played(tmp_path, "truth", steps=30).save(tmp_path / "whole", record=False)
    assert pq.read_table(tmp_path / "whole" / "robot.parquet").num_rows == 30
    env = played(tmp_path, "truth", steps=5, people=[*FOLLOWED["people"], LATE])
    assert env.save(tmp_path / "cut", record=False) == tmp_path / "cut"
    assert pq.read_table(tmp_path / "cut" / "robot.parquet").num_rows == 6
    assert run_cli("export", tmp_path / "cut", "--format", "coco", "--out", tmp_path / "coco") == 0
    scenario = load_scenario(tmp_path / "cut" / "scenario.yaml")
    assert (scenario.frames, scenario.duration_s) == (6, 2.0)


OPTIONS = {
    "warmer_k": (-3.0, 3.0),
    "noise": 2,
    "clothes": True,
    "pace": (0.5, 0.8),
    "facing": True,
    "people": 1,
    "camera_pitch_deg": (-5.0, 5.0),
    "camera_height_m": -0.2,
    "action_noise": 0.2,
    "latency_s": (0.1, 0.3),
    "wheel_slip": (0.1, 0.3),
    "odometry_drift": 0.1,
    "calibration_turned": (1.0, 3.0),
    "calibration_off": 0.02,
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("observation", "rate_hz", "size", "options"),
    [
        ("truth", 60, (320, 240), OPTIONS),
        ("truth", 480, (320, 240), {}),
        ("tracks", 240, (160, 120), OPTIONS),
        ("pixels", 120, (64, 48), {"light": [0.5, 0.9]}),
    ],
)
def test_a_varied_episode_with_any_physics_and_image_size_is_saved_as_it_was(
    tmp_path: Path, observation: str, rate_hz: int, size: tuple[int, int], options: dict[str, Any]
) -> None:
    path = tmp_path / "followed.yaml"
    path.write_text(yaml.safe_dump(FOLLOWED), encoding="utf-8")
    env = PeopleBoyEnv(path, observation=observation, physics_hz=rate_hz, image_size=size)
    _, first = env.reset(seed=5, options=options)
    poses, rewards, terms = [first["truth"].robot], [], []
    for step in range(12):
        _, reward, *_, info = env.step(np.array([0.4, 0.3 * np.sin(step)], np.float32))
        poses.append(info["truth"].robot)
        rewards.append(float(reward))
        terms.append(info["reward"])
    folder = env.save(tmp_path / "saved", record=False)
    robot = pq.read_table(folder / "robot.parquet")
    assert robot["x_m"].to_pylist() == [pose.x for pose in poses]
    assert robot["heading_rad"].to_pylist() == [pose.heading for pose in poses]
    table = pq.read_table(folder / "rewards.parquet")
    assert table["reward"].to_pylist() == pytest.approx(rewards)
    assert table["keep"].to_pylist() == [each["keep"] for each in terms]
    metrics = json.loads((folder / "metrics.json").read_text(encoding="utf-8"))
    for group, figures in env.metrics().items():
        for name, value in figures.items():
            assert metrics[group][name] == (None if value != value else value), f"{group}.{name}"
    about = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    assert about["status"] == "complete"
    assert about["episode"] == {
        "task": "follow",
        "steps": 12,
        "ended": None,
        "return": pytest.approx(sum(rewards)),
    }
    run = open_run(folder)
    assert run.world.physics_hz == rate_hz
    if observation == "tracks":
        assert cameras_of(folder)["thermal"].camera.width == 160
        assert run.world.robot.cameras == env.world.config.robot.cameras
    assert run.world.people == env.world.config.people
    again = run_scenario(folder / "scenario.yaml", RunOptions(seed=5, out=tmp_path / "again", record=False))
    assert again is not None
    assert pq.read_table(tmp_path / "again" / "robot.parquet").equals(robot)


@pytest.mark.slow
def test_a_saved_run_ends_as_its_episode_although_more_people_would_come(tmp_path: Path) -> None:
    env = PeopleBoyEnv("follow_passers_by", observation="truth", physics="kinematic")
    env.reset(seed=1000)
    for step in range(400):
        *_, is_over, is_cut, info = env.step(np.array([0.0, 1.0 if step < 24 else 0.0], np.float32))
        if is_over or is_cut:
            break
    assert info["reward"]["lost"] < 0.0
    folder = env.save(tmp_path / "ended", record=False)
    about = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    assert (about["episode"]["ended"], about["episode"]["steps"]) == ("lost", step + 1)
    assert about["frames"] == step + 2
    following = json.loads((folder / "metrics.json").read_text(encoding="utf-8"))["following"]
    assert following["longest_lost_s"] == env.metrics()["following"]["longest_lost_s"]
    words = headline([analyse_run(open_run(folder))])
    assert words.startswith("The robot lost Maria for good at "), words


def test_an_earlier_run_is_replaced_only_when_asked(tmp_path: Path) -> None:
    env = played(tmp_path, "truth", steps=1)
    (tmp_path / "saved").mkdir()
    with refused("save", "exists already", "overwrite=True"):
        env.save(tmp_path / "saved", record=False)


def test_an_environment_that_was_not_reset_saves_nothing(tmp_path: Path) -> None:
    env = PeopleBoyEnv("single_follow", observation="truth", physics_hz=60)
    with refused("reset"):
        env.save(tmp_path / "none")
    assert not list(tmp_path.iterdir())
