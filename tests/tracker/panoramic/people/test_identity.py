from dataclasses import replace

import numpy as np
import pytest

from peopleboy.tracker.panoramic.people.band_colours import BANDS, BandColours
from peopleboy.tracker.panoramic.people.floor_motion import FloorMotion
from peopleboy.tracker.panoramic.people.panoramic_config import IdentityConfig
from peopleboy.tracker.panoramic.people.panoramic_tracks import Register
from tests.helpers.images.cardboard import Cardboard
from tests.helpers.images.cardboard_stage import Stage

CONFIG = IdentityConfig()
RED, BLUE, GREEN = (
    BandColours(np.tile(np.array(colour, np.float32), (BANDS, 1)))
    for colour in ((1.6, 0.3, 0.3), (0.3, 0.3, 1.6), (0.3, 1.6, 0.3))
)


def somebody():
    """A person as the tracker makes one."""
    stage = Stage()
    stage.show(Cardboard(3.0, 0.0))
    (found,) = stage.tracker._persons
    return found


TEMPLATE = somebody()


def person(number=0, place=(0.0, 0.0), clothing=RED, seen_s=0.0, **further):
    return replace(
        TEMPLATE,
        id=number,
        motion=FloorMotion.begin(np.array(place, float), 0.01 * np.eye(2)),
        seen_s=seen_s,
        clothing=clothing,
        **{"born_s": 0.0, "newest": clothing} | further,
    )


def test_newcomers_are_counted():
    register = Register(CONFIG)
    assert [register.named(person(clothing=clothing), 0.0).id for clothing in (RED, BLUE, RED)] == [
        1,
        2,
        3,
    ]


def test_who_comes_back_has_its_old_number_age_and_looks_and_only_once():
    register = Register(CONFIG)
    first = register.named(person(clothing=RED, born_s=1.0), 1.0)
    register.leave([first], 5.0)
    back = register.named(person(clothing=RED, born_s=6.0, seen_s=6.0), 6.0)
    assert (back.id, back.born_s, back.clothing) == (1, 1.0, first.clothing)
    assert register.named(person(clothing=RED), 6.0).id == 2


@pytest.mark.parametrize(
    ("initiate", "gone_s"),
    [
        ({"clothing": BLUE}, 1.0),
        ({"place": (2.0 + CONFIG.reach_m + CONFIG.fastest_m_s, 0.0)}, 2.0),
        ({}, CONFIG.forget_s + 0.1),
    ],
    ids=["other clothes", "farther than it can have walked", "after too long"],
)
def test_who_cannot_be_the_one_who_went_gets_a_new_number(initiate, gone_s):
    register = Register(CONFIG)
    register.leave([register.named(person(), 0.0)], 0.0)
    register.leave([], gone_s)
    assert register.named(person(seen_s=gone_s, **initiate), gone_s).id == 2


def test_with_time_somebody_may_come_back_farther_away():
    far = (CONFIG.reach_m + 5.0 * CONFIG.fastest_m_s - 0.1, 0.0)
    for gone_s, number in ((4.0, 2), (5.0, 1)):
        register = Register(CONFIG)
        register.leave([register.named(person(), 0.0)], 0.0)
        assert register.named(person(place=far, seen_s=gone_s), gone_s).id == number


def test_of_several_who_went_the_most_alike_comes_back():
    register = Register(CONFIG)
    gone = [register.named(person(clothing=clothing), 0.0) for clothing in (BLUE, RED, GREEN)]
    register.leave(gone, 0.5)
    assert [register.named(person(clothing=clothing), 1.0).id for clothing in (GREEN, RED, BLUE)] == [
        3,
        2,
        1,
    ]


def test_who_has_no_number_is_not_remembered():
    register = Register(CONFIG)
    register.leave([person(0)], 0.0)
    assert register.named(person(), 0.1).id == 1


def test_two_who_were_taken_for_each_other_get_their_own_numbers_back():
    register = Register(CONFIG)
    red, blue = (register.named(person(clothing=clothing), 0.0) for clothing in (RED, BLUE))
    long = CONFIG.strange_s + 0.01
    swapped = [
        person(red.id, clothing=RED, newest=BLUE, strange_s=long),
        person(blue.id, clothing=BLUE, newest=RED, strange_s=long),
    ]
    first, second = register.resolve_swaps(swapped, 3.0)
    assert (first.id, second.id) == (blue.id, red.id)
    assert (first.clothing, second.clothing) == (BLUE, RED)
    assert first.strange_s == second.strange_s == 0.0


def test_who_looks_strange_only_for_a_moment_keeps_its_number():
    register = Register(CONFIG)
    red = register.named(person(), 0.0)
    briefly = person(red.id, newest=BLUE, strange_s=0.9 * CONFIG.strange_s)
    assert register.resolve_swaps([briefly], 1.0) == (briefly,)


def test_a_stranger_whom_nobody_knows_gets_a_new_number_and_the_old_one_waits_for_its_owner():
    register = Register(CONFIG)
    red = register.named(person(), 0.0)
    other = person(red.id, newest=GREEN, strange_s=CONFIG.strange_s, born_s=0.0)
    (now,) = register.resolve_swaps([other], 4.0)
    assert now.id == 2
    assert now.clothing is GREEN
    assert now.born_s == 4.0
    assert register.named(person(clothing=RED), 5.0).id == red.id
