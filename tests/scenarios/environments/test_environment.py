"""The environments, as somebody meets them who brings a controller."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from peopleboy.bad_input import BadInput
from peopleboy.registration import ENVIRONMENTS
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.observations import KINDS
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.scores.following_metrics import following_task
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.calls.refused import refused
from tests.helpers.some_of import some_of

README = Path(__file__).parents[3] / "README.md"
SMALL = (80, 60)
SCENE = """
name: touch
description: A person stands before the robot.
duration_s: 12.0
place: {kind: corridor, length_m: 9.0, width_m: 3.0}
people: [{name: anna, path: [{at_m: [3.0, 0.0], face: robot}]}]
robot: {at_m: [1.5, 0.0]}
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "touch.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return path


def play(env: PeopleBoyEnv, steps: int, action: tuple[float, float] = (0.2, 0.3)) -> list[dict]:
    return [env.step(action)[0] for _ in range(steps)]


@pytest.mark.thorough
def test_the_environments_are_known_after_import_of_peopleboy() -> None:
    code = f"import gymnasium, peopleboy; [gymnasium.make(name) for name in {list(ENVIRONMENTS)}]"
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True, timeout=120)


@pytest.mark.parametrize(
    ("name", "kind"),
    some_of(
        [
            (name, kind)
            for name in ENVIRONMENTS
            for kind in KINDS
            if name == next(iter(ENVIRONMENTS)) or kind == "truth"
        ],
        2,
    ),
)
def test_gymnasiums_own_check_finds_nothing(name: str, kind: str, scene: Path) -> None:
    task = ENVIRONMENTS[name]["task"]
    check_env(
        gymnasium.make(
            name, observation=kind, image_size=SMALL, render_mode="rgb_array", scenario=scene, task=task
        ).unwrapped
    )


@pytest.mark.parametrize("name", ENVIRONMENTS)
def test_every_name_makes_an_environment_of_its_own_scenario(name: str) -> None:
    env = gymnasium.make(name, observation="truth")
    _, info = env.reset(seed=0)
    assert info["truth"].time_s == 0.0
    assert np.isfinite(env.step(env.action_space.sample())[1])
    env.close()


def test_the_same_seed_repeats_the_whole_sequence_of_episodes(scene: Path) -> None:
    def episodes() -> list[np.ndarray]:
        env = PeopleBoyEnv(scene, observation="pixels", image_size=SMALL)
        found = []
        for seed in (5, None, None):
            found.append(env.reset(seed=seed)[0])
            found += play(env, 3)
        env.close()
        return [array for observation in found for array in observation.values()]

    first, second = episodes(), episodes()
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))
    assert not np.array_equal(first[0], first[len(first) // 3])


@pytest.mark.parametrize("shown", ["thermal", "colour"])
def test_images_of_one_camera_alone_are_those_of_all_cameras(shown: str, scene: Path) -> None:
    def episode(**settings: Any) -> list[dict[str, np.ndarray]]:
        env = PeopleBoyEnv(scene, observation="pixels", image_size=SMALL, **settings)
        found = [env.reset(seed=1)[0], *play(env, 2)]
        assert all(env.observation_space.contains(each) for each in found)
        env.close()
        return found

    for every, one in zip(episode(), episode(cameras=(shown,)), strict=True):
        assert set(every) - set(one) == {"thermal", "colour"} - {shown}
        assert all(np.array_equal(one[name], every[name]) for name in one)


def test_an_episode_of_a_seed_is_the_world_of_a_run_of_that_seed() -> None:
    env = PeopleBoyEnv("corridor_meeting", observation="pixels")
    observation, info = env.reset(seed=4)
    with SimulatedWorld(load_scenario("corridor_meeting").world(4)) as world:
        seen = world.observe()
        assert np.array_equal(observation["thermal"][:, :, 0], seen.images["thermal"])
        assert np.array_equal(observation["colour"], seen.images["colour"])
        assert info["truth"] == world.scene()
    env.close()


def test_truth_tells_what_the_eyes_would_and_renders_nothing(scene: Path) -> None:
    blind = PeopleBoyEnv(scene, observation="truth")
    seeing = PeopleBoyEnv(scene, observation="truth", render_mode="rgb_array")
    for env in (blind, seeing):
        env.reset(seed=1)
    for one, other in zip(play(blind, 40, (0.1, 0.02)), play(seeing, 40, (0.1, 0.02)), strict=True):
        assert all(np.allclose(one[key], other[key], atol=1e-5) for key in one)
    with pytest.raises(BadInput, match="no images"):
        blind._world.observe()
    blind.close()
    seeing.close()


def test_tracks_and_truth_agree_on_a_person_in_plain_sight(scene: Path) -> None:
    rows = {}
    for kind in ("tracks", "truth"):
        env = PeopleBoyEnv(scene, observation=kind)
        env.reset(seed=2, options={})
        rows[kind] = play(env, 30, (-0.3, 0.0))[-1]["tracks"].reshape(-1, 7)
        env.close()
    assert rows["tracks"][0, 0] > 0
    assert rows["tracks"][0, [1, 2]] == pytest.approx(rows["truth"][0, [1, 2]], abs=0.15)
    assert not rows["truth"][1:].any()


def test_running_into_a_person_ends_the_episode_at_a_cost(scene: Path) -> None:
    env = PeopleBoyEnv(scene, observation="truth")
    env.reset(seed=0)
    terminated = truncated = False
    while not (terminated or truncated):
        _, reward, terminated, truncated, info = env.step((1.0, 0.0))
    assert terminated
    assert info["reward"]["collision"] == -10.0
    assert reward == pytest.approx(sum(info["reward"].values()))
    assert ("contact", "anna") in info["events"]
    with pytest.raises(BadInput, match="reset"):
        env.step((0.0, 0.0))
    env.close()


def test_a_person_out_of_sight_for_ten_seconds_is_lost_and_time_ends_an_episode(scene: Path) -> None:
    env = PeopleBoyEnv(scene, observation="truth")
    env.reset(seed=0)
    steps, ends = 0, (False, False)
    while not any(ends):
        # Turn round, and then look at the wall.
        _, _, *ends, info = env.step((0.0, 0.5 if steps < 36 else 0.0))
        steps += 1
    assert ends == [True, False]
    assert info["reward"]["lost"] == -10.0
    assert 150 < steps < 170
    env.reset(seed=0)
    ends = [env.step((0.0, 0.0))[2:4] for _ in range(12 * 15)]
    assert ends[-1] == (False, True)
    assert not any(map(any, ends[:-1]))
    env.close()


def test_a_second_of_perfect_following_earns_one(scene: Path) -> None:
    env = PeopleBoyEnv(scene, observation="truth")
    env.reset(seed=0)
    near = far = 0.0
    for _ in range(15):
        far = env.step((0.0, 0.0))[4]["truth"].people[0].distance_m
    terms = env.step((0.0, 0.0))[4]["reward"]
    assert far == pytest.approx(1.5, abs=0.02)
    scenario = load_scenario(scene)
    keep_m = following_task(scenario.world(0), scenario.follow_config().keep_height).keep_m
    near = (1.0 - (keep_m - far) / 3.0) / 30.0
    assert terms["keep"] == pytest.approx(near, abs=1e-3)
    assert terms["face"] == pytest.approx(1.0 / 30.0, abs=1e-3)
    env.close()


def test_straight_driving_in_the_middle_of_a_corridor_earns_its_share_of_full_speed(scene: Path) -> None:
    env = PeopleBoyEnv(scene, observation="truth", task="corridor")
    env.reset(seed=0, options={"people": 0})
    play(env, 45, (0.5, 0.0))
    terms = env.step((0.5, 0.0))[4]["reward"]
    assert terms["progress"] == pytest.approx(0.5 / 15.0, rel=0.02)
    assert sum(terms.values()) == pytest.approx(terms["progress"], abs=1e-3)
    env.close()


@pytest.mark.parametrize("make", [gymnasium.vector.SyncVectorEnv, gymnasium.vector.AsyncVectorEnv])
def test_several_run_side_by_side(make: type, scene: Path) -> None:
    def one() -> PeopleBoyEnv:
        return PeopleBoyEnv(scene, observation="tracks", image_size=SMALL)

    envs = make([one, one])
    observation, info = envs.reset(seed=3)
    assert info["seed"].tolist() == [3, 4]
    for _ in range(4):
        observation, *_ = envs.step(np.zeros((2, 2), np.float32))
    assert observation["tracks"].shape == (2, 35)
    envs.close()


def test_options_change_what_they_name_for_one_episode(scene: Path) -> None:
    env = PeopleBoyEnv(scene, observation="pixels", image_size=SMALL)
    plain, _ = env.reset(seed=0)
    warm, info = env.reset(seed=0, options={"warmer_k": 6.0, "light": 0.0, "noise": 0.0, "people": 0})
    assert warm["thermal"].mean() > plain["thermal"].mean() + 20
    assert warm["colour"].max() < 0.1 * plain["colour"].max()
    assert info["truth"].people == ()
    again, _ = env.reset(seed=0)
    assert all(np.array_equal(again[key], plain[key]) for key in plain)
    other, _ = env.reset(seed=0, options={"clothes": True})
    assert not np.array_equal(other["colour"], plain["colour"])
    env.close()


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"lihgt": 0.5}, ("'lihgt'", "'light'")),
        ({"light": 3.0}, ("light 3.0", "0 .. 2")),
        ({"light": [1.0, 0.5]}, ("light",)),
        ({"people": 1.5}, ("people 1.5", "whole")),
        ({"noise": float("nan")}, ("noise nan",)),
        ({"pace": 3.0}, ("pace 3.0", "0.2 .. 2")),
        ({"facing": 2}, ("facing 2", "whole")),
        (["people"], ("options: must be a mapping", "['people']")),
        ({"world": {"people": 1}}, ("world", "scenario=None")),
    ],
)
def test_wrong_options_are_refused_in_one_line(options: dict, named: tuple[str, ...], scene: Path) -> None:
    env = PeopleBoyEnv(scene, observation="truth")
    with refused(*named):
        env.reset(options=options)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"observation": "sound"}, ("observation 'sound'", "pixels, tracks, truth")),
        ({"task": "dance"}, ("task 'dance'",)),
        ({"image_size": (40, 30)}, ("image_size (40, 30)",)),
        ({"observation": "truth", "tracker": "thesis"}, ("tracker 'thesis'", "leave it out")),
        ({"normalise": "yes"}, ("normalise 'yes'", "True or False")),
        ({"observation": "pixels", "cameras": ("sonar",)}, ("cameras 'sonar'", "thermal, colour")),
        ({"observation": "pixels", "cameras": "thermal"}, ("cameras 'thermal'", "('thermal',)")),
        ({"observation": "pixels", "cameras": ("colour", "colour")}, ("cameras", "different names")),
        ({"observation": "tracks", "cameras": ("thermal",)}, ("cameras", "'tracks' has no images")),
        ({"tracker": "none"}, ("'none'", "contour")),
        ({"render_mode": "ansi"}, ("render_mode", "'ansi'")),
        ({"scenario": "singel_follow"}, ("'singel_follow'", "'single_follow'")),
    ],
)
def test_wrong_arguments_are_refused(arguments: dict, named: tuple[str, ...]) -> None:
    with refused(*named):
        PeopleBoyEnv(**arguments)


@pytest.mark.parametrize("action", [(0.0, float("nan")), (0.0,), (0.0, 0.0, 0.0), "left", None])
def test_senseless_actions_are_refused_and_large_ones_clipped(action: tuple, scene: Path) -> None:
    env = PeopleBoyEnv(scene, observation="truth")
    env.reset(seed=0)
    with pytest.raises(BadInput, match="two finite numbers"):
        env.step(action)
    env.step((0.0, 9.0))
    env.close()


def test_closing_frees_the_physics_world(scene: Path) -> None:
    env = PeopleBoyEnv(scene, observation="truth")
    env.reset(seed=0)
    world = env._world
    env.close()
    env.close()
    assert world.physics._client._number is None
    with pytest.raises(BadInput, match="reset"):
        env.step((0.0, 0.0))


@pytest.mark.parametrize("size", [(320, 240), (64, 48), (1280, 48), (64, 960)])
def test_the_picture_shows_both_images_and_the_plan_at_any_size(scene: Path, size: tuple[int, int]) -> None:
    env = PeopleBoyEnv(scene, observation="tracks", render_mode="rgb_array", image_size=size)
    env.reset(seed=0)
    picture = env.render()
    assert picture.shape == (360, 1440, 3)
    assert all(panel.std() > 5 for panel in np.split(picture, 3, axis=1))
    env.close()


@pytest.mark.pages
def test_the_code_in_the_readme_is_short_and_works_as_pasted(tmp_path: Path) -> None:
    readme = README.read_text(encoding="utf-8")
    ((code, printed),) = re.findall(r"```python\n(.*?)```.*?prints `(.*?)`", readme, re.DOTALL)
    assert len(code.splitlines()) <= 10
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=900
    )
    assert done.returncode == 0, done.stderr
    assert int(re.search(r"Tracked (\d+)% of the time", done.stdout)[1]) > 90
    assert done.stdout.strip() == printed


def test_stable_baselines_own_check_finds_nothing(scene: Path) -> None:
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    for kind in KINDS:
        checker.check_env(PeopleBoyEnv(scene, observation=kind, image_size=SMALL))


def test_an_episode_is_the_world_of_a_run_with_the_same_commands() -> None:
    scenario = load_scenario("single_follow")
    env = PeopleBoyEnv("single_follow", observation="truth")
    env.reset(seed=3)
    drive = scenario.world(3).robot.drive
    with SimulatedWorld(scenario.world(3)) as world:
        for step in range(60):
            shares = (0.3, 0.2 if step % 20 < 10 else -0.1)
            *_, info = env.step(shares)
            world.step(shares[0] * drive.max_linear_m_s, shares[1] * drive.max_angular_rad_s)
            there, here = world.truth(), info["truth"]
            assert (here.robot, here.robot_velocity) == (there.robot, there.robot_velocity)
            assert [p.position_m for p in here.people] == [p.position_m for p in there.people]
    env.close()


def test_a_physics_rate_that_does_not_fit_the_control_rate_is_refused() -> None:
    with pytest.raises(BadInput, match=r"15 Hz must divide the physics rate 50 Hz"):
        PeopleBoyEnv("single_follow", physics_hz=50)
