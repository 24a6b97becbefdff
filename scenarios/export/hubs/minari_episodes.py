"""Episodes of environments as a data set of Minari, for imitation and offline reinforcement learning.

    peopleboy/episodes-v0/data/metadata.json        spaces, number of episodes and steps
    peopleboy/episodes-v0/data/0/, 1/, ...          arrow file and metadata of each episode

The steps are described in `episode_steps`.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np
from gymnasium import spaces

from peopleboy.scenarios.export.formats import need
from peopleboy.scenarios.export.hubs.episode_steps import check_episodes, read_steps, space_of
from peopleboy.scenarios.export.replay import Play
from peopleboy.scenarios.run_folder.finished_run import FinishedRun

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
    check_episodes(runs, camera)
    data = folder / DATASET_ID / "data"
    data.parent.mkdir(parents=True)
    space = space_of(runs[0], camera)
    storage = storage_of.new(data.absolute(), space, _ACTIONS, data_format="arrow", jpeg_encoding=False)
    storage.update_metadata({"dataset_id": DATASET_ID, "minari_version": need("minari", _OPTION).__version__})
    for number, run in enumerate(runs):
        steps = read_steps(run, play, camera)
        episode = buffer(
            id=number,
            seed=run.about.seed,
            observations=steps.observations,
            actions=steps.actions,
            rewards=steps.rewards,
            terminations=steps.is_last & steps.is_terminal,
            truncations=steps.is_last & (not steps.is_terminal),
        )
        storage.update_episodes([episode])
        about = {"run": run.name, "scenario": run.about.scenario, "tracker": run.about.tracker}
        storage.update_episode_metadata([about | (run.about.episode or {})], [number])
