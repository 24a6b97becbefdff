"""The whole lesson: watch people walk, repeat the paper's experiments, teach a network and write its file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.run_folder.out_folder import writing_to
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.store import Store, code_digest
from peopleboy.scenarios.running.engine.workers import Workers
from peopleboy.scenarios.running.frame_cache import film_key
from peopleboy.scenarios.studies.distance_learning import distance_examples
from peopleboy.scenarios.studies.distance_learning.distance_examples import Examples
from peopleboy.scenarios.studies.distance_learning.distance_task import DistanceTask
from peopleboy.scenarios.studies.distance_learning.distance_trials import walks
from peopleboy.scenarios.studies.distance_learning.show_distances import print_trials
from peopleboy.tracker.panoramic.paper.appearance_file import SHIPPED, AppearanceModel
from peopleboy.tracker.panoramic.paper.distance_network import Lessons, teach
from peopleboy.tracker.panoramic.paper.panorama_view import PanoramaView
from peopleboy.tracker.panoramic.paper.paper_tracker import PANORAMA
from peopleboy.tracker.panoramic.paper.position_filter import estimate_noise


def give_distance_lesson(
    out: Path, scenario: str, seeds: int, workers: Workers, *, lessons: Lessons, trials: bool, ship: bool
) -> Path:
    """Learn distances from a scenario, and leave the examples and the network in a folder.

    Examples that an earlier lesson left there are used, as long as neither code nor scenario has changed.

    Args:
        out: the folder.
        scenario: name or path; its first panoramas are empty, and one person at a time is there later.
        seeds: runs of it.
        workers: who runs them.
        lessons: how the network is taught.
        trials: whether to repeat the paper's experiments first.
        ship: whether to put the network in the place of the tracker's own.

    Returns:
        The network's file.

    Raises:
        BadInput: an unknown scenario, one that does not begin empty, or a path that cannot be used.
        TasksFailed: some runs failed, after all others were done.
    """
    loaded = load_scenario(scenario)
    with writing_to(out):
        out.mkdir(parents=True, exist_ok=True)
    store = Store(out / "examples.jsonl", code_digest(Path(distance_examples.__file__)))
    seeing = loaded.mounting((PANORAMA,))
    tasks = [DistanceTask(scenario, seed, film_key(seeing, seed)[:12]) for seed in range(seeds)]
    missing = [task for task in tasks if task.name not in store]
    work_through(missing, workers, "examples", lambda task, result: store.add(task.name, result))
    results = [store[task.name] for task in tasks]
    runs = [Examples.of_rows(result["rows"]) for result in results]
    _check_runs(runs, scenario)
    if trials:
        print_trials(runs, lessons)
    model = _learn(loaded.name, runs, results, lessons)
    path = SHIPPED if ship else out / SHIPPED.name
    path.parent.mkdir(parents=True, exist_ok=True)
    model.save(path)
    return path


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
