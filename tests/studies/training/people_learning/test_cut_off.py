"""Images that cut people off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from peopleboy.studies.training.people_learning import cut_off
from peopleboy.studies.training.people_learning.shots import PeopleShot
from peopleboy.tracker.proposals.window import Kind

HIGH, WIDE = 100, 80


def shot_of(box: tuple[float, float, float, float], shots: list[PeopleShot]) -> PeopleShot:
    flat = np.full((HIGH, WIDE), 90, np.uint8)
    sure = np.ones(1, np.bool_)
    return replace(shots[0], grey=flat, change=flat, box=np.array([box]), is_good=sure, is_clear=sure)


@pytest.mark.parametrize(
    ("box", "is_cut"),
    [
        ((20.0, 5.0, 20.0, 90.0), False),  # whole
        ((20.0, -10.0, 20.0, 90.0), False),  # hardly cut off
        ((20.0, -30.0, 20.0, 100.0), True),  # legs and chest
        ((20.0, 60.0, 20.0, 80.0), True),  # face and chest
        ((20.0, -40.0, 20.0, 170.0), True),  # neither head nor feet
        ((20.0, -70.0, 20.0, 100.0), False),  # shoes and shanks
        ((20.0, 80.0, 20.0, 80.0), False),  # a face
        ((72.0, 60.0, 20.0, 80.0), False),  # an arm
    ],
)
def test_who_is_cut_off_is_somebody_of_whom_a_third_is_left(
    box: tuple[float, float, float, float], is_cut: bool, shots: list[PeopleShot]
) -> None:
    shot = shot_of(box, shots)
    assert cut_off.who_is_cut(shot).tolist() == [is_cut]
    assert not cut_off.who_is_cut(replace(shot, is_clear=np.zeros(1, np.bool_))).any()


def test_images_are_cut_so_that_somebody_is_to_be_learned_from(shots: list[PeopleShot]) -> None:
    whole = shot_of((20.0, 10.0, 20.0, 80.0), shots)
    cut = [cut_off.varied(whole, np.random.default_rng(seed), Kind.CUT) for seed in range(60)]
    assert all(one.is_good.tolist() == cut_off.who_is_cut(one).tolist() for one in cut)
    assert sum(bool(one.is_good.any()) for one in cut) > 20
    assert all(len(one.grey) < HIGH for one in cut if one.is_good.any())


def test_for_whole_windows_images_vary_as_they_do(shots: list[PeopleShot]) -> None:
    one = cut_off.varied(shots[0], np.random.default_rng(4), Kind.WHOLE)
    np.testing.assert_array_equal(one.grey, shots[0].varied(np.random.default_rng(4)).grey)


def test_small_people_are_not_worth_cutting_off(shots: list[PeopleShot]) -> None:
    assert not cut_off.has_people(shot_of((20.0, 10.0, 12.0, 50.0), shots), Kind.CUT)
    assert cut_off.has_people(shot_of((20.0, 10.0, 12.0, 50.0), shots), Kind.WHOLE)
