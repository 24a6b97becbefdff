"""Films of worlds by which no trees are taught, which would be surer of what they know."""

from __future__ import annotations

from pathlib import Path
from typing import Final, NamedTuple

from peopleboy.scenarios.run_folder.atomic_output import writing_to
from peopleboy.scenarios.running.engine.engine import work_through
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.people_learning.people_film_task import PeopleFilmTask
from peopleboy.studies.training.people_learning.worlds_to_learn_from import KINDS, LATER

_HELD_BACK: Final = 10  # of so many worlds one is not learned from


class Films(NamedTuple):
    """Films to learn from, and others that tell how good what was learned is."""

    learned: list[PeopleFilmTask]
    held: list[PeopleFilmTask]


def films_in(out: Path, workers: Workers, worlds: int) -> Films:
    """Leave films of so many later worlds in a folder; those that are there are used.

    Raises:
        BadInput: a path that cannot be used.
        TasksFailed: some films failed, after all others were done.
    """
    films = out / "films"
    with writing_to(out):
        films.mkdir(parents=True, exist_ok=True)
    tasks = [PeopleFilmTask(str(films), seed) for seed in later_seeds(worlds)]
    work_through([task for task in tasks if not task.film.is_file()], workers, "films")
    held = [task for task in tasks if task.seed % _HELD_BACK == _HELD_BACK - 1] or tasks[-1:]
    return Films([task for task in tasks if task not in held], held)


def later_seeds(worlds: int) -> list[int]:
    """Give the seeds of so many worlds by which no trees are taught."""
    return [seed + LATER for kind in KINDS for seed in kind.seeds(worlds)]
