from pathlib import Path

import numpy as np
import pytest

from peopleboy.studies.training.look_learning.closer_look_examples import closer_looks_of
from peopleboy.studies.training.people_learning.shots import PeopleShot, shots_of
from peopleboy.tracker.proposals.looks.closer_look import CloserLook
from tests.helpers.images.drawn_films import drawn_film


@pytest.fixture(scope="module")
def shots(tmp_path_factory: pytest.TempPathFactory) -> list[PeopleShot]:
    path = Path(tmp_path_factory.mktemp("films")) / "film.npz"
    drawn_film(0, 4).save(path)
    return list(shots_of([path]))


def test_boxes_are_about_people_and_offsets_lead_to_them(shots: list[PeopleShot]) -> None:
    looks = closer_looks_of(shots, np.random.default_rng(0), varies=False)
    people = sum(len(shot.box) for shot in shots)
    assert 0 < len(looks.overlap) <= people
    assert looks.crops.shape[1:3] == CloserLook.FORM.crop[:2]
    assert len({len(each) for each in looks}) == 1
    assert 0.6 < looks.overlap.mean() < 0.95
    assert np.abs(looks.offsets[:, 0]).max() < 0.2
    assert np.abs(looks.offsets[:, 2]).max() < 0.7


def test_each_image_is_learned_from_four_times(shots: list[PeopleShot]) -> None:
    once = closer_looks_of(shots, np.random.default_rng(1), varies=False)
    often = closer_looks_of(shots, np.random.default_rng(1), varies=True)
    assert 2.0 * len(once.overlap) < len(often.overlap) <= 4.0 * sum(len(shot.box) for shot in shots)
    assert (once.numbers[:, 8] == 1.0).all()
    assert 0.2 < (often.numbers[:, 8] == 0.0).mean() < 0.7


def test_the_same_random_numbers_give_the_same_examples(shots: list[PeopleShot]) -> None:
    one, same = (closer_looks_of(shots, np.random.default_rng(1), varies=True) for _ in range(2))
    for a, b in zip(one, same, strict=True):
        np.testing.assert_array_equal(a, b, strict=True)


def test_who_is_mostly_outside_is_not_learned_from(shots: list[PeopleShot]) -> None:
    shot = shots[0]
    away = PeopleShot(
        shot.grey,
        shot.change,
        shot.mount,
        np.array([[-9.0, 20.0, 10.0, 60.0], [50.0, 20.0, 3.0, 12.0]]),
        np.ones(2, np.bool_),
        np.ones(2, np.bool_),
    )
    assert len(closer_looks_of([away], np.random.default_rng(0), varies=False).overlap) == 0
