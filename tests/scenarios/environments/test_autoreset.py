from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import vector as wrappers

import peopleboy  # noqa: F401  # registers the environments

NAME = "peopleboy/PersonFollowing-v0"
SHORT = "name: short\ndescription: So short that it ends.\nlike: single_follow\nduration_s: 0.4\n"
STEPS_PER_EPISODE = 6


@pytest.fixture
def settings(tmp_path: Path) -> dict[str, Any]:
    path = tmp_path / "short.yaml"
    path.write_text(SHORT, encoding="utf-8")
    return {"num_envs": 2, "scenario": path, "observation": "truth", "physics": "kinematic"}


def make_worlds(settings: dict[str, Any], **more: Any) -> gymnasium.vector.VectorEnv[Any, Any, Any]:
    return gymnasium.make_vec(NAME, vectorization_mode="vector_entry_point", **settings, **more)


def assert_equal(ours: dict[str, Any], theirs: dict[str, Any]) -> None:
    assert set(ours) == set(theirs)
    for key, one in ours.items():
        if isinstance(one, dict):
            assert_equal(one, theirs[key])
        elif key == "final_obs":
            for mine, other in zip(one, theirs[key], strict=True):
                assert (mine is None) == (other is None)
                assert mine is None or all(mine[name].tobytes() == other[name].tobytes() for name in mine)
        else:
            assert one.dtype == theirs[key].dtype
            assert repr(one.tolist()) == repr(theirs[key].tolist())  # NaN differs from NaN


def test_same_step_returns_what_gymnasium_returns_for_single_environments(settings: dict[str, Any]) -> None:
    ours = make_worlds(settings, autoreset_mode=AutoresetMode.SAME_STEP)
    kwargs = {"autoreset_mode": AutoresetMode.SAME_STEP}
    theirs = gymnasium.make_vec(NAME, vectorization_mode="sync", vector_kwargs=kwargs, **settings)
    assert_equal(ours.reset(seed=3)[1], theirs.reset(seed=3)[1])
    ends = 0
    for actions in np.random.default_rng(0).uniform(-1.0, 1.0, (2 * STEPS_PER_EPISODE + 2, 2, 2)):
        found, *results, infos = ours.step(actions.astype(np.float32))
        expected, *others, their_infos = theirs.step(actions.astype(np.float32))
        assert all(found[name].tobytes() == expected[name].tobytes() for name in expected)
        assert all(np.array_equal(one, other) for one, other in zip(results, others, strict=True))
        assert_equal(infos, their_infos)
        ends += int((results[1] | results[2]).sum())
    assert ends == 4
    ours.close()
    theirs.close()


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_gymnasiums_vector_wrappers_take_it(mode: AutoresetMode, settings: dict[str, Any]) -> None:
    worlds = wrappers.RecordEpisodeStatistics(make_worlds(settings, autoreset_mode=mode))
    worlds = wrappers.ClipAction(wrappers.NormalizeReward(wrappers.DictInfoToList(worlds)))
    worlds.reset(seed=3)
    for _ in range(STEPS_PER_EPISODE):
        *_, infos = worlds.step(np.zeros((2, 2), np.float32))
    last = infos if mode is AutoresetMode.NEXT_STEP else [info.get("final_info", info) for info in infos]
    assert ["metrics" in info for info in last] == [True, True]
    worlds.close()
