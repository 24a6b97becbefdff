from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.scores.drive_record import count_contacts
from peopleboy.scenarios.scores.following_metrics import FollowingTask, following_task, score_following
from peopleboy.sim.truth.events import EventLog
from tests.helpers.drives import made_drive

STEP_S = 0.5


def score(distance, *, bearing=0.0, tracked=None, contact=None, heading=0.7, task=None, **more):
    """A robot at (1, 2) with a person at these distances and bearings from its nose."""
    distance = np.array(distance, float)
    frames = len(distance)
    angle = heading + np.broadcast_to(bearing, frames)
    person = np.stack([1.0 + distance * np.cos(angle), 2.0 + distance * np.sin(angle)], axis=1)
    run = made_drive(
        10.0 + STEP_S * np.arange(frames),
        np.tile([1.0, 2.0, heading], (frames, 1)),
        target=person,
        is_contact=np.array([False] * frames if contact is None else contact),
        **({"track": np.array([True] * frames if tracked is None else tracked).astype(np.int64)} | more),
    )
    return score_following(run, task)


def test_a_run_without_fault_scores_full():
    task = FollowingTask(keep_m=3.0)
    result = score([3.0] * 8, task=task)
    assert result.found
    assert result.time_to_find_s == 0.0
    assert (result.followed, result.in_band, result.facing, result.in_band_and_facing) == (1.0,) * 4
    assert result.rms_distance_error_m == pytest.approx(0.0, abs=1e-9)
    assert (result.collisions, result.times_lost, result.longest_lost_s) == (0, 0, 0.0)


def test_nothing_before_the_encounter_counts_but_the_nearest_distance():
    result = score([1.0, 9.0, 3.0, 3.0], tracked=[False, False, True, True])
    assert result.time_to_find_s == 2 * STEP_S
    assert (result.followed, result.in_band) == (1.0, 1.0)
    assert result.min_distance_m == pytest.approx(1.0)


def test_distance_errors_are_mean_and_root_mean_square():
    result = score([2.0, 4.0, 3.0, 6.0], task=FollowingTask(keep_m=3.0))
    assert result.mean_distance_error_m == pytest.approx(5.0 / 4.0)
    assert result.rms_distance_error_m == pytest.approx(math.sqrt(11.0 / 4.0))


def test_band_and_facing_are_shares_of_frames():
    task = FollowingTask(keep_m=2.35, within_m=1.15, facing_rad=0.2)
    result = score([1.0, 2.0, 3.0, 4.0], bearing=[0.1, -0.1, 0.3, 6.4], task=task)
    assert result.in_band == 0.5
    assert result.facing == 0.75  # 6.4 is 0.12 past a full turn
    assert result.in_band_and_facing == 0.25


def test_the_heading_in_which_everything_happens_does_not_matter():
    one, other = (score([2.0, 3.0], bearing=3.1, heading=h) for h in (0.0, 3.0))
    assert (one.facing, one.in_band) == (other.facing, other.in_band)


def test_contacts_are_counted_when_they_begin():
    apart = [False] * (round(0.3 / STEP_S) + 1)
    touched = [True, True, *apart, True, *apart]
    assert score([3.0] * len(touched), contact=touched).collisions == 2


def test_lost_periods_are_counted_from_their_length_on():
    tracked = [True, False, True, False, False, False, True, False]
    result = score([3.0] * 8, tracked=tracked, task=FollowingTask(lost_s=1.0))
    assert result.times_lost == 1
    assert result.longest_lost_s == 3 * STEP_S
    assert result.followed == 3 / 8


def test_whoever_is_never_tracked_was_not_found():
    result = score([3.0] * 4, tracked=[False] * 4)
    assert not result.found
    assert math.isnan(result.time_to_find_s)
    assert math.isnan(result.followed)
    assert result.times_lost == 0
    assert len(result.rows()) == 17


def test_frames_without_the_person_do_not_count():
    result = score([3.0, math.nan, math.nan, 3.0], tracked=[True, False, False, True])
    assert result.followed == 1.0
    assert result.in_band == 1.0


@given(st.lists(st.floats(0.1, 9.0), min_size=1, max_size=20), st.data())
def test_every_share_is_within_its_bounds_and_both_is_no_more_than_each(distances, data):
    tracked = data.draw(st.lists(st.booleans(), min_size=len(distances), max_size=len(distances)))
    result = score(distances, tracked=tracked, bearing=data.draw(st.floats(-4.0, 4.0)))
    if result.found:
        assert 0.0 <= result.in_band_and_facing <= min(result.in_band, result.facing) <= 1.0
        assert 0.0 < result.followed <= 1.0
        assert result.mean_distance_error_m <= result.rms_distance_error_m + 1e-9
        assert result.longest_lost_s <= STEP_S * (len(distances) - 1) + 1e-9


def test_a_person_who_is_away_is_not_lost_meanwhile():
    away = [3.0, 3.0] + [math.nan] * 9 + [3.0]
    result = score(away, tracked=[True] + [False] * 10 + [True])
    assert result.longest_lost_s == STEP_S


def test_arrays_of_different_lengths_and_standing_time_are_refused():
    with pytest.raises(BadInput, match="shapes"):
        made_drive(np.arange(3.0), np.zeros((3, 3)), target=np.ones((2, 2)))
    with pytest.raises(BadInput, match="increase"):
        made_drive(np.zeros(3), np.zeros((3, 3)))


def test_a_person_lost_or_exchanged_in_the_last_seconds_was_not_followed_to_the_end():
    tracked = [True] * 20
    assert score([3.0] * 20, tracked=tracked).followed_to_end
    assert not score([3.0] * 20, tracked=[True] * 13 + [False] * 7).followed_to_end
    assert score([3.0] * 20, tracked=[False] * 13 + [True] * 7).followed_to_end
    assert not score([3.0] * 20, is_wrong=np.arange(20) == 16).followed_to_end
    assert score([3.0] * 20, is_wrong=np.arange(20) == 3).wrong_person_s == STEP_S
    assert math.isnan(score([3.0] * 20).wrong_person_s)


def test_new_numbers_of_the_track_are_counted():
    assert score([3.0] * 6, track=np.array([0, 4, 4, 0, 4, 7])).identity_changes == 1


def test_a_detour_to_the_person_halves_the_efficiency():
    frames = 9
    time_s, x = STEP_S * np.arange(frames), 0.1 * np.arange(frames)
    robot = np.stack([x, np.where(np.arange(frames) % 2, 0.1 * math.sqrt(3.0), 0.0), 0.0 * x], axis=1)
    person = np.stack([x + 9.0, 0.0 * x], axis=1)
    person[-1, 0] = x[-1] + 3.0
    run = made_drive(time_s, robot, target=person, track=np.ones(frames, np.int64))
    assert score_following(run).path_efficiency == pytest.approx(0.5)
    assert score_following(run).mean_heading_error_rad < 0.05


def test_the_distance_to_keep_is_the_one_that_shows_the_person_as_tall_as_asked() -> None:
    config = load_scenario("single_follow").world(0)
    task = following_task(config, keep_height=0.5)
    camera, person = config.robot.cameras["thermal"].camera, config.people[0]
    away = task.keep_m - camera.position_m[0]
    feet, head = camera.project(np.array([[0.0, 1.2, away], [0.0, 1.2 - person.height_m, away]]))
    assert feet[1] - head[1] == pytest.approx(0.5 * camera.height)
    assert task.within_m == 1.2


@given(flags=st.lists(st.booleans(), min_size=1, max_size=40), rate_hz=st.sampled_from([2.0, 15.0, 60.0]))
def test_as_many_contacts_are_counted_as_the_log_tells_of_one_wall(flags: list[bool], rate_hz: float) -> None:
    time_s, log, begun = 1.0 + np.arange(len(flags)) / rate_hz, EventLog(), 0
    for at_s, is_touching in zip(time_s.tolist(), flags, strict=True):
        told = log.update(SimpleNamespace(time_s=at_s, people=(), contacts=("wall",) * is_touching))
        begun += sum(event.kind == "contact starts" for event in told)
    assert count_contacts(time_s, np.array(flags)) == begun


@pytest.mark.parametrize(("touched_s", "count"), [([], 0), ([0.0, 0.1, 0.3], 1), ([0.0, 0.5, 2.0], 3)])
def test_who_bounces_touches_once(touched_s: list[float], count: int) -> None:
    time_s = np.arange(30) / 10.0
    assert count_contacts(time_s, np.isin(time_s, touched_s)) == count
