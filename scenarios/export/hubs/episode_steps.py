"""Read saved episodes step by step: observations, actions, rewards and ends.

Observations are those of `PeopleBoyEnv` with `observation="tracks"` and without scaling, and contain the
tracks of the run. Without a tracker, these are those of `tracker="truth"`, whose boxes follow the gait; those
of `observation="truth"` need no image, and do not. An image of a camera can be added. Actions are the
commands that reached the robot, as shares of its limits. The step at which time was over has no observation
after it in a run, and is left out.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pyarrow.parquet as pq
from gymnasium import spaces
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.environments.observations import (
    Arrays,
    fill_goal,
    fill_odometry,
    image_shape,
    observation_space,
    observe_tracks,
)
from peopleboy.scenarios.export.replay import Play, one_camera
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.run_tables import LOCAL
from peopleboy.scenarios.scores.episode_result import REWARDS
from peopleboy.sim.cameras.kinds import kind_of


def space_of(run: FinishedRun, camera: str | None) -> spaces.Dict:
    """Return the space of the observations of a run, with the images of a camera if one is given.

    Raises:
        BadInput: the camera is unknown.
    """
    has_goal = run.scenario.robot.goal_m is not None
    space = cast(spaces.Dict, observation_space("tracks", run.robot, (), has_goal=has_goal))
    if camera is None:
        return space
    config = one_camera(run, camera).run.robot.cameras[camera]
    kind = kind_of(config)
    image = spaces.Box(0, int(np.iinfo(kind.dtype).max), image_shape(config), kind.dtype)
    return spaces.Dict({**space.spaces, camera: image})


def check_episodes(runs: Sequence[FinishedRun], camera: str | None) -> None:
    """Check that runs are saved episodes with the same observations.

    Raises:
        BadInput: one is not, or has no such camera.
    """
    first = space_of(runs[0], camera)
    for run in runs:
        if run.about.episode is None or not (run.folder / REWARDS).is_file():
            raise BadInput(
                f"{run.folder}: not an episode of an environment, so it has no rewards; save one with "
                "env.save()"
            )
        if run.frames < 2:
            raise BadInput(f"{run.folder}: has no step that a frame follows; save longer episodes")
        if space_of(run, camera) != first:
            raise BadInput(
                f"{run.folder}: its observations differ from those of {runs[0].folder} in cameras, sonars or "
                "goal; export them into different folders"
            )


@dataclass(frozen=True, slots=True, eq=False)
class EpisodeSteps:
    """The steps of an episode.

    Attributes:
        observations: (T + 1, ...) by name, as in the space of `space_of`.
        actions: (T, 2) shares of the limits of forward speed and turn rate.
        rewards: (T,) reward of each step.
        is_terminal: whether the episode ended by what happened, and not because it was cut.
    """

    observations: Arrays
    actions: NDArray[np.float32]
    rewards: NDArray[np.float64]
    is_terminal: bool

    @property
    def is_last(self) -> NDArray[np.bool_]:
        """Whether each step is the last one (T,)."""
        steps = len(self.rewards)
        return np.asarray(np.arange(steps) == steps - 1)


def read_steps(run: FinishedRun, play: Play, camera: str | None) -> EpisodeSteps:
    """Replay a saved episode, and return its steps.

    Args:
        run: the episode.
        play: replays a run.
        camera: camera whose newest image is in the observations; None for no images.
    """
    space, limits = space_of(run, camera), np.array(run.robot.drive.limits)
    seen: dict[str, list[NDArray[Any]]] = {name: [] for name in space.spaces}
    commands = []
    for tick, observation in _observations(run, play, space, camera):
        for name, value in observation.items():
            seen[name].append(value)
        commands.append((tick.command.linear_m_s, tick.command.angular_rad_s))
    steps = len(commands) - 1  # the command of the last frame is not carried out
    rewards = pq.read_table((run.folder / REWARDS).absolute(), filesystem=LOCAL)["reward"].to_numpy()[:steps]
    return EpisodeSteps(
        observations={name: np.array(values) for name, values in seen.items()},
        actions=(np.array(commands[:steps]).reshape(-1, 2) / limits).astype(np.float32),
        rewards=rewards,
        is_terminal=run.about.ended not in ("time", ""),
    )


def _observations(
    run: FinishedRun, play: Play, space: spaces.Dict, camera: str | None
) -> Iterator[tuple[Tick, Arrays]]:
    """Yield the instants of a run with their observations."""
    start, image = None, None
    for tick in play(run):
        start = tick.observation.odometry if start is None else start
        found = _numbers(run, tick, start)
        if camera is not None:
            image = tick.observation.images.get(camera, image)
            assert image is not None  # every camera has an image in the first frame
            found[camera] = np.array(image).reshape(space[camera].shape or ())
        yield tick, found


def _numbers(run: FinishedRun, tick: Tick, start: Pose2) -> Arrays:
    """Return the numbers of an observation, as `PeopleBoyEnv` does."""
    senses, goal_m = tick.observation, run.scenario.robot.goal_m
    now, wheels = _row(senses.odometry), np.array([senses.wheel_speeds_m_s])
    odometry = np.empty((1, 6), np.float32)
    fill_odometry(_row(start), now, wheels, odometry)
    found = {
        "sonar": senses.sonar_m.astype(np.float32),
        "odometry": odometry[0],
        "tracks": observe_tracks(tick.tracks, run.robot),
    }
    if goal_m is not None:
        goal = np.empty((1, 3), np.float32)
        fill_goal(np.array([goal_m]), now, goal)
        found["goal"] = goal[0]
    return found


def _row(pose: Pose2) -> NDArray[np.float64]:
    return np.array([[pose.x, pose.y, pose.heading]])
