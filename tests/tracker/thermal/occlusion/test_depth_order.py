from types import SimpleNamespace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.thermal.occlusion.depth_order import (
    ExpectedPerson,
    front_to_back,
    likelier_front,
    lower_foot,
    plainer_contour,
)

VIEW = SimpleNamespace(size=1.0)


def figure(number, foot, unlikeness=0.0, fit=0.0):
    person = SimpleNamespace(id=number, foot=foot)
    return ExpectedPerson(person, np.zeros(9), np.zeros(4), unlikeness, fit)


@given(st.lists(st.floats(0, 300), min_size=1, max_size=8), st.randoms())
def test_people_are_sorted_by_their_feet_whatever_their_sequence(feet, random):
    figures = [figure(number, foot) for number, foot in enumerate(feet)]
    mixed = random.sample(figures, len(figures))
    order = [one.person.id for one in front_to_back(mixed, lower_foot, VIEW)]
    assert order == sorted(range(len(feet)), key=lambda number: (-feet[number], number))


@given(st.lists(st.tuples(st.floats(0, 300), st.floats(0, 100), st.floats(-1, 1)), max_size=8), st.randoms())
def test_everybody_is_in_the_order_once_even_if_nobody_can_be_told_apart(people, random):
    figures = [figure(number, *each) for number, each in enumerate(people)]

    def at_random(*_):
        return random.choice((-1.0, 0.0, 1.0))

    for order in (likelier_front, plainer_contour, at_random):
        ids = [one.person.id for one in front_to_back(figures, order, VIEW)]
        assert sorted(ids) == list(range(len(people)))


def test_the_lead_of_one_is_the_lag_of_the_other():
    one, other = figure(1, 200.0, 30.0, 0.3), figure(2, 196.0, 5.0, 0.5)
    for order in (likelier_front, plainer_contour):
        assert order(one, other, VIEW) == -order(other, one, VIEW) != 0


def test_looks_outweigh_feet_that_are_hardly_lower():
    hidden, front = figure(1, 201.0, unlikeness=60.0), figure(2, 200.0, unlikeness=2.0)
    assert lower_foot(hidden, front, VIEW) > 0
    assert likelier_front(hidden, front, VIEW) < 0


def test_a_contour_that_is_seen_whole_outweighs_feet_that_are_much_lower():
    seen, supposed = figure(1, 257.0, fit=0.57), figure(2, 290.0, fit=0.42)
    assert likelier_front(seen, supposed, VIEW) < 0
    assert plainer_contour(seen, supposed, VIEW) > 0


def test_contours_that_are_seen_alike_leave_it_to_the_feet():
    near, far = figure(1, 220.0, fit=0.50), figure(2, 180.0, fit=0.52)
    assert plainer_contour(near, far, VIEW) > 0
