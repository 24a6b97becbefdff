from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

stable_baselines3 = pytest.importorskip("stable_baselines3")

from gymnasium.vector import AutoresetMode  # noqa: E402
from stable_baselines3.common.vec_env import DummyVecEnv, VecFrameStack  # noqa: E402

from peopleboy.bad_input import BadInput  # noqa: E402
from peopleboy.sb3 import PeopleBoyVecEnv, make_vec_env  # noqa: E402
from peopleboy.scenarios.environments.environment import PeopleBoyEnv  # noqa: E402

NAME = "peopleboy/PersonFollowing-v0"
SHORT = "name: short\ndescription: So short that it ends.\nlike: single_follow\nduration_s: 0.4\n"
STEPS_PER_EPISODE = 6


@pytest.fixture
def settings(tmp_path: Path) -> dict[str, Any]:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT, encoding="utf-8")
    return {"scenario": path, "observation": "truth", "physics": "kinematic", "physics_hz": 60}


def test_it_gives_what_their_own_vector_environment_gives(settings: dict[str, Any]) -> None:
    ours = make_vec_env(NAME, 2, seed=3, **settings)
    theirs = DummyVecEnv([lambda: PeopleBoyEnv(**settings)] * 2)
    theirs.seed(3)
    found, expected = ours.reset(), theirs.reset()
    assert all(np.array_equal(found[name], expected[name]) for name in expected)
    ends = 0
    for actions in np.random.default_rng(0).uniform(-1.0, 1.0, (2 * STEPS_PER_EPISODE + 1, 2, 2)):
        found, rewards, over, infos = ours.step(actions.astype(np.float32))
        expected, their_rewards, their_over, their_infos = theirs.step(actions.astype(np.float32))
        assert all(np.array_equal(found[name], expected[name]) for name in expected)
        assert rewards.tolist() == their_rewards.tolist()
        assert over.tolist() == their_over.tolist()
        for info, other in zip(infos, their_infos, strict=True):
            assert set(info) - {"episode"} == set(other)
            assert info["TimeLimit.truncated"] == other["TimeLimit.truncated"]
            assert info["reward"] == other["reward"]
        for number in np.flatnonzero(over).tolist():
            last, their_last = (each[number]["terminal_observation"] for each in (infos, their_infos))
            assert all(np.array_equal(last[name], their_last[name]) for name in their_last)
            assert infos[number]["episode"]["l"] == STEPS_PER_EPISODE
            ends += 1
    assert ends == 4
    assert ours.get_attr("seed") == theirs.get_attr("seed")
    ours.close()
    theirs.close()


def test_single_worlds_take_calls_and_options(settings: dict[str, Any]) -> None:
    worlds = make_vec_env(NAME, 3, seed=3, **settings)
    assert worlds.env_method("vary_by", {"people": 0}, indices=[0, 2]) == [None, None]
    worlds.reset()
    assert [len(info["truth"].people) for info in worlds.unwrapped.reset_infos] == [0, 1, 0]
    worlds.set_options({"people": 0})
    worlds.reset()
    assert [len(info["truth"].people) for info in worlds.unwrapped.reset_infos] == [0, 0, 0]
    worlds.set_options([{"people": 0}, {}, {}])
    with pytest.raises(BadInput, match="the same for all worlds"):
        worlds.reset()
    worlds.close()


def test_another_autoreset_mode_is_refused(settings: dict[str, Any]) -> None:
    worlds = gymnasium.make_vec(NAME, 2, vectorization_mode="vector_entry_point", **settings)
    assert worlds.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    with pytest.raises(BadInput, match=r"needs autoreset_mode=AutoresetMode\.SAME_STEP"):
        PeopleBoyVecEnv(worlds)
    worlds.close()


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", ["PPO", "SAC"])
def test_algorithms_learn_on_truth(algorithm: str, settings: dict[str, Any]) -> None:
    worlds = make_vec_env(NAME, 4, **settings)
    model = getattr(stable_baselines3, algorithm)("MultiInputPolicy", worlds, seed=0, device="cpu",
        **({"n_steps": 16, "batch_size": 32} if algorithm == "PPO" else {"learning_starts": 32}))  # fmt: skip
    model.learn(128)
    assert model.num_timesteps == 128
    assert model.ep_info_buffer[-1]["l"] == STEPS_PER_EPISODE
    worlds.close()


@pytest.mark.slow
def test_ppo_learns_on_stacked_images(settings: dict[str, Any]) -> None:
    images = {"observation": "pixels", "image_size": (64, 48), "cameras": ("thermal",)}
    worlds = VecFrameStack(make_vec_env(NAME, 4, **(settings | images)), 2)
    model = stable_baselines3.PPO("MultiInputPolicy", worlds, n_steps=16, batch_size=32, seed=0, device="cpu")
    model.learn(64)
    assert model.observation_space["thermal"].shape == (2, 48, 64)
    worlds.close()
