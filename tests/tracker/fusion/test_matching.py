"""Whose a track is."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.fusion.fused_person import FusedPerson, SensorTrack, initiate_person
from peopleboy.tracker.fusion.fused_tracker import _depth as depth_of
from peopleboy.tracker.fusion.fused_tracker import _without as without
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.fusion.track_to_track import cheapest, cost, distance2, is_contradicted
from peopleboy.tracker.rgbd.observation_model import BINS
from peopleboy.tracker.track import Status

CONFIG = FusionConfig()


def appearance(colour: int) -> np.ndarray:
    found = np.zeros(BINS)
    found[colour] = 1.0
    return found


def reported(x: float, y: float, along_m: float = 0.05, **further: object) -> SensorTrack:
    """Seen from far away along x, sure to 5 cm across."""
    error = np.diag([along_m**2, 0.05**2])
    given = {"id": 1, "status": Status.TRACKED, "confidence": 0.9} | further
    return SensorTrack(place_m=np.array([x, y]), error_m2=error, **given)  # type: ignore[arg-type]


def person(x: float, y: float, **further: object) -> FusedPerson:
    one = reported(x, y, **further)
    return initiate_person(1, one, 0.0).with_depth(one, 0.0, CONFIG)


def test_heat_is_sure_of_the_bearing_and_depth_of_the_range_too() -> None:
    someone = person(6.0, 0.0)
    farther, aside = reported(6.8, 0.0, along_m=0.6), reported(6.0, 0.8, along_m=0.6)
    assert (
        distance2(someone, farther, CONFIG.floor_m)
        < 3.0
        < CONFIG.gate
        < distance2(someone, aside, CONFIG.floor_m)
    )
    assert distance2(someone, reported(6.8, 0.0), CONFIG.floor_m) > CONFIG.gate


def test_looks_and_memory_decide_between_two_places_alike() -> None:
    red = person(6.0, 0.0, appearance=appearance(1), tall_m=1.7)
    same, other = (reported(6.1, 0.0, appearance=appearance(colour), tall_m=1.7) for colour in (1, 2))
    assert cost(red, same, None, 0.1, CONFIG) < cost(red, other, None, 0.1, CONFIG)
    assert cost(red, same, 1, 0.1, CONFIG) == cost(red, same, None, 0.1, CONFIG) - CONFIG.loyalty


def test_who_is_away_is_not_followed_even_by_its_own_track() -> None:
    someone, here = person(6.0, 0.0), reported(6.0, 0.0)
    assert np.isfinite(cost(someone, here, 1, CONFIG.away_s, CONFIG))
    assert np.isinf(cost(someone, here, 1, CONFIG.away_s + 0.01, CONFIG))


def test_a_thermal_track_is_beside_who_is_seen_whole_in_another_bearing_and_not_in_another_range() -> None:
    box = (0.0, 0.0, 20.0, 90.0)
    someone, hidden = person(6.0, 0.0), person(6.0, 0.0, status=Status.PARTLY_OCCLUDED)
    farther = reported(7.5, 0.0, along_m=0.6, box=box)
    beside = reported(6.0, CONFIG.beside_m + 0.01, along_m=0.6, box=box)
    assert [is_contradicted(someone, one, CONFIG) for one in (farther, beside)] == [False, True]
    assert not is_contradicted(hidden, beside, CONFIG)


costs = st.integers(1, 4).flatmap(
    lambda rows: st.lists(
        st.lists(st.floats(0.0, 50.0) | st.just(np.inf), min_size=4, max_size=4),
        min_size=rows,
        max_size=rows,
    )
)


@given(costs)
def test_as_many_as_can_be_are_matched_as_cheaply_as_can_be(table: list[list[float]]) -> None:
    matrix = np.array(table)

    def rate(columns: tuple[int, ...]) -> tuple[int, float]:
        chosen = [matrix[row, column] for row, column in enumerate(columns)]
        finite = [one for one in chosen if np.isfinite(one)]
        return -len(finite), sum(finite)

    best = min(rate(columns) for columns in permutations(range(4), len(matrix)))
    found = cheapest(matrix)
    assert all(np.isfinite(matrix[row, column]) for row, column in found.items())
    assert len(set(found.values())) == len(found) == -best[0]
    assert np.isclose(sum(matrix[row, column] for row, column in found.items()), best[1])


def test_a_track_that_is_somebody_elses_now_is_taken_from_who_had_it() -> None:
    had = replace(person(6.0, 0.0), depth=5, heat=3)
    assert without(had, depth_of, {5: had.id}) is had
    assert without(had, depth_of, {7: 2}) is had
    later = without(had, depth_of, {5: 2})
    assert depth_of(later) not in {5, None}
    assert later.heat == 3
