"""Many environments in one process, as a gymnasium vector environment."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.environments.arguments import check_actions, check_word
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
    """Make arrays (B,) of B infos at once; gymnasium's `VectorEnv` adds them one by one.

    Each key of any info has an array of its values, and under `_key` an array that marks the infos that have
    it. Numbers give arrays of numbers, 0 where missing; dicts are joined recursively; everything else gives
    arrays of objects.

    Args:
        infos: infos of the environments; None for an empty info.
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
    """Results of B worlds, in some of which an episode continues, while it begins in the others.

    Attributes:
        rewards: (B,) rewards.
        terminations, truncations: (B,) whether the episodes are over.
    """

    def __init__(self, worlds: int) -> None:
        self.rewards = np.zeros(worlds)
        self.terminations, self.truncations = np.zeros((2, worlds), np.bool_)
        self._terms = np.zeros((worlds, len(TERMS)))
        self._truths, self._events = np.empty((2, worlds), object)

    def take(self, numbers: Numbers, outcomes: StepOutcomes) -> None:
        """Store the outcome of the step in some of the worlds."""
        self.rewards[numbers], self._terms[numbers] = outcomes.rewards, outcomes.terms
        self.terminations[numbers], self.truncations[numbers] = outcomes.terminations, outcomes.truncations
        for row, number in enumerate(numbers.tolist()):
            self._truths[number], self._events[number] = outcomes.truths[row], outcomes.events[row]

    def begin(self, number: int, info: Infos) -> None:
        """Store the first info of an episode that begins in one of the worlds."""
        self._truths[number], self._events[number] = info["truth"], info["events"]
        self._terms[number] = 0.0

    def infos(self, seeds: list[int], metrics: list[Metrics | None]) -> Infos:
        """Return the same as `join_infos` of B infos of single environments.

        Args:
            seeds: seed of each world.
            metrics: metrics of each episode that ends; None where an episode continues.
        """
        have = np.ones(len(seeds), np.bool_)
        terms = {name: self._terms[:, k].copy() for k, name in enumerate(TERMS)}
        columns = {
            "truth": self._truths.copy(),
            "reward": _with_flags(terms, have),
            "events": self._events.copy(),
            "seed": np.array(seeds),
        }
        found = _with_flags(columns, have)
        if any(figures is not None for figures in metrics):
            found |= join_infos([None if figures is None else {"metrics": figures} for figures in metrics])
        return found


def _with_flags(columns: dict[str, Any], have: NDArray[np.bool_]) -> Infos:
    """Add to each column the array that marks the worlds that have it."""
    return {
        key: each for name, column in columns.items() for key, each in ((name, column), (f"_{name}", have))
    }


Flags = NDArray[np.bool_]
AUTORESETS: Final = (AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP)


def select_infos(infos: Infos, chosen: NDArray[np.bool_]) -> Infos:
    """Return the infos of some of B environments: the same as `join_infos` with None for the others."""
    found: Infos = {}
    for key, values in infos.items():
        if isinstance(values, dict):
            found[key] = select_infos(values, chosen)
        else:
            found[key] = values.copy()
            found[key][~chosen] = None if values.dtype == object else 0
    return found


class PeopleBoyVectorEnv(VectorEnv[Arrays, NDArray[np.float32], NDArray[Any]]):
    """B worlds, each with its own robot, stepped together.

    Actions are (B, 2); an observation has the arrays of `PeopleBoyEnv` with B as the first axis, such as
    `thermal` (B, H, W, 1); returned arrays are never reused. Kinematic worlds are stepped together by
    compiled kernels, see `peopleboy.sim.batch.world_batch.KinematicBatch`. World i is bit-identical to a
    single environment with the same seed and actions; `infos` has the arrays that gymnasium makes of B infos.

    With `AutoresetMode.NEXT_STEP`, the step after an episode's end begins the next episode in that world,
    ignores the action, and has reward 0. With `AutoresetMode.SAME_STEP`, the step that ends an episode begins
    the next one: it returns the new episode's observation, and `infos` has the last observation in
    `final_obs`, and the last info with the metrics in `final_info`.

    Args:
        num_envs: B.
        threads: number of threads that render images; None for one per processor. The output does not
            depend on it.
        autoreset_mode: `AutoresetMode.NEXT_STEP` or `AutoresetMode.SAME_STEP`.
        settings: arguments of `PeopleBoyEnv`; its `render_mode` may be "rgb_array" or None.

    Attributes:
        envs: the B single environments, for their attributes and methods other than `reset` and `step`.

    Raises:
        BadInput: an argument is invalid.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        threads: int | None = None,
        autoreset_mode: AutoresetMode = AutoresetMode.NEXT_STEP,
        **settings: Any,
    ) -> None:
        if not (isinstance(num_envs, int | np.integer) and num_envs >= 1):
            raise BadInput(f"num_envs {num_envs!r}: must be 1 or more")
        self.render_mode = settings.get("render_mode")
        check_word("render_mode", self.render_mode, (None, "rgb_array"))
        if autoreset_mode not in AUTORESETS:
            known = " or ".join(map(str, AUTORESETS))
            raise BadInput(f"autoreset_mode {autoreset_mode!r}: must be {known}")
        if threads is not None and not (isinstance(threads, int | np.integer) and threads >= 1):
            raise BadInput(f"threads {threads!r}: must be 1 or more, or None for one per processor")
        self.num_envs = num_envs
        self._crew = WorkerPool(threads)
        self.envs = tuple(PeopleBoyEnv(**settings) for _ in range(num_envs))
        self.metadata = {
            "render_modes": ["rgb_array"],
            "render_fps": PeopleBoyEnv.metadata["render_fps"],
            "autoreset_mode": autoreset_mode,
        }
        self._resets_at_once = autoreset_mode is AutoresetMode.SAME_STEP
        first = self.envs[0]
        self._episodes = LiveEpisodes(num_envs, first.task)
        for number, env in enumerate(self.envs):
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
            seed: seed of world 0, with consecutive seeds for the others; or one seed per world; None samples
                the next seeds, as in a single environment.
            options: options of a single environment, for all worlds.

        Raises:
            BadInput: an option is invalid, the number of seeds is wrong, or the environment is closed.
        """
        self._check_open()
        seeds = self._seeds(seed)
        self._together = None  # also after an interrupt: the worlds are made anew
        found = self._empty()
        infos: list[Infos] = []
        for number, (env, own) in enumerate(zip(self.envs, seeds, strict=True)):
            observation, info = env.reset(seed=own, options=options)
            _put(found, number, observation)
            infos.append(info)
        self._keep(found)
        return found, join_infos(infos)

    def step(self, actions: NDArray[np.float32]) -> tuple[Arrays, NDArray[np.float64], Flags, Flags, Infos]:
        """Drive every robot for one control step, and begin a new episode where one was over.

        Raises:
            BadInput: the actions are not (B, 2) finite numbers, or no episodes are under way.
        """
        self._check_open()
        shares, is_over = check_actions(actions, (self.num_envs, 2)), self._episodes.records["is_over"].copy()
        snapshot = self._step_together(np.flatnonzero(~is_over), shares)
        results = StepResults(self.num_envs)
        for each in snapshot:
            outcomes = self._episodes.evaluate(each, shares[each.numbers], self._track(each))
            results.take(each.numbers, outcomes)
            if self.render_mode is not None:
                for row, number in enumerate(each.numbers.tolist()):
                    self.envs[number].watch(each, row, outcomes.truths[row])
        begun = self._begin(np.flatnonzero(is_over), results)
        ends = results.terminations | results.truncations
        metrics = [
            self._episodes.metrics(number) if is_end else None for number, is_end in enumerate(ends.tolist())
        ]
        infos = results.infos([env.seed for env in self.envs], metrics)
        found = self._observe(snapshot)  # last, because images are rendered in the meantime
        if self._resets_at_once and ends.any():
            infos, begun = self._restart(found, infos, results)
        for number, observation in begun.items():
            _put(found, number, observation)
        self._keep(found)
        return found, results.rewards, results.terminations, results.truncations, infos

    def _restart(self, found: Arrays, infos: Infos, results: StepResults) -> tuple[Infos, dict[int, Arrays]]:
        """Begin new episodes where one ended in this step; return the infos and the first observations."""
        ends = results.terminations | results.truncations
        last = [
            {name: found[name][k].copy() for name in found} if is_end else None
            for k, is_end in enumerate(ends.tolist())
        ]
        final = {"final_obs": _array(last, last), "final_info": select_infos(infos, ends)}
        begun = self._begin(np.flatnonzero(ends), results)
        seeds: list[int] = [env.seed for env in self.envs]
        return results.infos(seeds, [None] * self.num_envs) | _with_flags(final, ends), begun

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Draw each world as `PeopleBoyEnv.render` does: B pictures; None unless "rgb_array".

        Raises:
            BadInput: no episodes have begun.
        """
        pictures = [env.render() for env in self.envs]
        return None if self.render_mode is None else tuple(one for one in pictures if one is not None)

    def call(self, name: str, *args: Any, **kwargs: Any) -> tuple[Any, ...]:
        """Call a method of each environment, or get an attribute, as in gymnasium's vector environments."""
        found = [getattr(env, name) for env in self.envs]
        return tuple(one(*args, **kwargs) if callable(one) else one for one in found)

    def vary_by(self, options: dict[str, Any]) -> None:
        """Vary further episodes in every world, as in a single environment.

        Raises:
            BadInput: an option is invalid.
        """
        for env in self.envs:
            env.vary_by(options)

    def close_extras(self, **_: Any) -> None:
        """Free all worlds."""
        for env in self.envs:
            env.close()
        self._crew.close()

    def _check_open(self) -> None:
        if self.closed:
            raise BadInput("environment is closed; make another one")

    def _seeds(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        """Return the seed of each world."""
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, int | np.integer):
            return [int(seed) + number for number in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise BadInput(f"seed: got {len(seed)} seeds for {self.num_envs} worlds; give one per world")
        return [int(own) if isinstance(own, np.integer) else own for own in seed]

    def _step_together(self, active: Numbers, shares: NDArray[np.float64]) -> list[Snapshot]:
        """Step the worlds whose episodes are under way."""
        if self._together is None:
            self._together = WorldBatch([env.world for env in self.envs], self._crew)
        commands = np.array([self.envs[number].send(shares[number]) for number in active.tolist()])
        snapshots = self._together.step(active, commands.reshape(-1, 2))
        if not any(env.has_faults for env in self.envs):
            return snapshots
        return [
            each.with_senses(
                [self.envs[k].spoil(each.senses(row)) for row, k in enumerate(each.numbers.tolist())]
            )
            for each in snapshots
        ]

    def _track(self, snapshot: Snapshot) -> list[int] | None:
        """Update the trackers, if there are any; return the ids of tracks for `LiveEpisodes.evaluate`."""
        if not self._builder.tracks:
            return None
        return [
            self.envs[number].track(snapshot, row) for row, number in enumerate(snapshot.numbers.tolist())
        ]

    def _begin(self, numbers: Numbers, results: StepResults) -> dict[int, Arrays]:
        """Begin new episodes in some worlds; return their observations."""
        found = {}
        for number in numbers.tolist():
            found[number], info = self.envs[number].reset()
            results.begin(number, info)
            self._together = None
        return found

    def _observe(self, snapshot: Sequence[Snapshot]) -> Arrays:
        """Return the observations of some snapshots; the rows of other worlds are not filled yet."""
        found = self._empty()
        for name, images in self._kept.items():
            found[name][:] = images
        for each in snapshot:
            tracks = None
            if self._builder.tracks:
                tracks = np.stack([self.envs[number].tracks for number in each.numbers.tolist()])
            for name, array in self._builder.build(each, self._episodes.records, tracks).items():
                found[name][each.numbers] = array
            for name, (rows, array) in self._builder.images(each).items():
                found[name][each.numbers[rows]] = array
        return found

    def _keep(self, found: Arrays) -> None:
        """Store the images of cameras that do not take one at every step."""
        self._kept = {name: found[name].copy() for name in self._builder.slow}

    def _empty(self) -> Arrays:
        spaces = self.observation_space.spaces.items()  # type: ignore[attr-defined]  # it is a Dict
        return {name: np.empty(space.shape, space.dtype) for name, space in spaces}


def _put(found: Arrays, number: int, observation: Arrays) -> None:
    for name, array in observation.items():
        found[name][number] = array
