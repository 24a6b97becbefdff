from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import peopleboy  # noqa: F401  # tells gymnasium the environments
from peopleboy.bad_input import BadInput
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.vector_environment import PeopleBoyVectorEnv, join_infos
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.batch.batch_cameras import WorkerPool
from peopleboy.sim.batch.world_batch import WorldBatch
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.some_of import some_of

SLOW_REAR = """
name: slow_rear
description: One camera is slower than the others.
like: single_follow
robot:
  at_m: [4.6, 0.0]
  cameras:
    thermal: {kind: thermal}
    colour: {kind: colour}
    rear: {kind: thermal, yaw_deg: 180, mount_m: [-0.3, 0, 1.3], rate_hz: 5}
"""
SHORT = "name: short\ndescription: So short that it ends.\nlike: single_follow\nduration_s: 0.4\n"


def assert_alike(ours: dict[str, Any], theirs: dict[str, Any]) -> None:
    """Infos of many worlds, to the bit."""
    assert list(ours) == list(theirs)
    for key, one in ours.items():
        if isinstance(one, dict):
            assert_alike(one, theirs[key])
        else:
            assert one.dtype == theirs[key].dtype
            assert repr(one.tolist()) == repr(theirs[key].tolist())  # as NaN is not NaN


@pytest.fixture
def short(tmp_path: Path) -> Path:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return path


@pytest.mark.slow
@pytest.mark.parametrize(
    ("observation", "physics"),
    [("pixels", "kinematic"), ("truth", "bullet"), ("truth", "kinematic"), ("tracks", "kinematic")],
)
def test_each_world_is_to_the_byte_a_single_environment_over_its_end_and_a_new_beginning(
    observation: str, physics: str, short: Path
) -> None:
    settings = {"observation": observation, "physics": physics, "image_size": (64, 48)}
    many = PeopleBoyVectorEnv(2, scenario=short, **settings)
    single = [PeopleBoyEnv(short, **settings) for _ in range(2)]
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (9, 2, 2)).astype(np.float32)
    found, infos = many.reset(seed=3)
    last = [env.reset(seed=3 + number) for number, env in enumerate(single)]
    over = [False, False]
    ends = 0
    for action in [None, *actions]:
        if action is not None:
            found, rewards, ended, cut, infos = many.step(action)
            for number, env in enumerate(single):
                if over[number]:
                    last[number], reward, over[number] = env.reset(), 0.0, False
                    assert (ended[number], cut[number]) == (False, False)
                else:
                    seen, reward, terminated, truncated, info = env.step(action[number])
                    last[number], over[number] = (seen, info), terminated or truncated
                    assert (ended[number], cut[number]) == (terminated, truncated)
                    ends += over[number]
                assert rewards[number] == reward
        assert_alike(infos, join_infos([info for _, info in last]))
        for number, (seen, _) in enumerate(last):
            for name, array in seen.items():
                assert found[name][number].tobytes() == array.tobytes()
    assert ends == 2
    assert many.observation_space.contains(found)
    many.close()
    for env in single:
        env.close()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scenario", "observation"),
    some_of(
        [
            ("tidying_1", "pixels"),  # things are moved
            ("crowd_8", "pixels"),  # they come in one after the other, and make way
            ("single_stationary", "truth"),  # the robot drives into her
            ("crowd_8", "truth"),
            ("reacts_blocks", "truth"),
            ("tidying_1", "truth"),
            ("reacts_blocks", "pixels"),
            ("single_stationary", "pixels"),
        ],
        2,
    ),
)
def test_fleets_are_to_the_byte_single_worlds_whatever_people_do(scenario: str, observation: str) -> None:
    settings = {"observation": observation, "physics": "kinematic", "physics_hz": 60, "normalise": True}
    settings["image_size"] = (64, 48)
    many = PeopleBoyVectorEnv(2, scenario=scenario, **settings)
    single = [PeopleBoyEnv(scenario, **settings) for _ in range(2)]
    ends = 0
    rng = np.random.default_rng(0)
    many.reset(seed=3)
    over = [False, False]
    for number, env in enumerate(single):
        env.reset(seed=3 + number)
    for _ in range(40 if observation == "pixels" and scenario != "single_stationary" else 100):
        actions = rng.uniform((0.9, -0.02), (1.0, 0.02), (2, 2)).astype(np.float32)
        found, rewards, _, _, infos = many.step(actions)
        told = []
        for number, env in enumerate(single):
            if over[number]:
                seen, info = env.reset()
                over[number] = False
            else:
                seen, reward, ended, cut, info = env.step(actions[number])
                assert rewards[number] == reward
                over[number] = ended or cut
                ends += ended
            told.append(info)
            for name, array in seen.items():
                assert found[name][number].tobytes() == array.tobytes()
        assert_alike(infos, join_infos(told))
    assert ends > 0 or scenario != "single_stationary"
    many.close()
    for env in single:
        env.close()


def test_threads_change_no_byte_and_cameras_take_images_at_rates_of_their_own(tmp_path: Path) -> None:
    path = tmp_path / "slow_rear.yaml"
    path.write_text(SLOW_REAR)
    settings = {"scenario": path, "observation": "pixels", "physics": "kinematic", "image_size": (64, 48)}
    several = [PeopleBoyVectorEnv(3, threads=threads, **settings) for threads in (1, 3)]
    single = PeopleBoyEnv(**settings)
    for many in several:
        many.reset(seed=4)
    single.reset(seed=6)
    for action in np.random.default_rng(1).uniform(-1.0, 1.0, (9, 3, 2)).astype(np.float32):
        alone, both = (many.step(action)[0] for many in several)
        own = single.step(action[2])[0]
        for name, array in alone.items():
            assert array.tobytes() == both[name].tobytes()
            assert array[2].tobytes() == own[name].tobytes()
    for env in (*several, single):
        env.close()


def test_images_made_together_are_there_by_all_their_names_until_their_instant_is_over() -> None:
    config = replace(load_scenario("crossing_2").world(3), physics="kinematic")
    with SimulatedWorld(config) as world, SimulatedWorld(config) as other:
        together = WorldBatch([world], WorkerPool(1))
        only, command = np.array([0]), np.array([[0.3, 0.2]])
        found = together.step(only, command)[0].senses(0)
        other.step(0.3, 0.2)
        own = other.observe()
        assert list(found.images) == list(own.images)
        for name in ("thermal_c", "thermal_scene", "thermal"):
            assert found.images[name].tobytes() == own.images[name].tobytes()
        together.step(only, command)
        other.step(0.3, 0.2)
        other.observe()
        with pytest.raises(BadInput, match="not read in time"):
            found.images["colour"]
        last = together.step(only, command)[0].senses(0)
        other.step(0.3, 0.2)
        assert last.images["colour"].tobytes() == other.observe().images["colour"].tobytes()


def test_gymnasium_makes_it_by_name_and_samples_fit() -> None:
    many = gymnasium.make_vec(
        "peopleboy/PersonFollowing-v0",
        num_envs=3,
        vectorization_mode="vector_entry_point",
        observation="truth",
        physics="kinematic",
    )
    assert isinstance(many.unwrapped, PeopleBoyVectorEnv)
    assert many.metadata["autoreset_mode"] == gymnasium.vector.AutoresetMode.NEXT_STEP
    found, _ = many.reset(seed=[5, 5, 8])
    assert np.array_equal(found["sonar"][0], found["sonar"][1])
    assert not np.array_equal(found["sonar"][0], found["sonar"][2])
    kept = found["sonar"].copy()
    after, rewards, *_ = many.step(many.action_space.sample())
    assert rewards.shape == (3,)
    assert many.observation_space.contains(after)
    assert np.array_equal(found["sonar"], kept)
    many.close()


def test_what_does_not_fit_many_worlds_is_refused() -> None:
    with pytest.raises(BadInput, match="num_envs"):
        PeopleBoyVectorEnv(0)
    with pytest.raises(BadInput, match="threads 0"):
        PeopleBoyVectorEnv(2, threads=0)
    with pytest.raises(BadInput, match="threads 'a'"):
        PeopleBoyVectorEnv(2, threads="a")  # type: ignore[arg-type]
    with pytest.raises(BadInput, match=r"autoreset_mode 'same': must be AutoresetMode.NEXT_STEP or"):
        PeopleBoyVectorEnv(2, autoreset_mode="same")  # type: ignore[arg-type]
    with pytest.raises(BadInput, match="unknown render_mode 'human'; choose from None, rgb_array"):
        PeopleBoyVectorEnv(2, render_mode="human")
    many = PeopleBoyVectorEnv(2, observation="truth", physics="kinematic")
    with pytest.raises(BadInput, match="no episode"):
        many.step(np.zeros((2, 2), np.float32))
    with pytest.raises(BadInput, match="one per world"):
        many.reset(seed=[1])
    with pytest.raises(BadInput, match=r"\(2, 2\)"):
        many.step(np.zeros(2, np.float32))
    many.reset(seed=np.array([1, 2]))
    with pytest.raises(BadInput, match="seed -1 must be a whole number"):
        many.reset(seed=[3, -1])
    ours = many.step(np.zeros((2, 2), np.float32))[0]  # world 0 is another one by now
    one = PeopleBoyEnv(observation="truth", physics="kinematic")
    one.reset(seed=3)
    assert np.array_equal(ours["sonar"][0], one.step(np.zeros(2, np.float32))[0]["sonar"])
    many.close()
    for call in (many.reset, lambda: many.step(np.zeros((2, 2), np.float32))):
        with pytest.raises(BadInput, match="is closed"):
            call()


def test_worlds_of_several_kinds_some_of_them_empty_are_single_worlds_too() -> None:
    settings = {"observation": "pixels", "physics": "kinematic", "image_size": (64, 48), "physics_hz": 60}
    settings["randomise"] = {"noise": [0.5, 1.5], "people": [0, 1]}  # each camera has a noise of its own
    many = PeopleBoyVectorEnv(3, threads=2, **settings)
    single = [PeopleBoyEnv(**settings) for _ in range(3)]
    many.reset(seed=5)
    there = {len(env.reset(seed=5 + number)[1]["truth"].people) for number, env in enumerate(single)}
    assert there == {0, 1}
    for actions in np.random.default_rng(2).uniform(-1.0, 1.0, (3, 3, 2)).astype(np.float32):
        found, rewards, _, _, infos = many.step(actions)
        own = [env.step(action) for env, action in zip(single, actions, strict=True)]
        assert rewards.tolist() == [reward for _, reward, *_ in own]
        assert_alike(infos, join_infos([info for *_, info in own]))
        for number, (seen, *_) in enumerate(own):
            assert all(found[name][number].tobytes() == array.tobytes() for name, array in seen.items())
    for env in (many, *single):
        env.close()


@pytest.mark.parametrize("mode", list(AutoresetMode)[:2])
def test_each_world_is_drawn_as_a_single_environment_draws_it(mode: AutoresetMode) -> None:
    settings: Any = {
        "observation": "truth",
        "physics": "kinematic",
        "render_mode": "rgb_array",
        "image_size": (64, 48),
    }
    many = PeopleBoyVectorEnv(2, autoreset_mode=mode, max_episode_steps=3, **settings)
    singles = [PeopleBoyEnv(max_episode_steps=3, **settings) for _ in range(2)]
    many.reset(seed=5)
    for number, single in enumerate(singles):
        single.reset(seed=5 + number)
    for _ in range(5):
        many.step(np.full((2, 2), 0.3, np.float32))
        pictures = many.render()
        assert pictures is not None
        for single, picture in zip(singles, pictures, strict=True):
            ended = single._own["is_over"]
            if not ended:
                ended = any(single.step(np.full(2, 0.3, np.float32))[2:4]) and mode is AutoresetMode.SAME_STEP
            if ended:
                single.reset()
            drawn = single.render()
            assert drawn is not None
            np.testing.assert_array_equal(picture, drawn)
    many.close()
