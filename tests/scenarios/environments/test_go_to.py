import gymnasium
import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.written_controller import WrittenController
from peopleboy.scenarios.files.load import load_scenario

FAST = {"observation": "truth", "physics": "kinematic"}


def test_goal_points_from_the_robot_to_the_goal_also_when_it_has_turned() -> None:
    env = gymnasium.make("peopleboy/GoTo-v0", **FAST)
    observation, _ = env.reset(seed=0)
    spec = load_scenario("go_to_foyer").robot
    np.testing.assert_allclose(
        observation["goal"][0], np.hypot(*np.subtract(spec.goal_m, spec.at_m)), rtol=1e-5
    )
    for _ in range(30):
        observation, *_, info = env.step(np.array([0.5, 0.3], np.float32))
    robot = info["truth"].robot
    x, y = robot.to_local(spec.goal_m)
    distance, cosine, sine = observation["goal"].tolist()
    assert (distance * cosine, distance * sine) == pytest.approx((x, y), abs=0.2)  # odometry has errors
    assert env.observation_space.contains(observation)


def test_the_reward_of_the_way_is_the_distance_gained_and_arrival_ends_the_episode() -> None:
    env = PeopleBoyEnv("go_to_foyer", task="go_to", normalise=False, **FAST)
    controller = WrittenController(load_scenario("go_to_foyer").make_behaviour())
    observation, info = env.reset(seed=1)
    goal_m = load_scenario("go_to_foyer").robot.goal_m
    starts, gained, is_over = (
        np.hypot(*np.subtract(goal_m, (info["truth"].robot.x, info["truth"].robot.y))),
        0.0,
        False,
    )
    while not is_over:
        observation, _, is_over, is_cut, info = env.step(controller(observation))
        gained += info["reward"]["approach"]
        assert not is_cut
    ends = np.hypot(*np.subtract(goal_m, (info["truth"].robot.x, info["truth"].robot.y)))
    assert gained == pytest.approx((starts - ends) / 0.8)
    assert info["reward"]["arrival"] == 10.0
    scores = info["metrics"]
    assert scores["goal"]["reached"]
    assert 0.7 < scores["goal"]["spl"] <= 1.0
    assert scores["goal"]["time_s"] < 40.0
    assert scores["goal"]["contacts"] == 0
    assert scores["comfort"]["intimate_s"] == 0.0


def test_a_scenario_without_a_goal_is_refused() -> None:
    with pytest.raises(BadInput, match=r"'single_follow' has no goal; give it robot\.goal_m"):
        PeopleBoyEnv("single_follow", task="go_to")
