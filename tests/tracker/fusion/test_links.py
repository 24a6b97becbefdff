import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.tracker.fusion.handover_links import (
    FLOOR_M2,
    GATE,
    LinkEvidence,
    is_same_way,
    mahalanobis2,
    pairs,
)
from peopleboy.tracker.track import FloorPlace
from tests.helpers.runs.hand_made_tracks import track

PLACES = st.lists(st.tuples(st.floats(-2, 2), st.floats(-2, 2)), max_size=4)


def test_apartness_is_in_standard_deviations_of_both_and_of_what_either_may_be_off():
    one, other = track(1, (3.0, 0.0), deviation_m=0.3), track(2, (3.0, 0.8), deviation_m=0.4)
    assert mahalanobis2(one, other) == pytest.approx(0.8**2 / (0.3**2 + 0.4**2 + FLOOR_M2[0]))
    assert mahalanobis2(one, other) == mahalanobis2(other, one)
    assert mahalanobis2(one, one) == 0.0
    assert mahalanobis2(one, track(3, None)) == np.inf


def test_apartness_counts_along_the_line_of_sight_less_where_that_is_unsure():
    place = FloorPlace(position_m=(2.0, 2.0), covariance_m2=(0.5, 0.45, 0.5))
    one = track(1, (2.0, 2.0))
    unsure = type(one)(id=2, place=place, confidence=1.0, status=one.status, age_s=1.0)
    along, aside = track(3, (2.5, 2.5)), track(3, (2.5, 1.5))
    assert mahalanobis2(unsure, along) < mahalanobis2(unsure, aside) / 3


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        ((2.0, 0.0), (7.0, 0.7), True),
        ((2.0, 0.0), (2.0, 0.25), False),
        ((-3.0, 0.1), (-3.0, -0.1), True),
        ((3.0, 0.0), (-3.0, 0.0), False),
        (None, (2.0, 0.0), False),
    ],
    ids=["farther", "aside", "at the back", "behind", "nowhere"],
)
def test_two_are_in_the_same_direction_however_far_away(one, other, expected):
    assert is_same_way(track(1, one), track(2, other)) is expected
    assert is_same_way(track(1, other), track(2, one)) is expected


@settings(max_examples=60)
@given(PLACES, PLACES)
def test_pairs_are_the_best_of_all_ways_to_pair(ours, theirs):
    ones = [track(k, at) for k, at in enumerate(ours)]
    others = [track(k, at) for k, at in enumerate(theirs)]
    found = pairs(ones, others)
    assert all(mahalanobis2(one, other) < GATE for one, other in found)
    for side in zip(*found, strict=True):
        assert len({one.id for one in side}) == len(side)

    def cost(chosen):
        """What is left alone costs as much as a pair at twice the gate."""
        return sum(min(mahalanobis2(one, other), 2 * GATE) for one, other in chosen)

    few, many = sorted((ones, others), key=len)
    ways = [list(zip(few, chosen, strict=True)) for chosen in itertools.permutations(many, len(few))]
    best = min(map(cost, ways))
    assert cost(found) <= best + 1e-6
    assert cost(found) + 2 * GATE * (len(few) - len(found)) >= best - 1e-6


def test_who_has_no_place_stays_alone():
    assert pairs([track(1, None)], [track(1)]) == pairs([track(1)], []) == []


def stood(*numbers):
    return {number: track(number) for number in numbers}


def test_a_link_needs_so_many_frames_and_goes_as_slowly_as_it_came():
    votes = LinkEvidence(needed=3, most=5)
    for count in range(1, 8):
        votes.count([(1, 7)], stood(1), stood(7))
        assert votes.linked == ({1: 7} if count >= 3 else {})
    for count in range(1, 4):
        votes.count([], stood(1), stood(7))
        assert votes.linked == ({1: 7} if count < 3 else {})


def test_a_single_frame_in_which_two_are_mistaken_changes_nothing():
    votes = LinkEvidence(needed=3, most=15)
    for frame in range(20):
        votes.count([(1, 8)] if frame == 10 else [(1, 7)], stood(1), stood(7, 8))
        if frame >= 2:
            assert votes.linked == {1: 7}


def test_each_track_has_one_mate_at_most():
    votes = LinkEvidence(needed=2, most=9)
    for agreed in ([(1, 7)], [(1, 7)], [(1, 7)], [(2, 7)], [(2, 7)], [(1, 8)], [(1, 8)]):
        votes.count(agreed, stood(1, 2), stood(7, 8))
        assert len(set(votes.linked.values())) == len(votes.linked)


def test_a_link_outlives_one_of_its_tracks_but_not_both():
    votes = LinkEvidence(needed=2, most=9)
    for _ in range(3):
        votes.count([(1, 7)], stood(1), stood(7))
    votes.count([], {}, stood(7))
    assert votes.linked == {1: 7}
    votes.count([], {}, {})
    assert votes.linked == {}
