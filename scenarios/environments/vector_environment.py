"""Many environments in one process, as one of gymnasium's vector environments."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, SupportsFloat

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.environments.environment import PeopleBoyEnv, check_actions
from peopleboy.scenarios.environments.join_infos import Infos, join_infos
from peopleboy.scenarios.environments.observations import Arrays
from peopleboy.sim.fleet.crew import Crew
from peopleboy.sim.fleet.together import Together

Flags = NDArray[np.bool_]
Result = tuple[SupportsFloat, bool, bool, dict[str, Any]]  # of a single environment's step


class PeopleBoyVectorEnv(VectorEnv[Arrays, NDArray[np.float32], NDArray[Any]]):
    """B worlds, each with a robot of its own, stepped together.

    Actions are (B, 2); an observation has the arrays of `PeopleBoyEnv` with B before their shape, such as
    `thermal` (B, H, W, 1), each of its own and never written again. Kinematic worlds go through kernels
    together, see `peopleboy.sim.fleet.fleet.Fleet`. World i gives to the byte what a single
    environment with its seed and actions gives. The step after an episode's end begins the next episode in
    that world, whatever its action, with reward 0 (`AutoresetMode.NEXT_STEP`); `infos` has the arrays that
    gymnasium makes of B infos.

    Args:
        num_envs: B.
        threads: that draw images; None for as many as there are processors. They change no byte.
        settings: as for `PeopleBoyEnv`, but `render_mode`.

    Raises:
        BadInput: an argument cannot be used.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012
        "render_modes": [], "render_fps": 15, "autoreset_mode": AutoresetMode.NEXT_STEP
    }  # fmt: skip

    def __init__(self, num_envs: int = 1, *, threads: int | None = None, **settings: Any) -> None:
        if num_envs < 1:
            raise BadInput(f"num_envs {num_envs}: must be 1 or more")
        if settings.get("render_mode") is not None:
            raise BadInput("render_mode: many worlds draw no pictures; leave it out, or take one environment")
        if threads is not None and threads < 1:
            raise BadInput(
                f"threads {threads}: must be 1 or more, or None for as many as there are processors"
            )
        self.num_envs = num_envs
        self._crew = Crew(threads)
        self._envs = tuple(PeopleBoyEnv(**settings) for _ in range(num_envs))
        self.single_action_space = self._envs[0].action_space
        self.single_observation_space = self._envs[0].observation_space
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._is_over = np.zeros(num_envs, np.bool_)
        self._together: Together | None = None  # until episodes have begun

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Arrays, Infos]:
        """Begin an episode in every world.

        Args:
            seed: of world 0, the next ones having the next; or one for each; None goes on, as for a single
                environment.
            options: as for a single environment, for all of them.

        Raises:
            BadInput: options that there are not, or not a seed for each.
        """
        seeds = [seed] * self.num_envs if seed is None else seed
        if isinstance(seeds, int | np.integer):
            seeds = [int(seeds) + number for number in range(self.num_envs)]
        if len(seeds) != self.num_envs:
            raise BadInput(f"seed: {len(seeds)} seeds for {self.num_envs} worlds; give one each")
        found = self._empty()
        infos: list[Infos] = []
        for number, (env, own) in enumerate(zip(self._envs, seeds, strict=True)):
            observation, info = env.reset(seed=own, options=options)
            _put(found, number, observation)
            infos.append(info)
        self._is_over[:] = False
        self._together = None
        return found, join_infos(infos)

    def step(self, actions: NDArray[np.float32]) -> tuple[Arrays, NDArray[np.float64], Flags, Flags, Infos]:
        """Drive every robot for one control step, and begin anew where an episode was over.

        Raises:
            BadInput: the actions are not (B, 2) finite numbers, or there are no episodes under way.
        """
        results = self._step_together(check_actions(actions, (self.num_envs, 2)))
        found, begun = self._empty(), dict[int, Arrays]()
        infos: list[Infos] = []
        rewards = np.zeros(self.num_envs)
        terminations, truncations = np.zeros((2, self.num_envs), np.bool_)
        for number, env in enumerate(self._envs):
            if self._is_over[number]:
                begun[number], info = env.reset()
                self._together = None
            else:
                reward, ended, cut, info = results[number]
                rewards[number], terminations[number], truncations[number] = float(reward), ended, cut
            infos.append(info)
        joined = join_infos(infos)
        for number, env in enumerate(self._envs):
            _put(found, number, begun[number] if number in begun else env.observation())
        self._is_over = terminations | truncations
        return found, rewards, terminations, truncations, joined

    def vary_by(self, options: dict[str, Any]) -> None:
        """Vary every world's episodes from its next one on, as for a single environment.

        Raises:
            BadInput: options that there are not.
        """
        for env in self._envs:
            env.vary_by(options)

    def close_extras(self, **_: Any) -> None:
        """Free all worlds."""
        for env in self._envs:
            env.close()
        self._crew.close()

    def _step_together(self, actions: Sequence[tuple[float, float]]) -> dict[int, Result]:
        """Step the worlds whose episodes are under way; gives what each environment says, by its number."""
        going = {number: env for number, env in enumerate(self._envs) if not self._is_over[number]}
        commands = {number: env.begin_step(actions[number]) for number, env in going.items()}
        if self._together is None:
            self._together = Together([env.world for env in self._envs], self._crew)
        instants = self._together.step(
            {number: (command.linear_m_s, command.angular_rad_s) for number, command in commands.items()}
        )
        return {number: env.end_step(instants[number]) for number, env in going.items()}

    def _empty(self) -> Arrays:
        spaces = self.observation_space.spaces.items()  # type: ignore[attr-defined]  # it is a Dict
        return {name: np.empty(space.shape, space.dtype) for name, space in spaces}


def _put(found: Arrays, number: int, observation: Arrays) -> None:
    for name, array in observation.items():
        found[name][number] = array
