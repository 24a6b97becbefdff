from types import SimpleNamespace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from peopleboy.tracker.reproductions.contour.occlusion.depth_order import (
    ExpectedPerson,
    likelier_front,
    lower_foot,
    sorted_by_lead,
)

VIEW = SimpleNamespace(size=1.0)


def figure(number, foot, unlikeness=0.0):
    person = SimpleNamespace(id=number, foot=foot)
    return ExpectedPerson(person, np.zeros(9), np.zeros(4), unlikeness)


@given(st.lists(st.floats(0, 300), min_size=1, max_size=8), st.randoms())
def test_people_are_sorted_by_their_feet_whatever_their_sequence(feet, random):
    figures = [figure(number, foot) for number, foot in enumerate(feet)]
    mixed = random.sample(figures, len(figures))
    order = [mixed[row].person.foot for row in sorted_by_lead(lower_foot(mixed, VIEW))]
    assert order == sorted(feet, reverse=True)


@given(st.lists(st.tuples(st.floats(0, 300), st.floats(0, 100)), max_size=8))
def test_the_lead_of_one_is_the_lag_of_the_other(people):
    figures = [figure(number, *each) for number, each in enumerate(people)]
    for order in (lower_foot, likelier_front):
        lead = order(figures, VIEW)
        assert np.array_equal(lead, -lead.T)


def test_a_lower_foot_and_clearer_looks_count_as_they_are_weighed():
    one, other = figure(1, 200.0, 30.0), figure(2, 196.0, 5.0)
    assert likelier_front([one, other], VIEW)[0, 1] == 4 / 4 - 25 / 12


def test_looks_outweigh_feet_that_are_hardly_lower():
    hidden, front = figure(1, 201.0, unlikeness=60.0), figure(2, 200.0, unlikeness=2.0)
    assert lower_foot([hidden, front], VIEW)[0, 1] > 0
    assert likelier_front([hidden, front], VIEW)[0, 1] < 0


@given(st.permutations(range(5)), st.data())
def test_leads_that_agree_with_an_order_give_that_order_back(order, data):
    place = np.argsort(order)
    lead = np.sign(place[None] - place[:, None]).astype(float)
    # Any pair that is not next to each other may not overlap at all.
    for i in range(5):
        for j in range(i):
            if abs(place[i] - place[j]) > 1 and data.draw(st.booleans()):
                lead[i, j] = lead[j, i] = 0
    assert sorted_by_lead(lead) == tuple(order)


@given(arrays(np.float64, (6, 6), elements=st.sampled_from([-1.0, -0.5, 0.0, 0.5, 1.0])))
def test_any_leads_give_an_order_of_everybody_even_in_circles(wild):
    lead = wild - wild.T
    order = sorted_by_lead(lead)
    assert sorted(order) == list(range(6))
    assert (lead[order[0]] < 0).sum() == (lead < 0).sum(axis=1).min()


def test_in_a_circle_the_clearest_lead_decides():
    lead = np.array([[0, 0.2, -0.9], [-0.2, 0, 0.4], [0.9, -0.4, 0]])
    assert sorted_by_lead(lead) == (2, 0, 1)
    assert sorted_by_lead(np.sign(lead)) == (0, 1, 2)
