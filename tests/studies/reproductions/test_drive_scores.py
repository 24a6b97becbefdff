from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from peopleboy.studies.reproductions.experiments.drive_scores import (
    DriveScore,
    FloorPerson,
    TrackingRecord,
    associate,
)
from peopleboy.tracker.track import FloorPlace, Status, Track
from tests.helpers.runs import synthetic_ticks


def person(number: int, x: float, y: float, *, counts: bool = True) -> FloorPerson:
    """Place a person; the surface that is seen is 0.1 m nearer."""
    truth = synthetic_ticks.person(number, "anna", x)
    return FloorPerson((x, y), (x - 0.1, y), is_counted=counts, truth=truth)


def track(number: int, x: float, y: float) -> Track:
    place = FloorPlace(position_m=(x, y), covariance_m2=(0.01, 0.0, 0.01))
    return Track(id=number, boxes={}, place=place, confidence=1.0, status=Status.TRACKED, age_s=1.0)


def record(score: DriveScore) -> TrackingRecord:
    pre = {"bands": [[4, 3], [0, 0], [0, 0], [0, 0]], "false": 2}
    return TrackingRecord.of_plain(score.plain() | {"ms": 1.0, "pre": pre})


def scored(people: Sequence[FloorPerson], tracks: Sequence[Track]) -> TrackingRecord:
    score = DriveScore()
    score.add(1, people, tracks)
    return record(score)


def test_who_is_told_within_a_metre_is_found_and_all_else_is_missed_or_false() -> None:
    one = scored([person(1, 4.0, 0.0), person(2, 6.0, 2.0)], [track(7, 4.0, 0.9), track(8, 6.0, 0.9)])
    assert (one.found(), one.missed, one.false, one.frames) == (1, 1, 1, 1)
    assert one.rate() == 0.5
    assert one.false_per_frame() == 1.0
    assert one.error_m == pytest.approx([0.9])


def test_a_second_track_on_somebody_is_false() -> None:
    one = scored([person(1, 4.0, 0.0)], [track(7, 4.0, 0.1), track(8, 4.0, -0.2)])
    assert (one.found(), one.false) == (1, 1)
    assert one.error_m == pytest.approx([0.1])


def test_a_track_on_somebody_who_does_not_count_is_neither_right_nor_wrong() -> None:
    far = person(2, 11.0, 0.0, counts=False)
    one = scored([far], [track(7, 11.2, 0.0)])
    assert (one.found(), one.missed, one.false) == (0, 0, 0)
    assert np.isnan(one.rate())


def test_those_who_count_go_first() -> None:
    found = associate([person(1, 4.0, 0.0, counts=False), person(2, 4.0, 0.8)], np.array([[4.0, 0.1]]))
    assert found == {1: 0}


def test_distances_are_least_in_all_and_not_one_by_one() -> None:
    people = [person(1, 4.0, 0.0), person(2, 4.0, 0.6)]
    assert associate(people, np.array([[4.0, 0.5], [4.0, 1.4]])) == {0: 0, 1: 1}


def test_a_closer_radius_makes_misses_and_false_alarms_of_hits() -> None:
    one = scored([person(1, 4.0, 0.0)], [track(7, 4.0, 0.5)])
    assert (one.rate(), one.rate(0.3)) == (1.0, 0.0)
    assert (one.false_per_frame(), one.false_per_frame(0.3)) == (0.0, 1.0)


def test_places_are_moved_to_the_surface_before_they_are_held_against_it() -> None:
    score = DriveScore(body_m=0.1)
    score.add(1, [person(1, 4.0, 0.0)], [track(7, 4.02, 0.0)])
    assert record(score).error_m == pytest.approx([0.02])
    assert record(score).surface_error_m == pytest.approx([0.02])


def test_a_switch_is_another_track_on_the_same_person_also_after_a_gap() -> None:
    score = DriveScore()
    for frame, number in enumerate((7, 7, None, 8, 8), 1):
        score.add(frame, [person(1, 4.0, 0.0)], [] if number is None else [track(number, 4.0, 0.0)])
    assert record(score).switches == 1
    assert record(score).missed == 1


def test_drives_together_have_the_sums_of_all() -> None:
    hit, miss = scored([person(1, 4.0, 0.0)], [track(7, 4.0, 0.1)]), scored([person(1, 4.0, 0.0)], [])
    both = TrackingRecord.joined([hit, miss, miss])
    assert (both.frames, both.found(), both.missed, both.false_sizes) == (3, 1, 2, 6)
    assert both.rate() == pytest.approx(1.0 / 3.0)
    assert both.size_recall[0] == 0.75
