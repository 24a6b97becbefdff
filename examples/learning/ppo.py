"""Train a policy with PPO on one observation, measure its learning curve, and keep the best policy.

    make rl                                         # stable-baselines3, with a CPU build of torch
    python -m examples.learning.ppo person truth    # a minute of one core
    python -m examples.learning.ppo corridor pixels --steps 60000 --seed 1

Training uses worlds of new seeds. From time to time the policy is evaluated in the same worlds of other
seeds, and the best one is kept; at the end it is tested in worlds of still other seeds. The curve is written
as CSV, the test as JSON, and the policy of `truth` and `tracks` as plain arrays (.npz), which load without
pickle and without torch; see `examples.learning.policy`.
"""

from __future__ import annotations

import copy
import csv
import json
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import click
import numpy as np
import torch
from rich.console import Console
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv, VecFrameStack

from examples.learning.policy import SETTINGS, save_policy
from peopleboy.sb3 import make_vec_env

TASKS: Final = {
    "person": "peopleboy/PersonFollowing-v0",
    "corridor": "peopleboy/CorridorFollowing-v0",
    "goal": "peopleboy/GoTo-v0",
}
VALIDATION_SEED, TEST_SEED = 2**31, 2**31 + 1000  # training samples its seeds below 2**31
EPISODE_STEPS: Final = 450  # 30 s
OBSERVATIONS: Final[dict[str, dict[str, Any]]] = {
    "truth": {"observation": "truth"},
    "tracks": {"observation": "tracks"},
    "pixels": {"observation": "pixels", "cameras": ("thermal",), "image_size": (64, 48)},
}
STACKED_IMAGES: Final = 2  # show motion


@dataclass(frozen=True, slots=True, kw_only=True)
class CurvePoint:
    """Evaluation of a policy.

    Attributes:
        steps: steps of training so far, in all worlds.
        train_cpu_s: [s] CPU time of the training so far, without evaluations.
        reward, low, high: mean reward of an episode, and its 95 % interval over the worlds.
        collided, lost, reached: share of the episodes that end so.
    """

    steps: int
    train_cpu_s: float
    reward: float
    low: float
    high: float
    collided: float
    lost: float
    reached: float

    def __str__(self) -> str:
        """Return the numbers on one line."""
        return (
            f"{self.steps} steps, {self.train_cpu_s:.0f} s of CPU time: reward {self.reward:.1f} "
            f"[{self.low:.1f}, {self.high:.1f}], collided {self.collided:.0%}, lost {self.lost:.0%}, "
            f"reached {self.reached:.0%}"
        )


def make_worlds(task: str, observation: str, count: int) -> VecEnv:
    """Return worlds for training or evaluation."""
    settings = SETTINGS | OBSERVATIONS[observation]
    worlds = make_vec_env(TASKS[task], count, max_episode_steps=EPISODE_STEPS, **settings)
    return VecFrameStack(worlds, STACKED_IMAGES) if observation == "pixels" else worlds


def make_model(worlds: VecEnv, seed: int) -> PPO:
    """Return a PPO model with a policy of two small layers, on the CPU."""
    return PPO(
        "MultiInputPolicy", worlds, n_steps=128, batch_size=512, n_epochs=6, gamma=0.98, gae_lambda=0.95,
        learning_rate=5e-4, ent_coef=0.002, seed=seed, device="cpu",
        policy_kwargs={
            "net_arch": [32, 32], "log_std_init": -0.7, "features_extractor_kwargs": {"cnn_output_dim": 64},
        },
    )  # fmt: skip


def evaluate(model: PPO, worlds: VecEnv, first_seed: int) -> dict[str, float]:
    """Run one episode in each of the worlds of consecutive seeds; return means over the episodes."""
    worlds.seed(first_seed)
    observation = worlds.reset()
    ends: dict[int, dict[str, Any]] = {}
    while len(ends) < worlds.num_envs:
        action, _ = model.predict(observation, deterministic=True)
        observation, _, over, infos = worlds.step(action)
        for number in np.flatnonzero(over).tolist():
            ends.setdefault(number, infos[number])
    rewards = np.array([info["episode"]["r"] for info in ends.values()])
    half = 1.96 * rewards.std(ddof=1) / np.sqrt(len(rewards))
    shares = {
        name: float(np.mean([info["reward"][term] != 0.0 for info in ends.values()]))
        for name, term in (("collided", "collision"), ("lost", "lost"), ("reached", "arrival"))
    }
    mean = float(rewards.mean())
    return {"reward": mean, "low": mean - half, "high": mean + half, **shares}


class Curve(BaseCallback):
    """Callback that evaluates the policy from time to time, and keeps the best one.

    Attributes:
        best: the evaluation with the highest reward.
        state: parameters of the policy at that time.
    """

    def __init__(self, worlds: VecEnv, every: int, file: Path) -> None:
        super().__init__()
        self._worlds, self._every, self._file = worlds, every, file
        self._points: list[CurvePoint] = []
        self._evaluation_s = 0.0
        self.best: CurvePoint | None = None
        self.state: dict[str, Any] = {}

    def _on_training_start(self) -> None:
        self._began_s = time.process_time()

    def _on_step(self) -> bool:
        return True

    def _on_rollout_start(self) -> None:
        if self.num_timesteps >= self._every * len(self._points):
            self._measure()

    def _on_training_end(self) -> None:
        self._measure()

    def _measure(self) -> None:
        began_s = time.process_time()
        trained_s = began_s - self._began_s - self._evaluation_s
        means = evaluate(self.model, self._worlds, VALIDATION_SEED)
        self._evaluation_s += time.process_time() - began_s
        point = CurvePoint(steps=self.num_timesteps, train_cpu_s=round(trained_s, 1), **means)
        self._points.append(point)
        write_curve(self._file, self._points)
        if self.best is None or point.reward > self.best.reward:
            self.best, self.state = point, copy.deepcopy(self.model.policy.state_dict())
        Console().print(str(point), soft_wrap=True)


def write_curve(file: Path, points: Sequence[CurvePoint]) -> None:
    """Write a learning curve as CSV."""
    rows = [asdict(point) for point in points]
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


@click.command()
@click.argument("task", type=click.Choice(list(TASKS)))
@click.argument("observation", type=click.Choice(list(OBSERVATIONS)))
@click.option(
    "--steps", type=click.IntRange(min=1), default=100_000, show_default=True, help="Training steps."
)
@click.option(
    "--every",
    type=click.IntRange(min=1),
    default=10_000,
    show_default=True,
    help="Steps between evaluations.",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the training."
)
@click.option(
    "--worlds", type=click.IntRange(min=1), default=16, show_default=True, help="Worlds in training."
)
@click.option(
    "--unseen",
    type=click.IntRange(min=2),
    default=20,
    show_default=True,
    help="Worlds in evaluation, and in the test.",
)
@click.option(
    "--out", type=click.Path(path_type=Path), default="runs/ppo", show_default=True, help="Output folder."
)
def main(
    task: str, observation: str, steps: int, every: int, seed: int, worlds: int, unseen: int, out: Path
) -> None:
    """Train a policy for a TASK on one OBSERVATION."""
    torch.set_num_threads(1)
    out.mkdir(parents=True, exist_ok=True)
    file = out / f"{task}-{observation}-{seed}"
    others, own = (make_worlds(task, observation, count) for count in (unseen, worlds))
    model = make_model(own, seed)
    curve = Curve(others, every, file.with_suffix(".csv"))
    model.learn(steps, callback=curve)
    assert curve.best is not None
    model.policy.load_state_dict(curve.state)
    if observation != "pixels":
        save_policy(file.with_suffix(".npz"), curve.state)
    tested = CurvePoint(
        steps=curve.best.steps, train_cpu_s=curve.best.train_cpu_s, **evaluate(model, others, TEST_SEED)
    )
    file.with_suffix(".json").write_text(json.dumps(asdict(tested), indent=1) + "\n", encoding="utf-8")
    Console().print(f"best policy, on unseen seeds: {tested}", soft_wrap=True)
    own.close()
    others.close()


if __name__ == "__main__":
    main()
