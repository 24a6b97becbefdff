"""Episodes of environments as a data set of Minari, for imitation and offline reinforcement learning.

    peopleboy/episodes-v0/data/metadata.json        spaces, number of episodes and steps
    peopleboy/episodes-v0/data/0/, 1/, ...          arrow file and metadata of each episode

Observations are those of `PeopleBoyEnv` with `observation="tracks"` and without scaling, and contain the
tracks of the run. Without a tracker, these are those of `tracker="truth"`, whose boxes follow the gait; those
of `observation="truth"` need no image, and do not. An image of a camera can be added. Actions are the
commands that reached the robot, as shares of its limits. The step at which time was over has no observation
after it in a run, and is left out.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final, cast

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
from peopleboy.scenarios.export.formats import need
from peopleboy.scenarios.export.replay import Play, one_camera
from peopleboy.scenarios.loop.loop import Tick
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.run_tables import LOCAL
from peopleboy.scenarios.scores.episode_result import REWARDS
from peopleboy.sim.cameras.kinds import kind_of

DATASET_ID: Final = "peopleboy/episodes-v0"

_OPTION: Final = "--format minari"
_ACTIONS: Final = spaces.Box(-1.0, 1.0, (2,), np.float32)


def write_minari(runs: Sequence[FinishedRun], folder: Path, play: Play, camera: str | None = None) -> None:
    """Write saved episodes, one after the other.

    Args:
        runs: the runs to write.
        folder: output folder, which Minari finds by the environment variable MINARI_DATASETS_PATH.
        play: replays a run.
        camera: camera whose newest image is in the observations; None for no images.

    Raises:
        BadInput: Minari is not installed, a run is not a saved episode, has no such camera, or has other
            observations than the first one.
    """
    storage_of = need("minari.dataset.minari_storage", _OPTION).MinariStorage
    buffer = need("minari.data_collector", _OPTION).EpisodeBuffer
    space = _space(runs[0], camera)
    for run in runs:
        _check(run, runs[0], space, camera)
    data = folder / DATASET_ID / "data"
    data.parent.mkdir(parents=True)
    storage = storage_of.new(data.absolute(), space, _ACTIONS, data_format="arrow", jpeg_encoding=False)
    storage.update_metadata({"dataset_id": DATASET_ID, "minari_version": need("minari", _OPTION).__version__})
    for number, run in enumerate(runs):
        storage.update_episodes(
            [buffer(id=number, seed=run.about.seed, **_episode(run, play, space, camera))]
        )
        about = {"run": run.name, "scenario": run.about.scenario, "tracker": run.about.tracker}
        storage.update_episode_metadata([about | (run.about.episode or {})], [number])


def _space(run: FinishedRun, camera: str | None) -> spaces.Dict:
    """Return the space of the observations of a run."""
    has_goal = run.scenario.robot.goal_m is not None
    space = cast(spaces.Dict, observation_space("tracks", run.robot, (), has_goal=has_goal))
    if camera is None:
        return space
    config = one_camera(run, camera).run.robot.cameras[camera]
    kind = kind_of(config)
    image = spaces.Box(0, int(np.iinfo(kind.dtype).max), image_shape(config), kind.dtype)
    return spaces.Dict({**space.spaces, camera: image})


def _check(run: FinishedRun, first: FinishedRun, space: spaces.Dict, camera: str | None) -> None:
    if run.about.episode is None or not (run.folder / REWARDS).is_file():
        raise BadInput(
            f"{run.folder}: not an episode of an environment, so it has no rewards; save one with env.save()"
        )
    if _space(run, camera) != space:
        raise BadInput(
            f"{run.folder}: its observations differ from those of {first.folder} in cameras, sonars or goal; "
            "export them into different folders"
        )


def _episode(run: FinishedRun, play: Play, space: spaces.Dict, camera: str | None) -> dict[str, Any]:
    """Return observations, actions, rewards and ends of an episode by the names of Minari's buffer."""
    limits = np.array(run.robot.drive.limits)
    seen: dict[str, list[NDArray[Any]]] = {name: [] for name in space.spaces}
    commands = []
    for tick, observation in _observations(run, play, space, camera):
        for name, value in observation.items():
            seen[name].append(value)
        commands.append((tick.command.linear_m_s, tick.command.angular_rad_s))
    steps = len(commands) - 1  # the command of the last frame is not carried out
    rewards = pq.read_table((run.folder / REWARDS).absolute(), filesystem=LOCAL)["reward"].to_numpy()[:steps]
    is_last = np.arange(steps) == steps - 1
    is_terminal = run.about.ended not in ("time", "")
    return {
        "observations": {name: np.array(values) for name, values in seen.items()},
        "actions": (np.array(commands[:steps]).reshape(-1, 2) / limits).astype(np.float32),
        "rewards": rewards,
        "terminations": is_last & is_terminal,
        "truncations": is_last & (not is_terminal),
    }


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
