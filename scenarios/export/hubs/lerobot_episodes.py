"""Episodes of environments as a data set of LeRobot, version 3.0 of its layout, for imitation learning.

    data/chunk-000/file-000.parquet            the steps of an episode: observations, action, reward, indices
    meta/info.json                             features, rate, numbers of episodes and steps
    meta/episodes/chunk-000/file-000.parquet   length, task and statistics of each episode
    meta/tasks.parquet                         the tasks in words
    meta/stats.json                            statistics of the whole set, for normalisation

The steps are described in `episode_steps`. `observation.state` contains odometry, sonars and the direction of
the goal, if there is one; `observation.environment_state` contains the tracks. The last observation of an
episode is left out, since it has no action.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.overlay import as_picture
from peopleboy.scenarios.environments.observations import COLUMNS, MOST_TRACKS
from peopleboy.scenarios.export.hubs.episode_steps import EpisodeSteps, check_episodes, read_steps
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import png_bytes
from peopleboy.scenarios.run_folder.run_tables import LOCAL
from peopleboy.sim.cameras.kinds import kind_of

INSTRUCTIONS: Final = {
    "follow": "Follow the person.",
    "corridor": "Drive along the corridor.",
    "patrol": "Patrol, and follow the person who is seen.",
    "go_to": "Drive to the goal.",
}
"""Tasks of environments in words, as policies with language take them."""

_VERSION: Final = "v3.0"
_FILES_PER_CHUNK: Final = 1000
_DATA: Final = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_QUANTILES: Final = (0.01, 0.1, 0.5, 0.9, 0.99)
_KINDS: Final = tuple(f"q{round(100 * share):02d}" for share in _QUANTILES)
_IMAGES: Final = "observation.images."
_GOAL: Final = ("goal_distance_m", "goal_cos", "goal_sin")
_ODOMETRY: Final = ("x_m", "y_m", "heading_cos", "heading_sin", "linear_m_s", "angular_rad_s")
_CHUNK, _FILE = "data/chunk_index", "data/file_index"
_INDICES: Final = ("frame_index", "episode_index", "index", "task_index")

Values = Mapping[str, NDArray[Any]]  # (T, ...) by feature


def write_lerobot(runs: Sequence[FinishedRun], folder: Path, play: Play, camera: str | None = None) -> None:
    """Write saved episodes, one file each.

    Args:
        runs: the runs to write.
        folder: output folder, the `root` of the data set.
        play: replays a run.
        camera: camera whose newest image is in the observations; None for no images.

    Raises:
        BadInput: a run is not a saved episode, has no such camera or one of more than 8 bits, or has other
            observations than the first one.
    """
    check_episodes(runs, camera)
    if camera is not None and kind_of(runs[0].robot.cameras[camera]).dtype != np.uint8:
        raise BadInput(f"--camera {camera}: LeRobot has images of 8 bits; choose another camera")
    tasks = list(dict.fromkeys(_task(run) for run in runs))
    features: dict[str, Any] = {}
    summaries: dict[str, list[NDArray[Any]]] = {}
    episodes, start = [], 0
    for number, run in enumerate(runs):
        steps, task = read_steps(run, play, camera), _task(run)
        values = _values(steps, run, camera) | _indices(steps, number, start, tasks.index(task))
        features = features or {name: _feature(name, array, run) for name, array in values.items()}
        for name, array in values.items():
            summaries.setdefault(name, []).append(_summary(array))
        episode = _episode(number, start, len(steps.rewards), task)
        _write(folder / _DATA.format(chunk_index=episode[_CHUNK], file_index=episode[_FILE]), _table(values))
        stats = _statistics({name: of[-1:] for name, of in summaries.items()}, len(steps.rewards))
        episodes.append(
            episode
            | {f"stats/{name}/{kind}": value for name, of in stats.items() for kind, value in of.items()}
        )
        start += len(steps.rewards)
    _write(folder / "meta/episodes/chunk-000/file-000.parquet", pa.Table.from_pylist(episodes))
    _write(folder / "meta/tasks.parquet", _task_table(tasks))
    _write_json(folder / "meta/stats.json", _statistics(summaries, start))
    _write_json(folder / "meta/info.json", _info(runs, features, start, len(tasks)))


def _episode(number: int, start: int, count: int, task: str) -> dict[str, Any]:
    """Return the entry of an episode, without statistics."""
    chunk, file = divmod(number, _FILES_PER_CHUNK)
    return {
        "episode_index": number,
        "tasks": [task],
        "length": count,
        "dataset_from_index": start,
        "dataset_to_index": start + count,
        _CHUNK: chunk,
        _FILE: file,
        "meta/episodes/chunk_index": 0,
        "meta/episodes/file_index": 0,
    }


def _task(run: FinishedRun) -> str:
    name = (run.about.episode or {}).get("task")
    if name not in INSTRUCTIONS:
        raise BadInput(f"{run.folder / 'run.json'}: episode.task: unknown task {name!r}; save it again")
    return INSTRUCTIONS[name]


def _values(steps: EpisodeSteps, run: FinishedRun, camera: str | None) -> dict[str, NDArray[Any]]:
    """Return observations, actions, rewards and ends by the names of LeRobot's features."""
    seen, count = steps.observations, len(steps.rewards)
    names = ("odometry", "sonar", "goal")
    found: dict[str, NDArray[Any]] = {
        "observation.state": np.concatenate([seen[one][:count] for one in names if one in seen], axis=1),
        "observation.environment_state": seen["tracks"][:count],
    }
    if camera is not None:
        found[f"{_IMAGES}{camera}"] = np.stack(
            [as_picture(image[..., 0] if image.shape[2] == 1 else image) for image in seen[camera][:count]]
        )
    return found | {
        "action": steps.actions,
        "next.reward": steps.rewards.astype(np.float32),
        "next.done": steps.is_last & steps.is_terminal,
        "timestamp": (np.arange(count) / run.rate_hz).astype(np.float32),
    }


def _indices(steps: EpisodeSteps, number: int, start: int, task: int) -> dict[str, NDArray[Any]]:
    frames = np.arange(len(steps.rewards))
    columns = (frames, np.full_like(frames, number), frames + start, np.full_like(frames, task))
    return dict(zip(_INDICES, columns, strict=True))


def _feature(name: str, array: NDArray[Any], run: FinishedRun) -> dict[str, Any]:
    """Return the entry of info.json about a feature with values (T, ...)."""
    if array.ndim == 4:
        return {
            "dtype": "image",
            "shape": list(array.shape[1:]),
            "names": ["height", "width", "channels"],
        }
    shape = list(array.shape[1:]) or [1]
    return {"dtype": str(array.dtype), "shape": shape, "names": _names(name, shape[0], run)}


def _names(feature: str, size: int, run: FinishedRun) -> list[str] | None:
    """Return the names of a feature's numbers; None for a single one."""
    if feature == "action":
        return ["linear_share", "angular_share"]
    if feature == "observation.environment_state":
        return [f"person_{row + 1}_{column}" for row in range(MOST_TRACKS) for column in COLUMNS]
    if feature == "observation.state":
        goal = () if run.scenario.robot.goal_m is None else _GOAL
        sonars = [f"sonar_{k:02d}_m" for k in range(size - len(_ODOMETRY) - len(goal))]
        return [*_ODOMETRY, *sonars, *goal]
    return None


def _table(values: Values) -> pa.Table:
    """Return the steps of an episode as a table."""
    return pa.table({name: _column(array) for name, array in values.items()})


def _column(array: NDArray[Any]) -> pa.Array:
    if array.ndim == 4:
        return pa.array([{"bytes": png_bytes(image), "path": None} for image in array], _IMAGE)
    if array.ndim == 2:
        return pa.FixedSizeListArray.from_arrays(array.ravel(), array.shape[1])
    return pa.array(array)


_IMAGE: Final = pa.struct({"bytes": pa.binary(), "path": pa.string()})


def _summary(array: NDArray[Any]) -> NDArray[Any]:
    """Return the values (T, N) of an episode, or the number of pixels of each channel and value (C, 256)."""
    if array.ndim < 4:
        return array.reshape(len(array), -1)
    channels = range(array.shape[3])
    return np.stack([np.bincount(array[..., channel].ravel(), minlength=256) for channel in channels])


def _statistics(summaries: Mapping[str, Sequence[NDArray[Any]]], count: int) -> dict[str, dict[str, Any]]:
    """Return minimum, maximum, mean, deviation, quantiles and number of each feature over episodes.

    Those of images are of each channel in 0..1, as (3, 1, 1).
    """
    found = {}
    for name, of in summaries.items():
        if name.startswith(_IMAGES):
            numbers = {k: value[:, None, None] / 255.0 for k, value in _of_pixels(np.sum(of, axis=0)).items()}
        else:
            numbers = _of_values(np.concatenate(of))
        found[name] = {kind: value.tolist() for kind, value in numbers.items()} | {"count": [count]}
    return found


def _of_values(values: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Return the statistics (N,) of values (T, N)."""
    exact = values.astype(np.float64)
    found = {"min": values.min(axis=0), "max": values.max(axis=0), "mean": exact.mean(axis=0)}
    quantiles = dict(zip(_KINDS, np.quantile(exact, _QUANTILES, axis=0), strict=True))
    return found | {"std": exact.std(axis=0)} | quantiles


def _of_pixels(counts: NDArray[np.int64]) -> dict[str, NDArray[np.float64]]:
    """Return the statistics (C,) of pixels from the number of each value (C, 256)."""
    grey, shares = np.arange(256.0), counts / counts.sum(axis=1, keepdims=True)
    below, mean = np.cumsum(shares, axis=1), shares @ grey
    found = {"min": np.argmax(counts > 0, axis=1), "max": 255 - np.argmax(counts[:, ::-1] > 0, axis=1)}
    found |= {"mean": mean, "std": np.sqrt(np.maximum(shares @ grey**2 - mean**2, 0.0))}
    found |= {kind: np.argmax(below >= share, axis=1) for kind, share in zip(_KINDS, _QUANTILES, strict=True)}
    return found


def _task_table(tasks: Sequence[str]) -> pa.Table:
    """Return the tasks as a table that pandas reads with the texts as its index."""
    index = "__index_level_0__"
    columns: list[dict[str, str | None]] = [
        {"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64"},
        {"name": None, "field_name": index, "pandas_type": "unicode", "numpy_type": "object"},
    ]
    about = {
        "index_columns": [index],
        "column_indexes": [],
        "columns": [column | {"metadata": None} for column in columns],
        "pandas_version": "2.0.0",
    }
    table = pa.table({"task_index": np.arange(len(tasks)), index: list(tasks)})
    return table.replace_schema_metadata({"pandas": json.dumps(about)})


def _info(
    runs: Sequence[FinishedRun], features: Mapping[str, Any], frames: int, tasks: int
) -> dict[str, Any]:
    return {
        "codebase_version": _VERSION,
        "robot_type": "peoplebot",
        "total_episodes": len(runs),
        "total_frames": frames,
        "total_tasks": tasks,
        "chunks_size": _FILES_PER_CHUNK,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": runs[0].rate_hz,
        "splits": {"train": f"0:{len(runs)}"},
        "data_path": _DATA,
        "video_path": None,
        "features": features,
    }


def _write(path: Path, table: pa.Table) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, path.absolute(), filesystem=LOCAL)


def _write_json(path: Path, content: Mapping[str, Any]) -> None:
    path.write_text(json.dumps(content, indent=4) + "\n", encoding="utf-8")
