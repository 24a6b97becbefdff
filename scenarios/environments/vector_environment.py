"""Many environments in one process, as one of gymnasium's vector environments."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.environments.arguments import check_actions
from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.episodes import LiveEpisodes, Metrics, StepOutcomes
from peopleboy.scenarios.environments.observations import Arrays
from peopleboy.scenarios.environments.rewards import TERMS
from peopleboy.sim.batch.batch_cameras import WorkerPool
from peopleboy.sim.batch.sensing import Snapshot
from peopleboy.sim.batch.world_batch import WorldBatch
from peopleboy.sim.shapes.shape_table import Numbers

Infos = dict[str, Any]


def join_infos(infos: Sequence[Infos | None]) -> Infos:
    """Make arrays (B,) of B infos, at once where gymnasium's `VectorEnv` takes one after the other.

    Each key of any of them has an array of its values, and beside it, as `_key`, one of who has it; numbers
    are arrays of numbers, 0 for those who have none, dicts are joined in the same way, all else is objects.

    Args:
        infos: None for an environment that says nothing.
    """
    found: Infos = {}
    for key in dict.fromkeys(key for info in infos if info is not None for key in info):
        has = [info is not None and key in info for info in infos]
        values = [
            info[key] if is_there and info is not None else None
            for info, is_there in zip(infos, has, strict=True)
        ]
        first = values[has.index(True)]
        if isinstance(first, dict):
            found[key] = join_infos(values)
        else:
            found[key] = _array(values, first)
        found[f"_{key}"] = np.array(has)
    return found


def _array(values: list[Any], first: object) -> NDArray[Any]:
    if type(first) in (int, float, bool):
        return np.array([type(first)() if value is None else value for value in values])
    array = np.empty(len(values), object)
    for number, value in enumerate(values):
        array[number] = value
    return array


class StepResults:
    """Those of B worlds, in some of which an episode goes on, and begins in the others.

    Attributes:
        rewards: (B,).
        terminations, truncations: (B,).
    """

    def __init__(self, worlds: int) -> None:
        self.rewards = np.zeros(worlds)
        self.terminations, self.truncations = np.zeros((2, worlds), np.bool_)
        self._terms = np.zeros((worlds, len(TERMS)))
        self._truths, self._events = np.empty((2, worlds), object)

    def take(self, numbers: Numbers, outcomes: StepOutcomes) -> None:
        """Take in what came of the step in some of the worlds."""
        self.rewards[numbers], self._terms[numbers] = outcomes.rewards, outcomes.terms
        self.terminations[numbers], self.truncations[numbers] = outcomes.terminations, outcomes.truncations
        for row, number in enumerate(numbers.tolist()):
            self._truths[number], self._events[number] = outcomes.truths[row], outcomes.events[row]

    def begin(self, number: int, info: Infos) -> None:
        """Take in what an episode begins with in one of the worlds."""
        self._truths[number], self._events[number] = info["truth"], info["events"]

    def infos(self, seeds: list[int], metrics: list[Metrics | None]) -> Infos:
        """Make what `join_infos` makes of B infos of single environments.

        Args:
            seeds: of each.
            metrics: None where an episode goes on.
        """
        have = np.ones(len(seeds), np.bool_)
        terms = {name: self._terms[:, k].copy() for k, name in enumerate(TERMS)}
        columns = {
            "truth": self._truths,
            "reward": _with_flags(terms, have),
            "events": self._events,
            "seed": np.array(seeds),
        }
        found = _with_flags(columns, have)
        if any(figures is not None for figures in metrics):
            found |= join_infos([None if figures is None else {"metrics": figures} for figures in metrics])
        return found


def _with_flags(columns: dict[str, Any], have: NDArray[np.bool_]) -> Infos:
    """Put beside each column who has it."""
    return {
        key: each for name, column in columns.items() for key, each in ((name, column), (f"_{name}", have))
    }


Flags = NDArray[np.bool_]


class PeopleBoyVectorEnv(VectorEnv[Arrays, NDArray[np.float32], NDArray[Any]]):
    """B worlds, each with a robot of its own, stepped together.

    Actions are (B, 2); an observation has the arrays of `PeopleBoyEnv` with B before their shape, such as
    `thermal` (B, H, W, 1), each of its own and never written again. Kinematic worlds go through kernels
    together, see `peopleboy.sim.batch.world_batch.KinematicBatch`. World i gives to the byte what a single
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
        if not (isinstance(num_envs, int | np.integer) and num_envs >= 1):
            raise BadInput(f"num_envs {num_envs!r}: must be 1 or more")
        if settings.get("render_mode") is not None:
            raise BadInput("render_mode: many worlds draw no images; leave it out, or take one environment")
        if "autoreset_mode" in settings:
            raise BadInput(
                "autoreset_mode: gymnasium's own vector environments have that; "
                "give vectorization_mode='sync' or 'async'"
            )
        if threads is not None and not (isinstance(threads, int | np.integer) and threads >= 1):
            raise BadInput(
                f"threads {threads!r}: must be 1 or more, or None for as many as there are processors"
            )
        self.num_envs = num_envs
        self._crew = WorkerPool(threads)
        self._envs = tuple(PeopleBoyEnv(**settings) for _ in range(num_envs))
        first = self._envs[0]
        self._episodes = LiveEpisodes(num_envs, first.task)
        for number, env in enumerate(self._envs):
            env.join(self._episodes, number)
        self.single_action_space = first.action_space
        self.single_observation_space = first.observation_space
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._builder = first.builder
        self._kept: Arrays = {}
        self._together: WorldBatch | None = None  # until episodes have begun

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
            BadInput: options that there are not, or not a seed for each; or all this is closed.
        """
        self._check_open()
        seeds = self._seeds(seed)
        self._together = None  # even if this is interrupted: worlds are made anew
        found = self._empty()
        infos: list[Infos] = []
        for number, (env, own) in enumerate(zip(self._envs, seeds, strict=True)):
            observation, info = env.reset(seed=own, options=options)
            _put(found, number, observation)
            infos.append(info)
        self._keep(found)
        return found, join_infos(infos)

    def step(self, actions: NDArray[np.float32]) -> tuple[Arrays, NDArray[np.float64], Flags, Flags, Infos]:
        """Drive every robot for one control step, and begin anew where an episode was over.

        Raises:
            BadInput: the actions are not (B, 2) finite numbers, or there are no episodes under way.
        """
        self._check_open()
        shares, is_over = check_actions(actions, (self.num_envs, 2)), self._episodes.records["is_over"].copy()
        snapshot = self._step_together(np.flatnonzero(~is_over), shares)
        results = StepResults(self.num_envs)
        for each in snapshot:
            results.take(each.numbers, self._episodes.evaluate(each, shares[each.numbers], self._track(each)))
        begun = self._begin(np.flatnonzero(is_over), results)
        ends = (results.terminations | results.truncations).tolist()
        metrics = [self._episodes.metrics(number) if is_end else None for number, is_end in enumerate(ends)]
        infos = results.infos([env.seed for env in self._envs], metrics)
        found = self._observe(snapshot)  # at last, as images are being made meanwhile
        for number, observation in begun.items():
            _put(found, number, observation)
        self._keep(found)
        return found, results.rewards, results.terminations, results.truncations, infos

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

    def _check_open(self) -> None:
        if self.closed:
            raise BadInput("environment: is closed; make another one")

    def _seeds(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        """Return each world's seed."""
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, int | np.integer):
            return [int(seed) + number for number in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise BadInput(f"seed: {len(seed)} seeds for {self.num_envs} worlds; give one each")
        return [int(own) if isinstance(own, np.integer) else own for own in seed]

    def _step_together(self, active: Numbers, shares: NDArray[np.float64]) -> list[Snapshot]:
        """Step the worlds whose episodes are under way."""
        if self._together is None:
            self._together = WorldBatch([env.world for env in self._envs], self._crew)
        return self._together.step(active, (shares * self._episodes.records["limits"])[active])

    def _track(self, snapshot: Snapshot) -> list[int] | None:
        """Let trackers look, if there are any; returns what `LiveEpisodes.evaluate` needs to know of them."""
        if not self._builder.tracks:
            return None
        return [
            self._envs[number].track(snapshot, row) for row, number in enumerate(snapshot.numbers.tolist())
        ]

    def _begin(self, numbers: Numbers, results: StepResults) -> dict[int, Arrays]:
        """Begin new episodes in some worlds; gives their observations."""
        found = {}
        for number in numbers.tolist():
            found[number], info = self._envs[number].reset()
            results.begin(number, info)
            self._together = None
        return found

    def _observe(self, snapshot: Sequence[Snapshot]) -> Arrays:
        """Return the observations of some snapshots; those of other worlds are not filled yet."""
        found = self._empty()
        for name, images in self._kept.items():
            found[name][:] = images
        for each in snapshot:
            tracks = None
            if self._builder.tracks:
                tracks = np.stack([self._envs[number].tracks for number in each.numbers.tolist()])
            for name, array in self._builder.build(each, self._episodes.records, tracks).items():
                found[name][each.numbers] = array
            for name, (rows, array) in self._builder.images(each).items():
                found[name][each.numbers[rows]] = array
        return found

    def _keep(self, found: Arrays) -> None:
        """Keep the images of cameras that do not take one at every step."""
        self._kept = {name: found[name].copy() for name in self._builder.slow}

    def _empty(self) -> Arrays:
        spaces = self.observation_space.spaces.items()  # type: ignore[attr-defined]  # it is a Dict
        return {name: np.empty(space.shape, space.dtype) for name, space in spaces}


def _put(found: Arrays, number: int, observation: Arrays) -> None:
    for name, array in observation.items():
        found[name][number] = array
