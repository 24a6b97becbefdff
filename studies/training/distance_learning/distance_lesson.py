"""The whole lesson: watch people walk, teach a network and write its file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.run_folder.atomic_output import writing_to
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.store import Store, code_digest
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.scenarios.running.frame_cache import film_key
from peopleboy.studies.training.distance_learning import distance_examples
from peopleboy.studies.training.distance_learning.distance_examples import Examples, see_floor
from peopleboy.studies.training.distance_learning.distance_task import DistanceTask
from peopleboy.studies.training.distance_learning.distance_trials import (
    SplitTrial,
    general_networks,
    general_trials,
)
from peopleboy.studies.training.distance_learning.image_errors import ImageErrors
from peopleboy.studies.training.distance_learning.walks import walks
from peopleboy.tracker.frame import PANORAMA
from peopleboy.tracker.panoramic.panorama_view import PanoramaView
from peopleboy.tracker.panoramic.paper.appearance_file import FILE_NAME, AppearanceModel, ship
from peopleboy.tracker.panoramic.paper.distance_network import Lessons, teach
from peopleboy.tracker.panoramic.paper.position_filter import estimate_noise


@dataclass(frozen=True, slots=True)
class Learned:
    """What a lesson came to.

    Attributes:
        path: the network's file.
        summary: how far off it is, in a line.
    """

    path: Path
    summary: str


def give_distance_lesson(
    out: Path, scenario: str, seeds: int, workers: Workers, *, lessons: Lessons, ships: bool
) -> Learned:
    """Learn distances from a scenario, and leave the examples and the network in a folder.

    Examples that an earlier lesson left there are used, as long as neither code nor scenario has changed.

    Args:
        out: the folder.
        scenario: name or path; its first panoramas are empty, and one person at a time is there later.
        seeds: runs of it.
        workers: who runs them.
        lessons: how the network is taught.
        ships: whether to put the network among the tracker's own instead.

    Raises:
        BadInput: an unknown scenario, one that does not begin empty, a camera that sees no floor there, or a
            path that cannot be used; a new folder is not left behind then.
        TasksFailed: some runs failed, after all others were done.
    """
    loaded = load_scenario(scenario)
    seeing = loaded.mounting((PANORAMA,))
    with writing_to(out):
        out.mkdir(parents=True, exist_ok=True)
    with _not_left_empty(out):
        see_floor(seeing.world(0), scenario)
        store = Store(out / "examples.jsonl", code_digest(Path(distance_examples.__file__)))
        tasks = [DistanceTask(scenario, seed, film_key(seeing, seed)[:12]) for seed in range(seeds)]
        missing = [task for task in tasks if task.name not in store]
        work_through(missing, workers, "examples", lambda task, result: store.add(task.name, result))
    results = [store[task.name] for task in tasks]
    runs = [Examples.of_rows(result["rows"]) for result in results]
    _check_runs(runs, scenario)
    model = _learn(loaded.name, runs, results, lessons)
    path = out / FILE_NAME
    if ships:
        path = ship(model, loaded.name)
    else:
        model.save(path)
    return Learned(path, _summary(model, runs, lessons))


@contextmanager
def _not_left_empty(folder: Path) -> Iterator[None]:
    """Remove a folder in which nothing was left because of an error."""
    try:
        yield
    finally:
        if not any(folder.iterdir()):
            folder.rmdir()


def _summary(model: AppearanceModel, runs: Sequence[Examples], lessons: Lessons) -> str:
    trial = SplitTrial(split="blocks", repeats=1, lessons=lessons)
    unseen = ImageErrors.joined(general_trials(run, general_networks(run, trial)) for run in runs).all
    return (
        f"distance off by {model.about['error on those']} on what was learned, by {unseen.mean:.3f} ± "
        f"{unseen.deviation:.3f} m where 30 % of each run were learned and the rest tested, by blocks"
    )


def _check_runs(runs: Sequence[Examples], scenario: str) -> None:
    for seed, run in enumerate(runs):
        if len(run.cues) < 100:
            raise BadInput(
                f"{scenario}, seed {seed}: one person alone is in {len(run.cues)} panoramas; "
                "at least 100 are needed to learn from"
            )


def _learn(
    name: str, runs: Sequence[Examples], results: Sequence[dict[str, Any]], lessons: Lessons
) -> AppearanceModel:
    """Teach the network on all examples."""
    cues = np.concatenate([run.cues for run in runs])
    distances = np.concatenate([run.distance_m for run in runs])
    network = teach(cues, distances, np.random.default_rng(0), lessons)
    error = np.abs(network.distance(cues) - distances)
    all_walks = [walk for run in runs for walk in walks(run, run.seen_at(network.distance(run.cues)))]
    missed = sum(result["missed"] for result in results)
    return AppearanceModel(
        network=network,
        view=PanoramaView.of_plain(results[0]["view"]),
        noise=estimate_noise(all_walks, uses_velocity=False),
        about={
            "trained on": f"{len(cues)} images of {name}, seeds 0 to {len(runs) - 1}",
            "lessons": f"{lessons.epochs} epochs, rate {lessons.rate:g}, online",
            "error on those": f"{error.mean():.3f} ± {error.std():.3f} m",
            "left out": f"{missed} images in which the person was not seen",
        },
    )
