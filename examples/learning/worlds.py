"""Worlds for training and evaluating followers, and one training episode."""

from __future__ import annotations

from functools import cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from examples.learning.follower import LearnedFollower, Weights
from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.behaviours.safety_guard import Guarded
from peopleboy.random_streams import stream
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.written_controller import WrittenController

LEARNED_ON: Final = ("single_follow", "follow_passers_by", "follow_occluded", "follow_round_corner")
NEVER_SEEN: Final = ("leads_robot", "reacts_ignores", "follow_at_distance", "waits_for_robot")
"""Scenarios that are not used for training."""

_STEPS: Final = 675  # per episode: 45 s
_HEIGHT, _X = 0.04, 0.02  # standard deviations of a tracker's relative height and column errors
_KEPT = 0.8  # autocorrelation of an error from one image to the next
_OVERLOOKED = 0.02  # probability that a person is missed in an image


def earn(weights: Weights | None, scenario: str, seed: int) -> float:
    """Return the reward of an episode on noisy `truth`; None is the scripted follower."""
    env = _world(scenario)
    behaviour = make_behaviour("follow_person") if weights is None else Guarded(LearnedFollower(weights))
    control, eyes = WrittenController(behaviour), Unsure(seed)
    observation, _ = env.reset(seed=seed)
    earned = 0.0
    for _ in range(_STEPS):
        observation, reward, terminated, truncated, _ = env.step(control(eyes(observation)))
        earned += float(reward)
        if terminated or truncated:
            break
    return earned


@cache
def _world(scenario: str) -> PeopleBoyEnv:
    return PeopleBoyEnv(scenario, observation="truth", physics="kinematic", physics_hz=15)


class Unsure:
    """Noise on the ground truth, similar to a tracker's errors, so that training is robust to them."""

    def __init__(self, seed: int) -> None:
        self._rng = stream(seed, "examples.learning.unsure")
        self._off = np.zeros((5, 2))

    def __call__(self, observation: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
        """Return the observation with correlated errors of columns and heights, and missed people."""
        rows = observation["tracks"].reshape(5, 7).copy()
        fresh = self._rng.normal(size=(5, 2)) * (_X, _HEIGHT)
        self._off = _KEPT * self._off + np.sqrt(1.0 - _KEPT**2) * fresh
        is_there = rows[:, 0] > 0
        rows[:, 1] += is_there * self._off[:, 0]
        rows[:, 2] *= np.exp(self._off[:, 1])
        rows[self._rng.random(5) < _OVERLOOKED, 6] = 0.0
        return observation | {"tracks": rows.reshape(-1)}
