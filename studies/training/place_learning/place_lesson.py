"""The whole lesson: films, examples, networks, and how good they are on scenes that nobody learned from."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Final

import numpy as np
from rich.console import Console

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.run_folder.atomic_output import writing_to
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.foreground_learning.foreground_lesson import FIRST_SEED
from peopleboy.studies.training.place_learning import place_examples
from peopleboy.studies.training.place_learning.place_examples import PlaceExamples
from peopleboy.studies.training.place_learning.place_task import PlaceTask, panorama_of
from peopleboy.studies.training.place_learning.teach_places import teach_places
from peopleboy.tracker.panoramic.foreground.network_file import SHIPPED as EYES
from peopleboy.tracker.panoramic.panorama_view import view_of
from peopleboy.tracker.panoramic.people.place_file import SHIPPED, save_places
from peopleboy.tracker.panoramic.people.place_model import PlaceModel

LIBRARY: Final = {"room_long": 12, "panoramic_crossing": 10, "panoramic_moving": 14}
"""How many runs of scenarios of the library are learned from, too."""

TESTS: Final = 20
"""How many scenes, the first ones, are for judging."""


def give_place_lesson(out: Path, films: Path, workers: Workers, *, scenes: int, ship: bool) -> Path:
    """Learn to read where people stand, and leave examples and networks in a folder.

    Films and examples that are there are used; examples belong to the network that tells people from
    background.

    Args:
        out: the folder.
        films: folder of the films, which `train-foreground` uses, too.
        workers: who films.
        scenes: how many to learn from.
        ship: whether to put the networks in the place of the tracker's own.

    Returns:
        The networks' file.

    Raises:
        BadInput: a path that cannot be used, or scikit-learn is missing.
        TasksFailed: some films failed, after all others were done.
    """
    examples = out / f"examples-{_eyes_digest()}"
    with writing_to(films, "--films"):
        films.mkdir(parents=True, exist_ok=True)
    with writing_to(out):
        examples.mkdir(parents=True, exist_ok=True)
    task = partial(PlaceTask, films=str(films), examples=str(examples))
    tests = [task(seed=seed) for seed in range(TESTS)]
    tasks = [task(seed=seed) for seed in range(FIRST_SEED, FIRST_SEED + scenes)]
    tasks += [
        task(scenario=name, seed=FIRST_SEED + k) for name, count in LIBRARY.items() for k in range(count)
    ]
    work_through([task for task in (*tests, *tasks) if not task.path.is_file()], workers, "examples")
    learned = _load(tasks)
    model = teach_places(learned)
    words = _judgement(model, _load(tests))
    Console(stderr=True).print(f"on other scenes: {words}", highlight=False)
    calibration = panorama_of(load_scenario(next(iter(LIBRARY))), FIRST_SEED)
    path = SHIPPED if ship else out / SHIPPED.name
    with writing_to(path.parent):
        path.parent.mkdir(parents=True, exist_ok=True)
    people = int(learned.is_person.sum())
    about = {
        "trained on": f"{people} looks at people and {len(learned.distance_m) - people} at none, "
        f"in {scenes} scenes drawn at random, and {', '.join(LIBRARY)}, seeds from {FIRST_SEED}",
        "on other scenes": words,
    }
    save_places(path, model, view_of(calibration, calibration.width, calibration.height), about)
    return path


def _load(tasks: Sequence[PlaceTask]) -> PlaceExamples:
    return PlaceExamples.joined([PlaceExamples.load(task.path) for task in tasks])


def _eyes_digest() -> str:
    """A hash of what examples depend on beside the films."""
    digest = sha256(EYES.read_bytes())
    digest.update(Path(place_examples.__file__).read_bytes())
    return digest.hexdigest()[:8]


def _judgement(model: PlaceModel, examples: PlaceExamples) -> str:
    """Say in words how well the networks do."""
    told = model.look(examples.patches.astype(np.float32), examples.distance_m)
    is_person, is_found = examples.is_person, told.evidence > 0
    along, across = np.abs(told.offset_m - examples.offset_m)[is_person].mean(axis=0)
    squared = ((told.offset_m - examples.offset_m) / told.deviation_m)[is_person] ** 2
    return (
        f"off by {along:.3f} m in distance and {across:.3f} m across, squares of that over what is believed "
        f"{squared.mean():.2f}; people found {is_found[is_person].mean():.1%}, "
        f"seen where none are {is_found[~is_person].mean():.1%}"
    )
