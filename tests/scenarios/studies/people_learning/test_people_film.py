from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.random_worlds.random_world import random_scenario, random_world
from peopleboy.scenarios.studies.people_learning.people_film import PeopleFilm, film_upright
from peopleboy.scenarios.studies.people_learning.people_film_task import PeopleFilmTask, as_the_library
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.thermal.mount import Mount


def test_a_film_of_a_random_world_tells_who_is_where(tmp_path: Path) -> None:
    film = film_upright(random_scenario(3, 0.4), 3)
    assert film.grey.shape == film.change.shape
    assert len(film.grey) == 1
    assert film.box.shape == (len(film.image), 4)
    assert set(film.image.tolist()) <= set(range(len(film.grey)))
    film.save(tmp_path / "film.npz")
    read = PeopleFilm.load(tmp_path / "film.npz")
    for name in film.__dataclass_fields__:
        np.testing.assert_array_equal(getattr(read, name), getattr(film, name))
    assert isinstance(read.seen_by(), Mount)


@pytest.mark.parametrize("seed", [3, 9])
def test_a_world_as_the_library_is_seen_plainly_from_24_to_36_degrees(seed: int) -> None:
    before = random_world(seed)
    world = parse_scenario(as_the_library(before), source="world", folder=Path()).world(seed)
    thermal = world.robot.cameras[THERMAL]
    assert (thermal.gain, thermal.lowest_c, thermal.highest_c) == ("fixed", 24.0, 36.0)
    assert before == random_world(seed)  # left alone


@pytest.mark.parametrize(("seed", "is_warm"), [(1, True), (3, False), (4, True), (6, False)])
def test_a_world_as_the_library_is_cold_without_sun_and_details(seed: int, is_warm: bool) -> None:
    before = random_world(seed)
    world = as_the_library(before)
    assert "sun" not in world["place"]
    assert world["detail"] == "plain"
    assert world["place"].get("temperatures") == (None if is_warm else before["place"]["temperatures"])


def test_every_third_world_is_seen_as_the_library() -> None:
    tasks = [PeopleFilmTask("films", seed) for seed in (1001, 1002)]
    assert [task.is_own for task in tasks] == [False, True]
    assert [task._scenario().world(task.seed).robot.cameras[THERMAL].gain == "fixed" for task in tasks] == [
        task.is_own for task in tasks
    ]
