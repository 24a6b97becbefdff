"""Tests of who turns out to be whom."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.tracking.appearance import FEATURES, Colours
from peopleboy.tracker.tracking.config import ExistenceConfig, ReidentificationConfig
from peopleboy.tracker.tracking.motion_filter import STATE, StateEstimates
from peopleboy.tracker.tracking.reidentification import (
    Candidates,
    assign_lost,
    resolve_identity_swaps,
    same_person_log_odds,
)
from peopleboy.tracker.tracking.track_state import Continuation, TrackState
from peopleboy.tracker.tracking.tracks import Tracks

CONFIG = ReidentificationConfig()
NOW_S = 20.0


def wearing(red: float) -> Colours:
    """Give colours of which the coefficient with those of red 1 is the root of the share."""
    colours = np.zeros(FEATURES, np.float32)
    colours[0], colours[1] = np.sqrt(red), np.sqrt(1.0 - red)
    return colours


def person(number: int, was: float, now: float | None, seen_s: float = NOW_S) -> TrackState:
    target = TrackState(
        key=number,
        born_s=0.0,
        existence=ExistenceConfig(),
        seen_s=seen_s,
        pattern=np.zeros(72, np.float32),
        colours=wearing(was),
        ratio=0.27,
        shown={"thermal": (seen_s, np.array([0.0, 0.0, 10.0, 40.0]))},
        id=number,
    )
    if now is not None:
        target.recent, target.clear_s = wearing(now), CONFIG.parted_s
    return target


def test_two_who_look_like_each_other_did_exchange_their_numbers_and_their_looks() -> None:
    one, other = person(1, was=1.0, now=0.1), person(2, was=0.0, now=0.9)
    resolve_identity_swaps([one, other], NOW_S, CONFIG)
    assert (one.id, other.id) == (2, 1)
    assert one.colours == pytest.approx(wearing(0.0))


def test_two_who_look_like_themselves_or_like_twins_keep_their_numbers() -> None:
    for was, now in (((1.0, 0.0), (0.9, 0.1)), ((1.0, 0.95), (0.95, 1.0))):
        pair = [person(number, was[i], now[i]) for i, number in enumerate((1, 2))]
        resolve_identity_swaps(pair, NOW_S, CONFIG)
        assert [one.id for one in pair] == [1, 2]


def test_nothing_is_decided_as_long_as_one_of_them_is_in_sight_but_not_apart() -> None:
    one, other = person(1, was=1.0, now=0.1), person(2, was=0.0, now=None)
    resolve_identity_swaps([one, other], NOW_S, CONFIG)
    assert one.id == 1
    other.seen_s = NOW_S - 2.0 * CONFIG.parted_s
    resolve_identity_swaps([one, other], NOW_S, CONFIG)
    assert one.id == 2


@pytest.mark.parametrize("has_exchanged", [False, True])
def test_no_two_tracks_have_one_id_after_a_continuation_ends(has_exchanged: bool) -> None:
    tracks, state = Tracks(), StateEstimates(np.zeros((1, STATE)), np.eye(STATE)[None])
    lost, one = person(1, was=1.0, now=None, seen_s=NOW_S - 2.0), person(2, was=1.0, now=0.0)
    one.id, one.continuation = 1, Continuation(lost, state, NOW_S - 1.0)
    other, lost.watched_s = person(3, was=0.02, now=0.02), 5.0
    if has_exchanged:
        one.id, other.id = 3, 1
    tracks.items = [one, other]
    tracks.states = tracks.last_seen = state.joined(state)
    tracks.settle(NOW_S, CONFIG)
    ids = sorted(track.id for track in tracks.items)
    assert ids == ([1, 3] if has_exchanged else [0, 1, 3])
    assert one.continuation is None


def people(colours: list[Colours], places_m: list[tuple[float, float]], build: float = 0.0) -> Candidates:
    """Return people at places to the right and ahead, known to 10 cm and 3 % of their stature."""
    mean, covariance = np.zeros((len(colours), STATE)), np.zeros((len(colours), STATE, STATE))
    mean[:, (0, 2)], mean[:, 6] = places_m, build
    covariance[:, (0, 2, 6), (0, 2, 6)] = 0.01, 0.01, 0.0009
    return Candidates.of(StateEstimates(mean, covariance), colours)


def odds_of(lost: Candidates, found: Candidates, gone_s: float, config: ReidentificationConfig) -> np.ndarray:
    return same_person_log_odds(lost, np.full(len(lost.colours), gone_s), found, config)


BY_PLACE = ReidentificationConfig()
BY_COLOUR = ReidentificationConfig(uses_place=False)
HERE, FAR = (0.0, 5.0), (3.0, 7.0)


def test_a_new_track_continues_the_lost_one_with_the_same_colours() -> None:
    lost, new = people([wearing(0.0), wearing(1.0)], [HERE, FAR]), people([wearing(0.9)], [HERE])
    for config in (BY_PLACE, BY_COLOUR):
        assert assign_lost(odds_of(lost, new, 15.0, config)) == {0: 1}
        assert assign_lost(odds_of(people([wearing(0.0)], [HERE]), new, 15.0, config)) == {}


def test_without_colours_a_new_track_continues_a_lost_one_by_its_place_alone() -> None:
    lost, new = people([wearing(0.0), wearing(0.0)], [HERE, FAR]), people([np.zeros(FEATURES)], [HERE])
    assert assign_lost(odds_of(lost, new, 15.0, BY_COLOUR)) == {}
    assert assign_lost(odds_of(lost, new, 0.5, BY_PLACE)) == {0: 0}


def test_a_place_is_less_evidence_the_longer_a_person_has_been_lost_and_none_after_a_while() -> None:
    lost, new = people([wearing(1.0)], [HERE]), people([np.zeros(FEATURES)], [HERE])
    odds = [float(odds_of(lost, new, gone_s, BY_PLACE)[0, 0]) for gone_s in (0.3, 1.0, 3.0, 30.0, 600.0)]
    assert odds[0] > odds[1] > odds[2] > odds[3] == pytest.approx(odds[4], abs=0.01)


def test_of_two_dressed_alike_each_continues_the_track_that_was_lost_nearest() -> None:
    lost = people([wearing(1.0), wearing(1.0)], [HERE, FAR])
    found = people([wearing(1.0), wearing(1.0)], [(2.8, 6.9), (0.3, 5.1)])
    assert assign_lost(odds_of(lost, found, 1.0, BY_PLACE)) == {0: 1, 1: 0}


def test_a_person_who_cannot_have_walked_so_far_is_another_one() -> None:
    lost, found = people([wearing(1.0)], [HERE]), people([wearing(1.0)], [FAR])
    assert assign_lost(odds_of(lost, found, 0.3, BY_PLACE)) == {}
    assert assign_lost(odds_of(lost, found, 8.0, BY_PLACE)) == {0: 0}


def test_a_tall_person_does_not_come_back_short() -> None:
    lost, same = people([wearing(1.0)], [HERE], build=0.1), people([wearing(1.0)], [HERE], build=0.1)
    short = people([wearing(1.0)], [HERE], build=-0.1)
    assert odds_of(lost, same, 1.0, BY_PLACE) > odds_of(lost, short, 1.0, BY_PLACE) + 3.0


def test_who_was_lost_is_no_more_once_somebody_goes_on_as_him() -> None:
    new, lost = person(3, was=1.0, now=None), person(1, was=1.0, now=None, seen_s=5.0)
    new.inherit(lost)
    assert (new.id, lost.is_confirmed) == (1, False)


def test_what_was_worn_is_not_unlearned_while_somebody_looks_unlike_himself() -> None:
    target = person(1, was=1.0, now=None)
    for number in range(30):
        target.mark_separate(float(number), 1 / 15)
        target.update_appearance(np.zeros(72, np.float32), wearing(0.0))
    assert target.colours == pytest.approx(wearing(1.0))
    assert target.recent == pytest.approx(wearing(0.0))
