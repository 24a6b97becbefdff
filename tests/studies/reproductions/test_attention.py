"""How absences and followers are counted, on rows written down by hand."""

import pytest

from peopleboy.studies.reproductions.experiments.attention import (
    CHOICES,
    DEFAULT,
    PRINTED_NAME,
    longest_gap,
    resumptions,
    score_absence,
    watch_absence,
    watch_focus,
)
from peopleboy.tracker.reproductions.attention.attention_config import PRINTED, AttentionConfig


def test_the_longest_time_out_of_sight_is_the_absence_and_who_is_half_in_the_door_is_not_back():
    assert longest_gap([1.0, 0.9, 0.2, 0.9, 0.1, 0.0, 0.0, 0.4, 0.5, 0.7, 1.0]) == (4, 9)


def test_an_absence_counts_who_else_has_the_number_and_how_late_it_is_right():
    visible = [1.0] * 4 + [0.0] * 4 + [1.0] * 4
    rows = (
        [{1: "anna"}] * 4 + [{1: "anna"}, {1: "bert"}, {2: "bert"}, {}] + [{}, {3: "anna"}, {1: "anna"}, {}]
    )
    found = score_absence(rows, visible, "anna", 2.0)
    assert found == {"away": 4, "accepted": 1, "late_s": 1.0, "found_s": 0.5}
    assert score_absence(rows[:9] + [{}] * 3, visible, "anna", 2.0)["late_s"] is None


def test_a_follower_goes_on_with_the_person_only_if_with_nobody_else_before():
    anna, bert = "anna", "bert"
    followed = [anna, None, None, None, anna, None, anna, None, bert, None, anna, None, None, None]
    assert resumptions(followed, anna, 2, 3) == [True, False, False]
    assert resumptions(followed, anna, 2, 4) == [True, False]
    assert resumptions([anna, None, anna], anna, 2, 2) == []
    assert resumptions([None] * 9, anna, 2, 2) == []


def test_ways_to_look_begin_as_printed_and_end_with_the_default():
    names = list(CHOICES)
    assert (names[0], names[-1]) == (PRINTED_NAME, DEFAULT)
    assert (CHOICES[PRINTED_NAME], CHOICES[DEFAULT]) == (PRINTED, AttentionConfig())


@pytest.mark.slow
def test_people_of_a_short_film_are_looked_for_and_the_default_finds_most():
    found = watch_focus("crossing_3", 100, [PRINTED_NAME, DEFAULT], 4.0)
    rows = found[DEFAULT]
    assert set(rows) == {"1", "2", "3"}
    right, *others = (sum(row[k] for row in rows.values()) for k in range(3))
    assert right > 4 * sum(others)


@pytest.mark.heavy
@pytest.mark.parametrize("name", ["attentive"])
def test_a_tracker_that_knows_people_again_takes_nobody_else_for_them(name):
    found = watch_absence("absence_10s", 100, [name])[name]
    assert found["accepted"] == 0
    assert found["late_s"] is not None
    assert found["late_s"] < 1.5
