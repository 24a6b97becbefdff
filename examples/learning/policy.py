"""Policies of a few kB that PPO has learned: two small layers, in NumPy alone, as behaviours.

    peopleboy run single_follow --behaviour examples.learning.policy:PersonFollower
    peopleboy run corridor_straight --behaviour examples.learning.policy:CorridorDriver

Train your own with `python -m examples.learning.ppo`, and derive a class with another `file`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.behaviours.percept import Percept, SeenPerson
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.environments.observations import COLUMNS, MOST_TRACKS, Arrays, Normaliser
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.tracker.networks.weights_archive import open_archive

SETTINGS: Final[dict[str, Any]] = {"physics": "kinematic", "physics_hz": 60, "normalise": True}
"""Settings of the environments in which policies are trained."""

LAYERS: Final = ("mlp_extractor.policy_net.0", "mlp_extractor.policy_net.2", "action_net")
"""Names of the layers in stable-baselines3's state dict; tanh follows each but the last."""


def save_policy(file: Path, state: Mapping[str, Any]) -> None:
    """Save the layers of a trained policy as float16 arrays."""
    arrays = {
        f"{kind}{number}": state[f"{layer}.{kind}"].numpy().astype(np.float16)
        for number, layer in enumerate(LAYERS)
        for kind in ("weight", "bias")
    }
    np.savez_compressed(file, **arrays)


class Policy:
    """A policy that maps normalised observations to actions.

    Args:
        file: weights from `save_policy`.
    """

    def __init__(self, file: Path) -> None:
        with open_archive(file, "python -m examples.learning.ppo") as arrays:
            self._layers = [
                (arrays[f"weight{number}"].astype(np.float64), arrays[f"bias{number}"].astype(np.float64))
                for number in range(len(LAYERS))
            ]

    def __call__(self, observation: Arrays) -> NDArray[np.float32]:
        """Return the action (2,) for one observation, or (B, 2) for B of them."""
        values = np.concatenate([observation[name] for name in sorted(observation)], axis=-1)
        values = values.astype(np.float64)
        for number, (weight, bias) in enumerate(self._layers):
            values = values @ weight.T + bias
            if number < len(self._layers) - 1:
                values = np.tanh(values)
        return np.clip(values, -1.0, 1.0).astype(np.float32)


class LearnedBehaviour:
    """A policy that was trained on `truth` or `tracks`, as a behaviour; it has no person of its own."""

    file: Path
    mode = "policy"
    reason = ""
    following = None

    def __init__(self) -> None:
        robot = RobotConfig()
        self._policy, self._scale, self._limits = Policy(self.file), Normaliser(robot), robot.drive.limits
        self._holders = np.zeros((1, MOST_TRACKS))
        self._start: Pose2 | None = None

    def command(self, percept: Percept) -> Command:
        """Return the policy's command; stop on invalid input."""
        if not percept.is_sound:
            return STOP
        if self._start is None:
            self._start = percept.odometry
        observed = observe(percept, self._start)
        batch = self._scale({name: array[None] for name, array in observed.items()}, self._holders)
        ahead, turn = (self._policy(batch)[0] * self._limits).tolist()
        return Command(linear_m_s=ahead, angular_rad_s=turn)


class PersonFollower(LearnedBehaviour):
    """Person following, learned on `truth` in `single_follow`."""

    file = Path(__file__).with_name("person_policy.npz")


class CorridorDriver(LearnedBehaviour):
    """Corridor following, learned on `truth` in `corridor_straight`."""

    file = Path(__file__).with_name("corridor_policy.npz")


def observe(percept: Percept, start: Pose2) -> Arrays:
    """Return a percept as an environment's observation `tracks`, see `observation_space` there.

    Args:
        percept: input of the behaviour.
        start: pose by odometry at the start.
    """
    here = percept.odometry.relative_to(start)
    tallest = sorted(filter(_is_in_view, percept.people), key=lambda one: -one.height)[:MOST_TRACKS]
    tracks = np.zeros((MOST_TRACKS, len(COLUMNS)), np.float32)
    for row, person in enumerate(tallest):
        tracks[row] = [getattr(person, name) for name in COLUMNS]
    pose = (here.x, here.y, math.cos(here.heading), math.sin(here.heading))
    return {
        "sonar": percept.sonar_m.astype(np.float32),
        "odometry": np.array([*pose, percept.linear_m_s, percept.angular_rad_s], np.float32),
        "tracks": tracks.reshape(-1),
    }


def _is_in_view(person: SeenPerson) -> bool:
    return person.is_sound and abs(person.x) <= 1.0
