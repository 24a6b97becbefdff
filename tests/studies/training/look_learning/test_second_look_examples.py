from pathlib import Path

import numpy as np
import pytest

from peopleboy.studies.training.look_learning.examples import LookExamples
from peopleboy.studies.training.look_learning.second_look_examples import looks_of
from peopleboy.studies.training.people_learning.shots import PeopleShot, shots_of
from peopleboy.tracker.proposals.looks.crops import NUMBERS
from peopleboy.tracker.proposals.looks.second_look import SecondLook
from peopleboy.tracker.proposals.model import shipped_model
from tests.helpers.images.drawn_films import drawn_film


@pytest.fixture(scope="module")
def shots(tmp_path_factory: pytest.TempPathFactory) -> list[PeopleShot]:
    path = Path(tmp_path_factory.mktemp("films")) / "film.npz"
    drawn_film(0, 4).save(path)
    return list(shots_of([path]))


def looked(shots: list[PeopleShot], *, varies: bool, seed: int = 0) -> LookExamples:
    return looks_of(shots, shipped_model(), np.random.default_rng(seed), varies=varies)


def test_what_is_proposed_is_told_with_whom_it_shows(shots: list[PeopleShot]) -> None:
    looks = looked(shots, varies=False)
    assert looks.crops.shape[1:3] == SecondLook.FORM.crop[:2]
    assert len({len(each) for each in looks}) == 1
    assert looks.overlap.max() > 0.4
    someone = looks.overlap > 0.4
    # Drawn people are wider than torsos.
    assert np.abs(looks.offsets[someone, 3] - 0.3).max() < 0.15


def test_the_same_random_numbers_give_the_same_examples(shots: list[PeopleShot]) -> None:
    one, same, other = (looked(shots, varies=True, seed=seed) for seed in (1, 1, 2))
    for a, b in zip(one, same, strict=True):
        np.testing.assert_array_equal(a, b, strict=True)
    assert one.crops.shape != other.crops.shape or not np.array_equal(one.crops, other.crops)


def test_a_mirror_s_mirror_shows_the_same(shots: list[PeopleShot]) -> None:
    looks = looked(shots, varies=False)
    for a, b in zip(looks.mirrored().mirrored(), looks, strict=True):
        np.testing.assert_array_equal(a, b)
    np.testing.assert_array_equal(looks.mirrored().numbers[:, 4], looks.numbers[:, 5])
    np.testing.assert_array_equal(looks.mirrored().offsets[:, 0], -looks.offsets[:, 0])


def test_no_images_give_no_examples() -> None:
    none = looked([], varies=True)
    assert none.numbers.shape == (0, NUMBERS)
