"""The vector environment as a `VecEnv` of stable-baselines3, for PPO, SAC and its other algorithms.

from peopleboy.sb3 import make_vec_env
worlds = make_vec_env("peopleboy/PersonFollowing-v0", 16, observation="truth", physics="kinematic")
"""

from collections.abc import Iterable
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.observations import Arrays
from peopleboy.scenarios.environments.vector_environment import Infos, PeopleBoyVectorEnv

try:
    from stable_baselines3.common.vec_env import VecEnv, VecMonitor
except ImportError as error:
    raise ImportError("peopleboy.sb3 needs stable-baselines3: pip install 'peopleboy[rl]'") from error

Indices = int | Iterable[int] | None


class PeopleBoyVecEnv(VecEnv):
    """Many worlds in one process, in the form that stable-baselines3 asks for.

    Each info of a world has what `PeopleBoyEnv` gives, and `TimeLimit.truncated`; the last one of an episode
    also has `terminal_observation` and `metrics`. `seed` and `set_options` apply to the next `reset`.
    `env_method` and `get_attr` work on the single environments, for example `env_method("vary_by", {...})`
    and `get_attr("seed")`; do not call their `reset` and `step`.

    Args:
        worlds: vector environment, made with `autoreset_mode=AutoresetMode.SAME_STEP`; possibly in
            gymnasium's vector wrappers.

    Raises:
        BadInput: it is another environment, or has another autoreset mode.
    """

    def __init__(self, worlds: VectorEnv[Any, Any, Any]) -> None:
        own = worlds.unwrapped
        if not isinstance(own, PeopleBoyVectorEnv):
            raise BadInput(f"worlds {worlds!r} must be a PeopleBoyVectorEnv, or a wrapper of one")
        if own.metadata["autoreset_mode"] is not AutoresetMode.SAME_STEP:
            raise BadInput(
                "worlds: stable-baselines3 needs autoreset_mode=AutoresetMode.SAME_STEP; "
                f"got {own.metadata['autoreset_mode']}"
            )
        self._worlds, self._envs = worlds, own.envs
        self._actions: NDArray[Any] = np.zeros((0, 2))
        super().__init__(worlds.num_envs, worlds.single_observation_space, worlds.single_action_space)

    def reset(self) -> Arrays:
        """Begin an episode in every world, and return the observations.

        Raises:
            BadInput: an option is invalid, or the options of the worlds differ.
        """
        options = self._options[0]
        if any(other != options for other in self._options):
            raise BadInput("options: must be the same for all worlds; pass one mapping to set_options")
        seeds: Any = None if self._seeds[0] is None else list(self._seeds)
        observation, infos = self._worlds.reset(seed=seeds, options=options or None)
        self.reset_infos = split_infos(infos, self.num_envs)
        self._reset_seeds()
        self._reset_options()
        return dict(observation)

    def step_async(self, actions: NDArray[Any]) -> None:
        """Store the actions (B, 2) for `step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[Arrays, NDArray[np.float32], NDArray[np.bool_], list[Infos]]:
        """Drive every robot for one step; return observations, rewards, ends of episodes, and infos."""
        observation, rewards, terminations, truncations, infos = self._worlds.step(self._actions)
        over = terminations | truncations
        last, final = infos.pop("final_obs", None), infos.pop("final_info", {})
        rows = split_infos(infos, self.num_envs)
        for number in np.flatnonzero(over).tolist():
            self.reset_infos[number] = rows[number]
            rows[number] = _row(final, number) | {"terminal_observation": last[number]}
        for row, terminated, truncated in zip(rows, terminations, truncations, strict=True):
            row["TimeLimit.truncated"] = bool(truncated and not terminated)
        return dict(observation), rewards.astype(np.float32), over, rows

    def close(self) -> None:
        """Free all worlds."""
        self._worlds.close()

    def get_images(self) -> list[NDArray[np.uint8] | None]:
        """Return a picture of each world for videos; `render_mode` must be "rgb_array"."""
        return [env.render() for env in self._envs]

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """Return an attribute of some of the single environments."""
        return [getattr(env, attr_name) for env in self._chosen(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:
        """Set an attribute of some of the single environments."""
        for env in self._chosen(indices):
            setattr(env, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: Indices = None, **method_kwargs: Any
    ) -> list[Any]:
        """Call a method of some of the single environments."""
        return [getattr(env, method_name)(*method_args, **method_kwargs) for env in self._chosen(indices)]

    def env_is_wrapped(
        self, wrapper_class: type[gymnasium.Wrapper[Any, Any, Any, Any]], indices: Indices = None
    ) -> list[bool]:
        """Return False for each environment: wrappers are around all worlds together."""
        del wrapper_class
        return [False for _ in self._chosen(indices)]

    def _chosen(self, indices: Indices) -> list[PeopleBoyEnv]:
        return [self._envs[number] for number in self._get_indices(indices)]


def make_vec_env(env_id: str, num_envs: int = 16, *, seed: int | None = None, **settings: Any) -> VecMonitor:
    """Return a `VecEnv` of one of PeopleBoy's environments, with the statistics that algorithms print.

    Args:
        env_id: name of the environment, such as "peopleboy/PersonFollowing-v0".
        num_envs: number of worlds.
        seed: seed of world 0 at the first reset, with consecutive seeds for the others; algorithms with a
            seed replace it by theirs.
        settings: arguments of `PeopleBoyVectorEnv`, and `max_episode_steps`.

    Raises:
        BadInput: an argument is invalid.
    """
    worlds = PeopleBoyVecEnv(
        gymnasium.make_vec(
            env_id,
            num_envs=num_envs,
            vectorization_mode="vector_entry_point",
            autoreset_mode=AutoresetMode.SAME_STEP,
            **settings,
        )
    )
    if seed is not None:
        worlds.seed(seed)
    return VecMonitor(worlds)


def split_infos(infos: Infos, count: int) -> list[Infos]:
    """Return the infos of each of `count` environments; the inverse of `join_infos`."""
    return [_row(infos, number) for number in range(count)]


def _row(infos: Infos, number: int) -> Infos:
    found = {}
    for key, values in infos.items():
        if f"_{key}" not in infos or not infos[f"_{key}"][number]:
            continue
        if isinstance(values, dict):
            found[key] = _row(values, number)
        else:
            found[key] = values[number].item() if values.dtype != object else values[number]
    return found
