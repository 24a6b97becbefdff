"""Gymnasium environment of any scenario, in which your controller drives the robot."""

import copy
import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Self, SupportsFloat

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import Command
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.environments.arguments import (
    check_actions,
    check_options,
    check_size,
    check_word,
    shown_cameras,
    whole_number,
    world_of,
)
from peopleboy.scenarios.environments.episodes import (
    EpisodeSettings,
    LiveEpisodes,
    Metrics,
    StepOutcomes,
    track_in,
)
from peopleboy.scenarios.environments.observations import (
    KINDS,
    Arrays,
    Normaliser,
    ObservationBuilder,
    observation_space,
    observe_tracks,
)
from peopleboy.scenarios.environments.rewards import TASKS, TERMS
from peopleboy.scenarios.environments.scene_picture import ScenePicture
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.files.robot import ORACLE
from peopleboy.scenarios.files.scenario import Scenario, sampled_faults
from peopleboy.scenarios.files.variation import ActionChannel, EpisodeSpec, as_ranges, resized, vary
from peopleboy.scenarios.loop.faults import FaultyTracker, SensorFaults
from peopleboy.scenarios.loop.loop import TrackerDown
from peopleboy.scenarios.loop.tracker_by_name import make_checked_tracker, tracker_cameras
from peopleboy.scenarios.random_worlds.distribution import Distribution
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.scenarios.scores.drive_record import TARGET
from peopleboy.scenarios.scores.following_metrics import following_task
from peopleboy.scenarios.scores.goal_metrics import goal_task
from peopleboy.sim.batch.sensing import Snapshot, take_snapshot
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.sim.observation import Observation, Senses
from peopleboy.sim.rendering.view import BLIND
from peopleboy.sim.truth.scenes import ImageFreeTruth
from peopleboy.sim.world import SimulatedWorld
from peopleboy.sim.world_config import WorldConfig
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.track import Track
from peopleboy.tracker.trackers import Tracker, explanation_of

if TYPE_CHECKING:
    from peopleboy.scenarios.recording.live_picture import LivePicture

DEFAULT_PX: Final = (320, 240)
_SEEDS: Final = 2**31
_ENDLESS: Final = 2**31
_LARGEST_SEED: Final = 2**63 - 1
_MOST_PHYSICS_HZ: Final = 24000  # a hundred times that of a run
_RANDOM_S: Final = 30.0  # episodes in random worlds


class PeopleBoyEnv(gymnasium.Env[Arrays, NDArray[np.float32]]):
    """A robot among people, driven by actions; one step is one image, 1/15 s.

    Action: (2,) within -1..1, as shares of the robot's limits of forward speed (0.8 m/s) and turn rate
    (150 deg/s, positive to the left); larger values are clipped. Observations are described in
    `observations`, the reward in `rewards`. An episode terminates when the robot touches anything, in
    "follow" and "patrol" when the person to follow has been out of sight for 10 s, in "go_to" when the robot
    reaches its goal; it is truncated at the end of the scenario's duration. `info` holds `truth` (an
    `ImageFreeTruth`), `reward` (its terms), `events` (new events, each with the other party), `seed`, and, at
    the end of the episode, `metrics`.

    `reset(seed=3)` plays the world of `peopleboy run --seed 3`: the same commands give the same ground truth
    and, with the tracks of the same tracker, the same metrics. `reset()` samples the next seed from that
    seed. `reset(options=...)` varies this one episode, see
    `peopleboy.scenarios.files.variation.LIMITS`.

    Args:
        scenario: library name or path of a YAML file; None for a random world of 30 s at every reset, sampled
            from `peopleboy.scenarios.random_worlds.distribution` with the episode's seed.
        task: "follow", "corridor", "patrol" or "go_to", which needs a scenario with `robot.goal_m`; selects
            the reward.
        observation: "pixels"; "tracks", the output of the tracker; or "truth", the output of a perfect
            tracker, for which nothing is rendered.
        image_size: width and height [px] of all images.
        cameras: names of the cameras in "pixels"; others are not rendered. None for all.
        tracker: name of the tracker that computes "tracks"; "truth" for exact boxes; None for the scenario's.
        randomise: options of every episode for which `reset` gets none.
        render_mode: "rgb_array" for `render`; "human" to show every step in rerun's viewer, a window, or a
            page whose address is printed if there is no screen; or None.
        physics: "bullet", or "kinematic", which is faster and needs no PyBullet; None for the scenario's.
        physics_hz: physics steps per second, a multiple of 15; None for that of a run, 240. The benchmark
            `benchmarks.speed.environments` prints the speedup at 60 and the error of the robot's path.
        normalise: whether to scale numbers to -1..1, see `Normaliser` in
            `peopleboy.scenarios.environments.observations`.
        max_episode_steps: steps after which an episode is truncated, if the scenario does not end before;
            None for the scenario's duration alone. `gymnasium.make` uses 1125 unless you give another number.

    Raises:
        BadInput: an argument is invalid.
    """

    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array"], "render_fps": 15}  # noqa: RUF012

    def __init__(
        self,
        scenario: str | Path | None = "single_follow",
        *,
        task: str = "follow",
        observation: str = "tracks",
        image_size: tuple[int, int] = DEFAULT_PX,
        cameras: Sequence[str] | None = None,
        tracker: str | None = None,
        randomise: Mapping[str, Any] | None = None,
        render_mode: str | None = None,
        physics: str | None = None,
        physics_hz: int | None = None,
        normalise: bool = False,
        max_episode_steps: int | None = None,
    ) -> None:
        self._world: SimulatedWorld | None = None
        self._viewer: LivePicture | None = None
        check_word("task", task, TASKS)
        check_word("observation", observation, KINDS)
        check_word("render_mode", render_mode, (None, *self.metadata["render_modes"]))
        check_size(image_size)
        if not isinstance(scenario, str | Path | Scenario | None):
            raise BadInput(f"scenario {reprlib.repr(scenario)} must be a name, or the path of a file")
        if not isinstance(tracker, str | None):
            raise BadInput(f"tracker {reprlib.repr(tracker)} must be a name")
        if observation == "truth" and tracker is not None:
            raise BadInput(f"tracker {tracker!r}: observation 'truth' has none; leave it out")
        if not isinstance(normalise, bool):
            raise BadInput(f"normalise {normalise!r} must be True or False")
        self._draws_worlds, self._physics = scenario is None, physics
        self.vary_by({} if randomise is None else randomise)
        loaded = _random_episode(0) if scenario is None else load_scenario(scenario)
        first = self._moved(loaded.as_episode(0, None) if loaded.episode else loaded)
        self._tracker_name = first.tracker if tracker is None else tracker
        self._wanted = tracker_cameras(self._tracker_name)  # raises for an unknown name
        self.task, self._kind, self._size = task, observation, image_size
        self.render_mode = render_mode
        usual = first.world(0)
        self._physics_hz = usual.physics_hz
        if physics_hz is not None:
            self._physics_hz = whole_number("physics_hz", physics_hz, usual.control_hz, _MOST_PHYSICS_HZ)
        replace(usual, physics_hz=self._physics_hz)  # raises for an invalid rate
        self._take(first)
        self._max_steps = _ENDLESS
        if max_episode_steps is not None:
            self._max_steps = whole_number("max_episode_steps", max_episode_steps, 1, _ENDLESS)
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        shown = shown_cameras(cameras, observation, self._robot)
        normaliser = Normaliser(self._robot) if normalise else None
        has_goal = first.robot.goal_m is not None
        if task == "go_to" and not has_goal:
            raise BadInput(f"task 'go_to': scenario {first.name!r} has no goal; give it robot.goal_m")
        self.builder = ObservationBuilder(observation, self._robot, shown, normaliser, has_goal=has_goal)
        space = observation_space(observation, self._robot, shown, has_goal=has_goal)
        self.observation_space = space if normaliser is None else normaliser.space(space)
        self._faults: SensorFaults | None = None
        self.join(LiveEpisodes(1, task), 0)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Arrays, dict[str, Any]]:
        """Begin an episode; see the class.

        Raises:
            BadInput: an option is invalid.
        """
        seed = None if seed is None else whole_number("seed", seed, 0, _LARGEST_SEED)
        super().reset(seed=seed)
        chosen = self._randomise if options is None else options
        check_options(chosen, draws_worlds=self._draws_worlds)
        self._free()
        self._seed = int(self.np_random.integers(_SEEDS)) if seed is None else seed
        if self._draws_worlds:
            self._take(self._moved(_random_episode(self._seed, world_of(chosen))))
        self._ranges = as_ranges(chosen)
        config = self._config()
        world = self._world = SimulatedWorld(config)
        try:
            return self._begin(world)
        except BaseException:
            self._free()
            raise

    def _begin(self, world: SimulatedWorld) -> tuple[Arrays, dict[str, Any]]:
        """Begin an episode in a new world."""
        config = world.config
        self._calibrations = calibrations_of(config.robot.cameras)
        self._dt_s = 1.0 / config.control_hz
        self._commands: list[NDArray[np.float64]] = []  # (2,) [m/s, rad/s] each
        faults = (*self._scenario.spec.faults, *sampled_faults(self._seed, self._ranges))
        self._channel = ActionChannel(self._seed, self._ranges, self._dt_s)
        self._faults = SensorFaults(faults, config.robot.sonar.farthest_m) if faults else None
        self._tracker: Tracker | None = None
        if self._kind == "tracks":
            name, cameras = self._tracker_name, config.robot.cameras
            tracker = make_checked_tracker(name, self._seed, world.truth, cameras)
            self._tracker = FaultyTracker(tracker, faults) if faults else tracker
        self._tracks: tuple[Track, ...] = ()
        self._before: Pose2 | None = None
        self._track = 0  # id of the last track on the person to follow
        self._images: Arrays = {}
        settings = EpisodeSettings(
            plan=self._scenario.plan,
            following=following_task(config, self._scenario.follow_config().keep_height),
            goal=self._goal,
            frames=min(round(self._scenario.duration_s * config.control_hz), self._max_steps),
            dt_s=self._dt_s,
            limits=config.robot.drive.limits,
        )
        tracks = self._perceive(world)
        outcomes = self._episodes.begin(self._number, settings, self._snapshot, tracks)
        self._truth = outcomes.truths[0]
        observation = self._observation()
        if self.render_mode == "human":
            self._show_first()
        return observation, self._info(outcomes)

    def join(self, episodes: LiveEpisodes, number: int) -> None:
        """Store all further episodes under this number among those of many worlds."""
        self._episodes, self._number = episodes, number

    def vary_by(self, options: Mapping[str, Any]) -> None:
        """Vary further episodes for which `reset` gets no options, for example in a curriculum.

        Args:
            options: options of `reset`; empty for the unchanged scenario.

        Raises:
            BadInput: an option is invalid.
        """
        check_options(options, draws_worlds=self._draws_worlds)
        self._randomise = dict(options)

    def step(
        self, action: NDArray[np.float32] | Sequence[float]
    ) -> tuple[Arrays, SupportsFloat, bool, bool, dict[str, Any]]:
        """Drive for one control step.

        Raises:
            BadInput: the action is not two finite numbers, or no episode is in progress.
        """
        shares, world = check_actions(action, (2,)), self._running()
        world.step(*self.send(shares[0]).tolist())
        tracks = self._perceive(world)
        outcomes = self._episodes.evaluate(self._snapshot, shares, tracks)
        self._truth = outcomes.truths[0]
        reward = outcomes.rewards[0]
        if self._viewer is not None:
            self._viewer.go_on(self._draw(), reward, self._dt_s)
        ends, is_cut = bool(outcomes.terminations[0]), bool(outcomes.truncations[0])
        return self._observation(), reward, ends, is_cut, self._info(outcomes)

    def watch(self, snapshot: Snapshot, row: int, truth: ImageFreeTruth) -> None:
        """Take a row of a snapshot of many worlds as the current instant, which `render` draws."""
        self._snapshot, self._row, self._truth = snapshot, row, truth

    def track(self, snapshot: Snapshot, row: int) -> int:
        """Update the tracker, if there is one, with the images of an instant.

        Args:
            snapshot: snapshot of many worlds.
            row: row of this world.

        Returns:
            Id of the track on the person to follow, 0 for none.
        """
        assert self._tracker is not None
        world, senses = self._running(even_over=True), snapshot.senses(row)
        assert isinstance(senses, Observation)
        try:
            frame = Frame.from_observation(senses, self._before, self._calibrations)
            self._tracks = self._tracker.update(frame)
        except TrackerDown:
            self._tracks = ()
        self._before = senses.odometry
        box = world.box(TARGET) if world.config.people else None
        track = track_in(snapshot.scenes, row, self._tracks, box, self._track)
        self._track = track or self._track
        return track

    def send(self, action: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the speeds (2,) [m/s, rad/s] of the next step for an action (2,), with all disturbances."""
        command = self._channel.send(action) * self._own["limits"]
        self._commands.append(command)
        return np.asarray(self._disturb() * command)

    @property
    def has_faults(self) -> bool:
        """Whether sensors fail in the scenario."""
        return self._faults is not None

    def _disturb(self) -> float:
        """Disturb the robot at the start of a step, as the scenario's faults ask.

        Returns:
            The share of the commanded motion that the robot makes: less than 1 while its wheels slip.
        """
        world = self._running(even_over=True)
        return 1.0 if self._faults is None else self._faults.disturb(world.robot, world.time_s)

    def spoil(self, senses: Senses) -> Senses:
        """Apply the active faults of the scenario to readings."""
        if self._faults is None:
            return senses
        if isinstance(senses, Observation):
            senses = replace(senses, calibrations=self._calibrations)
        return self._faults.apply(senses)

    @property
    def tracks(self) -> NDArray[np.float32]:
        """`tracks` (35,) at the last update of the tracker."""
        return observe_tracks(self._tracks, self.world.config.robot)

    @property
    def seed(self) -> int:
        """Seed of the current or last episode."""
        return self._seed

    @property
    def world(self) -> SimulatedWorld:
        """World of the current or last episode.

        Raises:
            BadInput: no episode has begun.
        """
        return self._running(even_over=True)

    def render(self) -> NDArray[np.uint8] | None:
        """Draw thermal image, colour image and plan side by side, (360, 1440, 3); None unless "rgb_array".

        The plan shows the robot, all people, the person to follow, and the goal, if there is one.

        Raises:
            BadInput: no episode has begun.
        """
        return self._draw() if self.render_mode == "rgb_array" else None

    def metrics(self) -> Metrics:
        """Return the metrics of the episode so far, see `EpisodeMetrics`.

        They cover the instants at which a run has frames, so not the instant at which the time is over.

        Raises:
            BadInput: no episode has begun.
        """
        self._running(even_over=True)
        return self._episodes.metrics(self._number)

    def save(self, folder: str | Path, *, record: bool = True, overwrite: bool = False) -> Path:
        """Write the episode so far as a run folder, for reports, the viewer and exports.

        Replays the world with the episode's commands, so this takes as long as a run. The run has the frames
        and the metrics of the episode; run.json says how it ended, and rewards.parquet has the terms of the
        reward of each step. The tracks are those of the environment's tracker; without one, they are the true
        boxes, and the images have the scenario's size.

        Args:
            folder: output folder.
            record: whether to write a recording.
            overwrite: whether to replace an earlier run in the folder.

        Returns:
            The folder.

        Raises:
            BadInput: no episode has begun, or the folder cannot be written to.
        """
        from peopleboy.scenarios.running.run import save_episode  # here, as only saved episodes need it
        from peopleboy.scenarios.running.run_options import RunOptions

        config, folder = self._running(even_over=True).config, Path(folder)
        if folder.exists() and not overwrite:
            raise BadInput(f"save: {folder}: exists already; give overwrite=True to replace a run there")
        has_tracker = self._kind == "tracks"
        options = RunOptions(
            seed=self._seed,
            out=folder,
            tracker=self._tracker_name if has_tracker else ORACLE,
            record=record,
            overwrite=overwrite,
        )
        episode = EpisodeSpec(
            frames=int(min(self._own["frame"] + 1, self._own["frames"])),
            physics_hz=config.physics_hz,
            image_size=list(self._size) if has_tracker else None,
            options=self._ranges,
        )
        scenario = self._scenario.as_episode(self._seed, episode)
        speeds = np.reshape(self._commands, (-1, 2)).tolist()
        commands = [Command(linear_m_s=ahead, angular_rad_s=turn) for ahead, turn in speeds]
        save_episode(scenario, commands, options, self._episodes.result(self._number))
        return folder

    def close(self) -> None:
        """Free the physics world, and close the viewer."""
        self._free()
        if self._viewer is not None:
            self._viewer.close()
            self._viewer = None

    def __copy__(self) -> Self:
        """Copy the environment like `copy.deepcopy`, as two environments cannot share an episode."""
        return copy.deepcopy(self)

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """Copy the environment; in an episode, the copy goes on from the same instant.

        Raises:
            BadInput: an episode with Bullet is under way.
        """
        twin = type(self).__new__(type(self))
        memo[id(self)] = twin
        twin.__dict__.update(copy.deepcopy(self.__dict__, memo))
        return twin

    def __getstate__(self) -> dict[str, Any]:
        """Return what is pickled.

        Raises:
            BadInput: an episode with images or with Bullet is under way.
        """
        if self._world is not None and self._world.has_images:
            raise BadInput(
                "an environment with images cannot be pickled in an episode; pickle it before reset(), or "
                "use observation 'truth' with physics 'kinematic'"
            )
        return self.__dict__

    def _draw(self) -> NDArray[np.uint8]:
        self._running(even_over=True)
        assert self._picture is not None
        senses = self._snapshot.senses(self._row)
        assert isinstance(senses, Observation)
        explanation = None if self._tracker is None else explanation_of(self._tracker)
        return self._picture.draw(senses, self._truth, self._tracks, explanation)

    def _show_first(self) -> None:
        """Show the first instant of an episode in the viewer, which is opened if necessary."""
        if self._viewer is None:
            from peopleboy.scenarios.recording.recording_file import check_installed

            check_installed('render_mode="human"')
            from peopleboy.scenarios.recording.live_picture import LivePicture  # here, as it loads rerun

            self._viewer = LivePicture(print)
        self._viewer.begin(self._draw(), f"{self._scenario.name}, seed {self._seed}")

    def _free(self) -> None:
        if self._world is not None:
            self._world.close()
            self._world = None

    def _moved(self, scenario: Scenario) -> Scenario:
        return scenario if self._physics is None else scenario.moved_by(self._physics)

    def _take(self, scenario: Scenario) -> None:
        """Play this scenario from the next episode on."""
        self._scenario = scenario.mounting(self._wanted) if self._kind == "tracks" else scenario
        self._robot = resized(self._scenario.robot.config(), self._size)
        self._goal = goal_task(scenario)
        self._picture = None
        if self.render_mode:
            goal_m, follows = scenario.robot.goal_m, self.task in ("follow", "patrol")
            self._picture = ScenePicture(scenario.plan, scenario.place, goal_m, follows=follows)

    def _config(self) -> WorldConfig:
        config = self._scenario.world(self._seed)
        needs_images = self._kind != "truth" or self.render_mode is not None
        renderer = config.renderer if needs_images else BLIND
        config = replace(config, robot=self._robot, physics_hz=self._physics_hz, renderer=renderer)
        return vary(config, self._ranges)

    def _perceive(self, world: SimulatedWorld) -> list[int] | None:
        """Take a snapshot, and return the ids of tracks that `LiveEpisodes.evaluate` needs."""
        self._snapshot, self._row = take_snapshot(world)._replace(numbers=np.array([self._number])), 0
        if self.has_faults:
            self._snapshot = self._snapshot.with_senses([self.spoil(self._snapshot.senses(0))])
        return None if self._tracker is None else [self.track(self._snapshot, 0)]

    def _observation(self) -> Arrays:
        """Return the observation of the current instant."""
        tracks = self.tracks[None] if self.builder.tracks else None
        found = self.builder.build(self._snapshot, self._episodes.records, tracks)
        self._images |= {name: images[0] for name, (_, images) in self.builder.images(self._snapshot).items()}
        return {name: array[0] for name, array in found.items()} | self._images

    @property
    def _own(self) -> np.void:
        """Record EPISODE of the current or last episode."""
        own: np.void = self._episodes.records[self._number]
        return own

    def _info(self, outcomes: StepOutcomes) -> dict[str, Any]:
        info = {
            "truth": self._truth,
            "reward": dict(zip(TERMS, outcomes.terms[0].tolist(), strict=True)),
            "events": outcomes.events[0],
            "seed": self._seed,
        }
        return info | {"metrics": self.metrics()} if self._own["is_over"] else info

    def _running(self, *, even_over: bool = False) -> SimulatedWorld:
        if self._world is None or (self._own["is_over"] and not even_over):
            raise BadInput("environment: no episode is under way; call reset() first")
        return self._world


def _random_episode(seed: int, distribution: Distribution | None = None) -> Scenario:
    return random_scenario(seed, _RANDOM_S, distribution)
