import numpy as np
import pytest

from peopleboy.behaviours.behaviour import Command
from peopleboy.behaviours.percept import Percept
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.written_controller import WrittenController
from peopleboy.scenarios.files.load import load_scenario


class Echo:
    """Keeps what it is told, and asks for more than the robot can do."""

    mode, reason, following = "echo", "", None

    def __init__(self) -> None:
        self.told: list[Percept] = []

    def command(self, percept: Percept) -> Command:
        self.told.append(percept)
        return Command(linear_m_s=0.4, angular_rad_s=-99.0)


def test_a_behaviour_is_told_the_tracks_in_its_own_words_and_its_command_becomes_shares() -> None:
    tracks = np.zeros(35, np.float32)
    tracks[:7] = (3, -0.25, 0.5, 0.25, 0.75, 0.9, 0)
    observation = {
        "tracks": tracks,
        "sonar": np.linspace(0.5, 5.0, 16, dtype=np.float32),
        "odometry": np.array([1, 2, 1, 0, 0.3, -0.1], np.float32),
    }
    echo = Echo()
    controller = WrittenController(echo)
    np.testing.assert_allclose(controller(observation), [0.5, -1.0])
    controller(observation)
    (first, second) = echo.told
    (person,) = first.people
    assert (person.id, person.x, person.height, person.is_visible) == (3, -0.25, 0.5, False)
    assert (first.linear_m_s, first.angular_rad_s) == (pytest.approx(0.3), pytest.approx(-0.1))
    assert second.time_s - first.time_s == pytest.approx(1 / 15)


@pytest.mark.slow
def test_the_written_follower_finds_and_follows_in_an_environment() -> None:
    env = PeopleBoyEnv("single_follow", observation="truth")
    controller = WrittenController(load_scenario("single_follow").make_behaviour())
    observation, _ = env.reset(seed=0)
    for _ in range(20 * 15):
        observation, _, terminated, *_ = env.step(controller(observation))
        assert not terminated
    figures = env.metrics()["following"]
    assert figures["found"]
    assert figures["followed"] > 0.9
    assert figures["in_band"] > 0.7
    env.close()
