from __future__ import annotations

import numpy as np
import pytest

from peopleboy.sim.people.person import Person
from peopleboy.sim.people.person_config import PersonConfig, Waypoint


def standing(height_m: float = 1.75, **more: bool) -> Person:
    path = (Waypoint(at_m=(1.0, 2.0), pause_s=9.0, face=(3.0, 2.0)), Waypoint(at_m=(4.0, 2.0)))
    return Person(PersonConfig(name="anna", path=path, height_m=height_m, **more), np.random.default_rng(0))


@pytest.mark.parametrize("height_m", [1.55, 1.75, 1.95])
@pytest.mark.parametrize(
    "point", [(1.5, 1.8, 1.2), (1.5, 1.8, 0.9), (1.4, 2.0, 0.4), (1.6, 1.9, 0.2), (1.2, 1.7, 1.6)]
)
def test_the_palm_is_at_what_is_reached_for_and_the_feet_stay_on_the_floor(
    height_m: float, point: tuple[float, float, float]
) -> None:
    person = standing(height_m)
    person.reach_for(np.array(point), 1.0, np.array(point))
    assert person.palm("right") == pytest.approx(point, abs=0.01)
    joints = person.joints()
    assert joints[15:, 2] == pytest.approx(standing(height_m).joints()[15:, 2], abs=0.03)  # ankles


def test_who_need_not_bend_does_not_and_who_must_bends_down() -> None:
    upright = standing().joints()[0, 2]
    person = standing()
    person.reach_for(np.array([1.4, 1.8, 1.1]), 1.0, np.array([1.4, 1.8, 1.1]))
    assert person.joints()[0, 2] == pytest.approx(upright)
    person.reach_for(np.array([1.4, 1.9, 0.3]), 1.0, np.array([1.4, 1.9, 0.3]))
    assert person.joints()[0, 2] < upright - 0.3


def test_on_the_way_the_hand_is_between_and_afterwards_it_hangs_again() -> None:
    person, point = standing(), np.array([1.5, 1.8, 1.2])
    hanging = person.palm("right")
    person.reach_for(point, 0.5, point)
    half = person.palm("right")
    assert np.linalg.norm(half - point) < np.linalg.norm(hanging - point)
    assert np.linalg.norm(half - hanging) > 0.1
    person.let_go()
    assert person.palm("right") == pytest.approx(hanging)


def test_the_left_hand_takes_what_is_on_the_left_and_all_of_one_who_carries_a_bag() -> None:
    point = np.array([1.4, 2.3, 1.2])
    person = standing()
    person.reach_for(point, 1.0, point)
    assert person.palm("left") == pytest.approx(point, abs=0.01)
    laden, ahead = standing(bag=True), np.array([1.4, 2.0, 1.2])
    laden.reach_for(ahead, 1.0, ahead)
    assert laden.palm("left") == pytest.approx(ahead, abs=0.01)
