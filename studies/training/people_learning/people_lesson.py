"""The whole lesson: films of random worlds, rounds of mistakes, and how good it is in other worlds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from peopleboy.scenarios.run_folder.atomic_output import atomic, writing_to
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.people_learning.boosting import Boosting
from peopleboy.studies.training.people_learning.judge_detector import judge_detector, log_odds_line
from peopleboy.studies.training.people_learning.patch_pool import patch_pool
from peopleboy.studies.training.people_learning.people_film_task import PeopleFilmTask
from peopleboy.studies.training.people_learning.shots import PeopleShot, shots_of
from peopleboy.studies.training.people_learning.teach_cascade import teach_cascade
from peopleboy.studies.training.people_learning.teach_placing import teach_placing
from peopleboy.studies.training.people_learning.window_mining import (
    mistakes,
    windows_anywhere,
    windows_let_through,
    windows_with_people,
)
from peopleboy.studies.training.people_learning.worlds_to_learn_from import KINDS
from peopleboy.tracker.proposals.cascade import Cascade
from peopleboy.tracker.proposals.model import WEIGHTS, PeopleModel, PeopleTrees, shipped_model
from peopleboy.tracker.proposals.window import Kind

TESTS: Final = 30
"""Worlds to judge by: those of the first seeds."""

ROUNDS: Final = {
    Kind.WHOLE: (
        Boosting(64, 0.3, features=200),
        Boosting(160, 0.2, features=300),
        Boosting(320, 0.15, features=300),
        Boosting(640, 0.12, features=300),
        Boosting(1500, 0.1),
    ),
    Kind.CUT: (
        Boosting(64, 0.3, features=200),
        Boosting(160, 0.2, features=300),
        Boosting(320, 0.15, features=300),
        Boosting(500, 0.1, features=300),
    ),
}
"""After each but the last, mistakes are collected, and learned from in the next."""

_SEED_OF_PEOPLE: Final = 0
_SEED_OF_PLACES: Final = 1
_SEED_OF_OTHERS: Final = 100
_HELD_BACK: Final = 10  # of so many worlds one is not learned from
_MISTAKES: Final = 16000  # a round
_OTHERS: Final = 80000  # windows without people that are in memory: 3.6 kB each
_FIRST_OTHERS: Final = 16000


def give_people_lesson(
    out: Path, workers: Workers, *, worlds: int, kinds: Sequence[Kind], only_places: bool, ship: bool
) -> Path:
    """Learn what people look like to a thermal camera, and leave films and trees in a folder.

    Films that are there are used.

    Args:
        out: the folder.
        workers: who films.
        worlds: how many to learn from, one of each kind at least; a tenth is held back, to make scores log
            odds.
        kinds: of windows that are taught; trees for others stay the tracker's own.
        only_places: whether trees that tell whether somebody is in a window stay so, too.
        ship: whether to put the trees in the place of the tracker's own.

    Returns:
        The file of the trees.

    Raises:
        BadInput: a path that cannot be used, scikit-learn is missing, or too few people.
        TasksFailed: some films failed, after all others were done.
    """
    films = out / "films"
    with writing_to(out):
        films.mkdir(parents=True, exist_ok=True)
    tests = [PeopleFilmTask(str(films), seed) for seed in range(TESTS)]
    seeds = [seed for kind in KINDS for seed in kind.seeds(worlds)]
    tasks = [PeopleFilmTask(str(films), seed) for seed in seeds]
    work_through([task for task in (*tests, *tasks) if not task.film.is_file()], workers, "films")
    held = tasks[_HELD_BACK - 1 :: _HELD_BACK] or tasks[-1:]
    lessons = [task.film for task in tasks if task not in held]
    shots = list(shots_of(lessons))
    if only_places:
        taught = {kind: placed_anew(shots, shipped_model().trees[kind].cascade, kind) for kind in kinds}
    else:
        taught = teach(shots, list(shots_of(task.film for task in held)), kinds)
    drawn = ", ".join(f"{len(kind.seeds(worlds))} {kind.words} from seed {kind.first_seed}" for kind in KINDS)
    what = ("where {} people are",) if only_places else ("{} people", "where {} people are")
    learned_from = {
        each.format(kind): f"{drawn}; {len(held)} of them held back" for each in what for kind in kinds
    }
    before = shipped_model() if only_places or len(taught) < len(Kind) else PeopleModel({})
    model = PeopleModel({**before.trees, **taught}, {**before.about, **learned_from})
    path = WEIGHTS if ship else out / WEIGHTS.name
    with writing_to(path.parent), atomic(path) as part:
        path.parent.mkdir(parents=True, exist_ok=True)
        told = _judged(model, [task.film for task in tests])
        replace(model, about={**model.about, **told}).save(part)
    return path


def teach(
    shots: Sequence[PeopleShot], others_of: Sequence[PeopleShot], kinds: Sequence[Kind]
) -> dict[Kind, PeopleTrees]:
    """Teach trees on images, each time with the mistakes of those before.

    Args:
        shots: to learn from.
        others_of: of other worlds, by which scores are made log odds.
        kinds: of windows.

    Raises:
        BadInput: scikit-learn is missing, or too few people.
    """
    return {kind: _taught(shots, others_of, kind) for kind in kinds}


def _taught(shots: Sequence[PeopleShot], others_of: Sequence[PeopleShot], kind: Kind) -> PeopleTrees:
    people = windows_with_people(shots, np.random.default_rng(_SEED_OF_PEOPLE), kind)
    rng = np.random.default_rng(_SEED_OF_OTHERS)
    patches = patch_pool()
    others = windows_anywhere(shots, rng, _FIRST_OTHERS, kind)
    _say(f"{len(shots)} images, {len(people)} windows with {kind} people")
    rounds = ROUNDS[kind]
    for number, boosting in enumerate(rounds, 1):
        cascade = teach_cascade(people, others, patches, boosting)
        if number < len(rounds):
            found = mistakes(shots, cascade, rng, _MISTAKES, kind)
            _say(f"round {number} of {len(rounds)}: {len(others)} windows without, {len(found)} mistakes")
            others = _some(np.concatenate([others, found]), _OTHERS, rng)
    trees = placed_anew(shots, cascade, kind)
    return trees._replace(cascade=cascade.calibrated(*log_odds_line(kind, trees, others_of)))


def placed_anew(shots: Sequence[PeopleShot], cascade: Cascade, kind: Kind) -> PeopleTrees:
    """Teach where people are in the windows that trees take for such.

    Windows that people fill would not do: of those that are let through many are too small or too large,
    and would be believed.
    """
    windows, places = windows_let_through(shots, cascade, np.random.default_rng(_SEED_OF_PLACES), kind)
    _say(f"{len(windows)} windows taken for {kind} people, where some are")
    return PeopleTrees(cascade, teach_placing(windows, places, cascade.patches))


def _some(windows: NDArray[np.float16], most: int, rng: np.random.Generator) -> NDArray[np.float16]:
    return windows if len(windows) <= most else windows[rng.permutation(len(windows))[:most]]


def _judged(model: PeopleModel, films: Sequence[Path]) -> dict[str, str]:
    """Say in words how well it does in worlds that it has not seen."""
    told = {
        f"on worlds 0 to {TESTS - 1}, {mount}": judge_detector(
            model, shots_of(films), knows_mount=mount == "mount known"
        ).in_words()
        for mount in ("mount known", "mount unknown")
    }
    for where, words in told.items():
        _say(f"{where}: {words}")
    return told


def _say(words: str) -> None:
    Console(stderr=True).print(words, highlight=False)
