from types import SimpleNamespace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.thermal.occlusion.depth_order import (
    ExpectedPerson,
    front_to_back,
    likelier_front,
    lower_foot,
)

VIEW = SimpleNamespace(size=1.0)


def figure(number, foot, unlikeness=0.0):
    person = SimpleNamespace(id=number, foot=foot)
    return ExpectedPerson(person, np.zeros(9), np.zeros(4), unlikeness)


@given(st.lists(st.floats(0, 300), min_size=1, max_size=8), st.randoms())
def test_people_are_sorted_by_their_feet_whatever_their_sequence(feet, random):
    figures = [figure(number, foot) for number, foot in enumerate(feet)]
    mixed = random.sample(figures, len(figures))
    order = [one.person.id for one in front_to_back(mixed, lower_foot, VIEW)]
    assert order == sorted(range(len(feet)), key=lambda number: (-feet[number], number))


@given(st.lists(st.tuples(st.floats(0, 300), st.floats(0, 100)), max_size=8), st.randoms())
def test_everybody_is_in_the_order_once_even_if_nobody_can_be_told_apart(people, random):
    figures = [figure(number, *each) for number, each in enumerate(people)]

    def at_random(*_):
        return random.choice((-1.0, 0.0, 1.0))

    for order in (likelier_front, at_random):
        ids = [one.person.id for one in front_to_back(figures, order, VIEW)]
        assert sorted(ids) == list(range(len(people)))


def test_the_lead_of_one_is_the_lag_of_the_other():
    one, other = figure(1, 200.0, 30.0), figure(2, 196.0, 5.0)
    assert likelier_front(one, other, VIEW) == -likelier_front(other, one, VIEW) != 0


def test_looks_outweigh_feet_that_are_hardly_lower():
    hidden, front = figure(1, 201.0, unlikeness=60.0), figure(2, 200.0, unlikeness=2.0)
    assert lower_foot(hidden, front, VIEW) > 0
    assert likelier_front(hidden, front, VIEW) < 0
