"""Policies that PPO has learned drive a run as they drove their environments."""

import math
from dataclasses import replace

import numpy as np
import pytest

from examples.learning.policy import SETTINGS, CorridorDriver, PersonFollower, Policy
from peopleboy.behaviours.behaviour import STOP
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.written_controller import WrittenController
from tests.helpers.percepts.percepts import percept

LEARNED = [(PersonFollower, "single_follow", "follow"), (CorridorDriver, "corridor_straight", "corridor")]


@pytest.mark.parametrize(("behaviour", "scenario", "task"), LEARNED)
def test_a_policy_gives_the_same_commands_as_a_behaviour_and_in_its_environment(
    behaviour, scenario, task
) -> None:
    scaled = PeopleBoyEnv(scenario, task=task, observation="truth", **SETTINGS)
    raw = PeopleBoyEnv(scenario, task=task, observation="truth", **SETTINGS | {"normalise": False})
    policy, controller = Policy(behaviour.file), WrittenController(behaviour())
    seen, plain = scaled.reset(seed=0)[0], raw.reset(seed=0)[0]
    for _ in range(40):
        action = policy(seen)
        np.testing.assert_allclose(controller(plain), action, atol=1e-3)
        seen, plain = scaled.step(action)[0], raw.step(action)[0]


@pytest.mark.slow
@pytest.mark.parametrize(("behaviour", "scenario", "task"), LEARNED)
def test_a_shipped_policy_has_learned_its_task_for_unseen_worlds(behaviour, scenario, task) -> None:
    env = PeopleBoyEnv(scenario, task=task, observation="truth", max_episode_steps=450, **SETTINGS)
    policy = Policy(behaviour.file)
    observation, earned = env.reset(seed=12345)[0], 0.0
    for _ in range(450):
        observation, reward, is_over, *_ = env.step(policy(observation))
        earned += float(reward)
        assert not is_over
    assert earned > 20.0  # of at most 30


@pytest.mark.parametrize("behaviour", [PersonFollower, CorridorDriver])
def test_a_policy_is_small_loads_without_pickle_and_stops_on_invalid_input(behaviour) -> None:
    assert behaviour.file.stat().st_size < 10_000
    with np.load(behaviour.file, allow_pickle=False) as weights:
        assert all(array.dtype == np.float16 for array in weights.values())
    assert behaviour().command(replace(percept(1.0), linear_m_s=math.nan)) == STOP
