from pathlib import Path

import pytest

from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.studies.training.look_learning.films_of_later_worlds import films_in, later_seeds
from peopleboy.studies.training.people_learning.people_film_task import PeopleFilmTask
from peopleboy.studies.training.people_learning.worlds_to_learn_from import KINDS, LATER, world_of


def test_later_worlds_are_of_the_same_kinds_and_no_trees_were_taught_on_them() -> None:
    seeds = later_seeds(2000)
    assert len(seeds) == len(set(seeds)) == 2000
    taught = {seed for kind in KINDS for seed in kind.seeds(1500)}
    assert not taught & set(seeds)
    crowd = KINDS[1]
    assert world_of(LATER + crowd.first_seed) == crowd.draw(LATER + crowd.first_seed)


def test_one_of_ten_is_held_back_and_films_that_are_there_are_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made: list[int] = []

    def film(task: PeopleFilmTask, _: object) -> None:
        made.append(task.seed)
        task.film.touch()

    monkeypatch.setattr(PeopleFilmTask, "__call__", film)
    first, again = (films_in(tmp_path, Workers(1), 100) for _ in range(2))
    assert sorted(made) == sorted(later_seeds(100))
    assert first == again
    assert all(task.seed % 10 == 9 for task in first.held)
    assert len(first.learned) + len(first.held) == 100
