from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from benchmarks.postures import COLUMNS, count, table_of
from peopleboy.tracker.track import Status, Track, TrackPosture

STANDING, LYING = (10.0, 10.0, 20.0, 80.0), (100.0, 70.0, 40.0, 15.0)


def person(box: tuple[float, ...], posture: str, visible: float = 1.0) -> Any:
    return SimpleNamespace(box=box, posture=posture, visible_fraction=visible, visible_px=50)


def track(number: int, box: tuple[float, float, float, float], posture: TrackPosture | None) -> Track:
    return Track(
        id=number, boxes={"thermal": box}, confidence=0.9, status=Status.TRACKED, age_s=1.0, posture=posture
    )


def tick(people: list[Any], tracks: list[Track]) -> Any:
    return SimpleNamespace(truth=SimpleNamespace(people=people), tracks=tuple(tracks))


def test_people_are_counted_by_posture_and_boxes_on_none_are_false() -> None:
    people = [
        person(STANDING, "arms_raised"),
        person(LYING, "fallen"),
        person((200.0, 0.0, 9.0, 9.0), "standing"),
    ]
    tracks = [
        track(1, STANDING, TrackPosture.SITTING),
        track(2, LYING, TrackPosture.LYING),
        track(3, (250.0, 9.0, 9.0, 40.0), None),
    ]
    counts, false_boxes = count(tick(people, tracks))
    assert counts.tolist() == [[1, 0, 0, 0, 1], [1, 0, 0, 0, 1], [0, 0, 0, 0, 1]]
    assert false_boxes == 1
    rows = table_of(counts, 4, false_boxes)
    assert rows["upright"] == {"people": 1.0, "tracked": 100.0, "named": 0.0, "false boxes per image": None}
    assert rows["all"] == {"people": 2.0, "tracked": 100.0, "named": 50.0, "false boxes per image": 0.25}
    assert rows["sitting"]["tracked"] is None
    assert set(rows["all"]) == set(COLUMNS)


@pytest.mark.parametrize("people", [[], [person(STANDING, "standing", 0.2)]])
def test_people_who_are_hidden_do_not_count(people: list[Any]) -> None:
    counts, false_boxes = count(tick(people, []))
    assert not counts.any()
    assert false_boxes == 0
    assert np.all(counts == 0)
