from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.studies.reproductions.experiments.drive_scores import TrackingRecord
from peopleboy.studies.reproductions.experiments.drive_tracking import (
    CHOICES,
    DEFAULT,
    FILTERS_CHOICES,
    LITERAL,
    SETS,
    play_drive,
    watch_drive,
    watch_legs,
)
from peopleboy.tracker.frame import DEPTH


@pytest.fixture(scope="module")
def film() -> dict[str, Any]:
    return watch_drive("follow_at_distance", 0, (DEFAULT, LITERAL), 1.0, 1.4)


def test_a_person_in_plain_view_is_found_and_placed(film: dict[str, Any]) -> None:
    record = TrackingRecord.of_plain(film[DEFAULT])
    assert record.frames == len(film["robot"]) == 21
    assert record.missed <= 3
    assert record.rate() > 0.8
    assert np.median(record.error_m) < 0.1
    assert record.bands[0].tolist() == [21, 21]


def test_what_is_told_and_the_truth_are_plain_and_agree_with_the_hits(film: dict[str, Any]) -> None:
    assert json.loads(json.dumps(film)).keys() == {DEFAULT, LITERAL, "truth", "robot"}
    places = {row[0]: row[2:4] for row in film["truth"]}
    told = {row[0]: row[2:4] for row in film[DEFAULT]["tracks"]}
    for frame, _, _, forward, left, *_ in film[DEFAULT]["hits"]:
        off = np.subtract(told[frame], places[frame])
        assert off == pytest.approx([forward, left], abs=2e-3)


def test_every_set_is_driven_by_the_clock_and_every_tracker_differs_from_the_others() -> None:
    assert len(SETS) == len(set(SETS)) == 12
    assert {load_scenario(name).robot.behaviour for name in SETS} == {"scripted"}
    assert len(CHOICES) == len(set(CHOICES))
    configs = [repr(config) for config in FILTERS_CHOICES.values()]
    assert len(configs) == len(set(configs))


def test_noise_can_be_left_out_of_the_depth_and_the_truth_stays() -> None:
    scenario = load_scenario("follow_at_distance").lasting(0.1)
    exact = scenario.with_cameras({DEPTH: {"kind": DEPTH, "scale": 0.0}})
    (one, noisy), (other, clean) = (
        next(
            ([(each.place_m, each.surface_m) for each in people], moment.frame.depth(DEPTH).copy())
            for moment, people in play_drive(drive, 0)
        )
        for drive in (scenario, exact)
    )
    assert one == other
    assert (noisy == 0).mean() > (clean == 0).mean()
    read = (noisy > 0) & (clean > 0)
    assert 0.0 < np.abs(noisy[read].astype(int) - clean[read])[clean[read] < 3000].mean() < 30.0


def test_legs_are_followed_where_the_person_walks() -> None:
    film = watch_legs("follow_at_distance", 1.4)
    places = {row[0]: np.array(row[2:4]) for row in film["truth"]}
    off = [np.hypot(*(np.array(place) - places[int(frame)])) for frame, _, *place in film["legs"]]
    assert len(off) > 10
    assert np.median(off) < 0.2
