"""Whether somebody is told, as evidence adds up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.tracking.appearance import FEATURES
from peopleboy.tracker.tracking.config import ExistenceConfig
from peopleboy.tracker.tracking.track_state import DetectionEvidence, TrackState

CONFIG = ExistenceConfig()
DT_S = 1.0 / 15.0


def known() -> TrackState:
    return TrackState(
        key=0,
        born_s=0.0,
        existence=CONFIG,
        seen_s=0.0,
        pattern=np.zeros(4, np.float32),
        colours=np.zeros(FEATURES, np.float32),
        ratio=0.3,
        shown={"thermal": (0.0, np.array([0.0, 0.0, 10.0, 40.0]))},
        log_odds=CONFIG.confirmed,
        id=1,
        confirmed_s=0.0,
    )


def seen(target: TrackState, score: float, images: int, since_s: float, speed_m_s: float = 1.5) -> float:
    for image in range(1, images + 1):
        time_s = since_s + image * DT_S
        target.update_seen(DetectionEvidence(score, 0.0, speed_m_s), time_s, DT_S, CONFIG)
    return time_s


def test_who_goes_on_to_look_like_nobody_is_told_no_more() -> None:
    target = known()
    images = round((CONFIG.confirmed - CONFIG.deletion_log_odds) * CONFIG.independent_s / DT_S)
    time_s = seen(target, -1.0, images - 1, 0.0)
    assert target.is_output(time_s, 0.0)
    time_s = seen(target, -1.0, 2, time_s)
    assert not target.is_output(time_s, 0.0)


@pytest.mark.parametrize("hider", [None, 2])
def test_who_was_away_is_told_with_the_first_image_that_shows_him(hider: int | None) -> None:
    target = known()
    for _ in range(200):
        target.update_missed(hider, DT_S, is_hidden=False)
    assert target.log_odds == CONFIG.deletion_log_odds
    time_s = seen(target, 0.5, 1, 200 * DT_S)
    assert target.is_output(time_s, 0.0)


def test_a_clear_image_counts_at_once_though_those_before_said_little() -> None:
    target = known()
    target.id, target.log_odds = 0, CONFIG.deletion_log_odds
    seen(target, CONFIG.highest_score, 3, 0.0, speed_m_s=0.0)
    left = (1.0 - CONFIG.evidence_gain) ** 3 * (CONFIG.highest_score - CONFIG.deletion_log_odds)
    assert target.log_odds == pytest.approx(CONFIG.highest_score - left)
    assert target.has_enough_evidence()


@given(st.floats(0.0, 8.0), st.floats(-8.0, 8.0))
def test_an_image_that_says_less_than_those_before_adds_its_own_part(before: float, score: float) -> None:
    target = known()
    target.log_odds = before
    seen(target, min(score, before), 1, 0.0, speed_m_s=0.0)
    own = min(score, before, CONFIG.highest_score) * DT_S / CONFIG.still_s
    assert target.log_odds == pytest.approx(min(before + own, CONFIG.highest))


def test_who_was_never_told_fades_when_not_found() -> None:
    target = known()
    target.id, target.log_odds = 0, CONFIG.deletion_log_odds
    target.update_missed(None, DT_S, is_hidden=False)
    assert target.is_deleted(DT_S)


def images_until_told(score: float, speed_m_s: float) -> int:
    target = known()
    target.id, target.log_odds = 0, score
    for image in range(1, 1000):
        seen(target, score, 1, image * DT_S, speed_m_s)
        if target.has_enough_evidence():
            return image
    raise AssertionError("never told")


@given(st.floats(0.0, 10.0), st.floats(0.0, 6.0), st.booleans())
def test_hidden_people_are_output_for_a_share_of_how_long_they_were_watched(
    watched_s: float, gone_s: float, is_covered: bool
) -> None:
    hidden, away = known(), known()
    for one in (hidden, away):
        one.watched_s, one.log_odds = watched_s, CONFIG.highest
    hidden.occluder, hidden.is_hidden = 2, True
    most_s = CONFIG.max_coast_covered_s if is_covered else CONFIG.max_coast_occluded_s
    longest_s = max(min(CONFIG.coast_occluded_share * watched_s, most_s), CONFIG.max_coast_s)
    overlap = CONFIG.covered if is_covered else 0.9 * CONFIG.covered
    assert hidden.is_output(gone_s, overlap) == (gone_s <= longest_s)
    assert away.is_output(gone_s, overlap) == (gone_s <= CONFIG.max_coast_s)


@given(st.floats(0.0, 10.0), st.floats(0.0, 10.0))
def test_a_visible_part_of_an_occluded_person_counts_like_a_detection_for_some_time(
    present_s: float, gone_s: float
) -> None:
    target = known()
    target.existence = replace(CONFIG, max_present_s=2.0)
    target.is_hidden, target.log_odds, target.present_s = True, CONFIG.highest, present_s
    assert target.is_output(gone_s, 0.0) == (gone_s - min(present_s, 2.0) <= CONFIG.max_coast_s)


def test_who_stands_still_is_no_new_sight_in_every_image() -> None:
    walks, stands = images_until_told(0.5, 1.0), images_until_told(0.5, 0.0)
    sights = (CONFIG.confirmed - 0.5) / 0.5
    assert walks == pytest.approx(sights * CONFIG.independent_s / DT_S, abs=1.0)
    assert stands == pytest.approx(sights * CONFIG.still_s / DT_S, abs=1.0)


@given(st.floats(0.0, 5.0), st.floats(0.0, 5.0))
def test_the_faster_the_sooner_up_to_a_limit(one: float, other: float) -> None:
    slower, faster = sorted((one, other))
    assert images_until_told(0.9, faster) <= images_until_told(0.9, slower)


def test_whoever_is_surely_somebody_is_told_standing_too() -> None:
    assert images_until_told(3.0 + CONFIG.confirmed, 0.0) <= 3


def test_postures_are_filtered_over_time() -> None:
    target = known()
    assert target.posture is None
    lying, upright = np.array([0.0, 0.0, 0.0, 0.0, 3.0]), np.array([3.0, 0.0, 0.0, 0.0, 0.0])
    for _ in range(30):
        target.update_posture(upright, DT_S)
    assert target.posture is not None
    assert target.posture.argmax() == 0
    target.update_posture(lying, DT_S)
    assert target.posture.argmax() == 0  # one image is not enough
    for _ in range(30):
        target.update_posture(lying, DT_S)
    assert target.posture.argmax() == 4


def test_without_evidence_all_postures_become_equally_probable() -> None:
    target = known()
    target.update_posture(np.array([9.0, 0.0, 0.0, 0.0, 0.0]), DT_S)
    for _ in range(200):
        target.update_posture(np.zeros(5), 1.0)
    assert target.posture is not None
    np.testing.assert_allclose(np.exp(target.posture) / np.exp(target.posture).sum(), 0.2, atol=1e-6)


def test_the_edges_of_a_person_follow_those_that_are_measured() -> None:
    one = known()
    one.update_edges(np.full(2, np.nan), 0.4)
    assert np.isnan(one.edges).all()
    one.update_edges(np.array([-0.2, 0.1]), 0.4)
    np.testing.assert_array_equal(one.edges, [-0.2, 0.1])
    one.update_edges(np.full(2, np.nan), 0.4)
    one.update_edges(np.array([-0.1, 0.1]), 0.4)
    np.testing.assert_allclose(one.edges, [-0.16, 0.1])
