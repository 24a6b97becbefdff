"""Train a follower with PPO, and compare it with the scripted one.

Training uses `truth` observations, which are ten times faster, in worlds of new seeds. Both followers are
then evaluated on `tracks`, the tracker's output, in 20 worlds that were not used for training. Weights are
saved after every round as plain arrays (.npz), which load without pickle, so that you may interrupt training.

    make rl                                            # stable-baselines3, with a CPU build of torch
    python -m examples.train_follower --steps 100000   # learns, then compares
    python -m examples.train_follower --steps 0        # compares what was learned before
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np
import torch
from rich.console import Console
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.env_util import make_vec_env

from examples.follower_view import FollowerView
from examples.show import Controller, Figures, play, print_figures
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.written_controller import WrittenController
from peopleboy.scenarios.files.load import load_scenario

FIRST_SEED = 1000  # of the worlds for evaluation
PHYSICS_HZ = 60  # a quarter of a run's; the path deviates by millimetres


def quick(scenario: str | Path, observation: str) -> PeopleBoyEnv:
    """Return an environment with fast physics."""
    return PeopleBoyEnv(scenario, observation=observation, physics_hz=PHYSICS_HZ)


class Keep(BaseCallback):
    """Callback that saves the weights after every round, and prints the mean reward per episode."""

    def __init__(self, out: Path) -> None:
        super().__init__()
        self._out = out

    def _on_step(self) -> bool:
        return True

    def _on_rollout_start(self) -> None:
        np.savez(self._out, **{name: value.numpy() for name, value in self.model.policy.state_dict().items()})
        earned = [episode["r"] for episode in self.model.ep_info_buffer or ()]
        if earned:
            Console().print(f"{self.num_timesteps} decisions: mean reward per episode {np.mean(earned):.1f}")

    _on_training_end = _on_rollout_start


def make_model(env: Any) -> PPO:
    """Return a PPO model with a policy of two small layers, on the CPU."""
    return PPO(
        "MlpPolicy", env, n_steps=512, batch_size=256, n_epochs=4, gamma=0.98, gae_lambda=0.95,
        learning_rate=4e-4, ent_coef=0.002, seed=0, device="cpu",
        policy_kwargs={"net_arch": [64, 64], "log_std_init": -0.7},
    )  # fmt: skip


def train(scenario: str, steps: int, out: Path) -> None:
    """Train on the ground truth for about `steps` decisions, and save the policy's weights by name."""
    torch.set_num_threads(1)
    worlds = make_vec_env(lambda: FollowerView(quick(scenario, "truth")), n_envs=4, seed=0)
    make_model(worlds).learn(steps, callback=Keep(out))
    worlds.close()


def load_policy(env: FollowerView, file: Path) -> Controller:
    """Load a controller from weights, without pickle."""
    policy = make_model(env).policy
    with np.load(file, allow_pickle=False) as weights:
        policy.load_state_dict({name: torch.as_tensor(weights[name]) for name in weights})
    return lambda seen: policy.predict(seen, deterministic=True)[0]


def compare(scenario: str, eyes: str, file: Path, seeds: Sequence[int]) -> dict[str, list[Figures]]:
    """Run the learned policy and the scenario's behaviour in the same worlds."""
    env, loaded = quick(scenario, eyes), load_scenario(scenario)
    view = FollowerView(env)
    policy = load_policy(view, file)
    learned = [play(view, policy, seed) for seed in seeds]
    written = [play(env, WrittenController(loaded.make_behaviour()), seed) for seed in seeds]
    env.close()
    return {"learned": learned, "written": written}


@click.command()
@click.argument("scenario", default="single_follow")
@click.option(
    "--steps",
    type=click.IntRange(min=0),
    default=100_000,
    show_default=True,
    help="Training decisions; 0 only compares.",
)
@click.option("--seeds", type=click.IntRange(min=1), default=20, show_default=True, help="Number of worlds.")
@click.option("--eyes", type=click.Choice(["tracks", "truth"]), default="tracks", help="Observation.")
@click.option("--out", type=click.Path(path_type=Path), default="runs/follower.npz", help="File of weights.")
def main(scenario: str, steps: int, seeds: int, eyes: str, out: Path) -> None:
    """Train a follower, and compare it with the scripted one."""
    if steps:
        out.parent.mkdir(parents=True, exist_ok=True)
        train(scenario, steps, out)
    elif not out.is_file():
        raise click.UsageError(f"{out}: file not found; train first, with --steps 100000")
    runs = compare(scenario, eyes, out, range(FIRST_SEED, FIRST_SEED + seeds))
    console = Console(width=110)
    print_figures(f"{scenario}, on {eyes}, {seeds} seeds: mean [95 % interval]", runs, console)


if __name__ == "__main__":
    main()
