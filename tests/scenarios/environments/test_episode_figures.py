"""The figures of an episode are those of the run with the same scenario, seed, tracker and commands."""

from __future__ import annotations

import json
import math
from dataclasses import astuple
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest

from peopleboy.behaviours.behaviour import Command
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.written_controller import WrittenController
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.running.run import run
from peopleboy.scenarios.running.run_options import RunOptions
from peopleboy.sim.robot.robot_config import DriveConfig
from peopleboy.sim.truth.scenes import ImageFreeTruth

SEED = 2
LIMITS = DriveConfig()
SCENARIO = """
name: short
description: The first seconds of another scenario.
like: {like}
duration_s: {duration_s}
"""


def write_short(folder: Path, like: str, duration_s: float) -> Path:
    path = folder / "short.yaml"
    path.write_text(SCENARIO.format(like=like, duration_s=duration_s), encoding="utf-8")
    return path


def command(linear: float, angular: float) -> Command:
    """Give what an environment makes of an action."""
    return Command(
        linear_m_s=linear * LIMITS.max_linear_m_s, angular_rad_s=angular * LIMITS.max_angular_rad_s
    )


def play(env: PeopleBoyEnv, path: Path) -> tuple[list[Command], list[ImageFreeTruth], dict[str, Any]]:
    """Let the scenario's behaviour drive; give its commands, the truth of every instant, and the figures."""
    controller = WrittenController(load_scenario(path).make_behaviour())
    observation, info = env.reset(seed=SEED)
    commands, scenes, is_over = [], [info["truth"]], False
    while not is_over:
        linear, angular = controller(observation).astype(float).tolist()
        commands.append(command(linear, angular))
        observation, _, terminated, is_over, info = env.step((linear, angular))
        assert not terminated
        scenes.append(info["truth"])
    env.close()
    return commands, scenes, info["metrics"]


def repeat(path: Path, commands: list[Command], tracker: str, out: Path) -> dict[str, Any]:
    """Run the scenario with these commands, and give its figures."""
    options = RunOptions(seed=SEED, out=out, tracker=tracker, record=False)
    run(load_scenario(path).driven(commands), options, lambda *_: None)
    return json.loads((out / "metrics.json").read_text(encoding="utf-8"))


def known(figures: dict[str, Any]) -> dict[str, Any]:
    """Give figures as JSON holds them."""
    return {
        name: None if isinstance(value, float) and math.isnan(value) else value
        for name, value in figures.items()
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    ("like", "duration_s", "tracker"),
    [
        pytest.param("follow_occluded", 27.0, "contour", marks=pytest.mark.heavy),
        ("single_follow", 6.0, "truth"),
    ],
)
def test_an_episode_has_the_truth_and_the_figures_of_a_run_of_its_commands(
    like: str, duration_s: float, tracker: str, tmp_path: Path
) -> None:
    path, out = write_short(tmp_path, like, duration_s), tmp_path / "run"
    env = PeopleBoyEnv(path, observation="tracks", tracker=tracker)
    commands, scenes, figures = play(env, path)
    scores = repeat(path, commands, tracker, out)
    assert 0.0 < scores["following"]["followed"] <= 1.0
    assert known(figures["following"]) == known(scores["following"])
    assert math.isnan(figures["following"]["wrong_person_s"])
    robot = pq.read_table(out / "robot.parquet").to_pylist()
    people = pq.read_table(out / "truth.parquet", columns=["frame", "id", "x_m", "y_m"]).to_pylist()
    for frame, (here, row) in enumerate(zip(scenes[:-1], robot, strict=True), 1):
        assert astuple(here.robot) == (row["x_m"], row["y_m"], row["heading_rad"])
        assert [(frame, one.id, *one.position_m) for one in here.people] == [
            tuple(one.values()) for one in people if one["frame"] == frame
        ]


@pytest.mark.thorough
def test_an_episode_along_a_corridor_has_the_figures_of_the_run(tmp_path: Path) -> None:
    path = write_short(tmp_path, "corridor_straight", 11.0)
    env = PeopleBoyEnv(path, observation="truth", task="corridor")
    commands, _, figures = play(env, path)
    scores = repeat(path, commands, "contour", tmp_path / "run")
    assert scores["corridor"]["way_m"] > 1.0
    assert known(figures["corridor"]) == known(scores["corridor"])


@pytest.mark.parametrize("observation", ["truth", "pixels"])
def test_without_a_tracker_a_person_counts_as_tracked_while_seen(observation: str) -> None:
    env = PeopleBoyEnv("single_follow", observation=observation, image_size=(80, 60))
    _, info = env.reset(seed=0)
    seen = [info["truth"].people[0].is_seen]
    for step in range(90):
        info = env.step((0.0, 0.3 if step < 60 else -0.3))[4]
        assert "metrics" not in info
        seen.append(info["truth"].people[0].is_seen)
    figures = env.metrics()["following"]
    env.close()
    assert 0 < sum(seen) < len(seen)
    assert figures["found"]
    assert figures["time_to_find_s"] == pytest.approx(seen.index(True) / 15.0)
    since = seen[seen.index(True) :]
    assert figures["followed"] == pytest.approx(sum(since) / len(since))
