"""Tests of who turns out to be whom."""

from __future__ import annotations

import numpy as np
import pytest

from peopleboy.tracker.tracking.appearance import FEATURES, Colours
from peopleboy.tracker.tracking.config import ReidentificationConfig
from peopleboy.tracker.tracking.reidentification import reidentify, resolve_identity_swaps
from peopleboy.tracker.tracking.track_state import TrackState

CONFIG = ReidentificationConfig()
NOW_S = 20.0


def wearing(red: float) -> Colours:
    """Give colours of which the coefficient with those of red 1 is the root of the share."""
    colours = np.zeros(FEATURES, np.float32)
    colours[0], colours[1] = np.sqrt(red), np.sqrt(1.0 - red)
    return colours


def person(number: int, was: float, now: float | None, seen_s: float = NOW_S) -> TrackState:
    target = TrackState(
        born_s=0.0,
        seen_s=seen_s,
        pattern=np.zeros(72, np.float32),
        colours=wearing(was),
        ratio=0.27,
        shown=np.array([0.0, 0.0, 10.0, 40.0]),
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


def test_somebody_new_is_who_wore_the_same() -> None:
    new = person(0, was=0.9, now=None)
    lost = [person(1, was=0.0, now=None, seen_s=5.0), person(2, was=1.0, now=None, seen_s=5.0)]
    assert reidentify(new, lost, CONFIG) is lost[1]
    assert reidentify(new, lost[:1], CONFIG) is None


def test_without_colours_somebody_new_is_nobody_who_was_lost() -> None:
    new = person(0, was=0.9, now=None)
    new.colours = np.zeros(FEATURES, np.float32)
    lost = [person(number, was=0.0, now=None, seen_s=5.0) for number in (1, 2)]
    assert reidentify(new, lost, CONFIG) is None


def test_who_was_lost_is_no_more_once_somebody_goes_on_as_him() -> None:
    new, lost = person(3, was=1.0, now=None), person(1, was=1.0, now=None, seen_s=5.0)
    new.inherit(lost)
    assert (new.id, lost.is_confirmed) == (1, False)


def test_what_was_worn_is_not_unlearned_while_somebody_looks_unlike_himself() -> None:
    target = person(1, was=1.0, now=None)
    for _ in range(30):
        target.mark_separate(1 / 15)
        target.update_appearance(np.zeros(72, np.float32), wearing(0.0))
    assert target.colours == pytest.approx(wearing(1.0))
    assert target.recent == pytest.approx(wearing(0.0))
