import math

import pytest

from peopleboy.tracker.frame import PANORAMA, THERMAL, Frame, Odometry
from peopleboy.tracker.fusion.handover_links import DEPTH_SHARE, FASTEST_M_S, FORGET_S, REACH_M, Departures
from peopleboy.tracker.track import Status
from tests.helpers.runs.hand_made_tracks import track

LOST_M = 4.0, 0.0
NEW = 77


def lost(*cameras, at=LOST_M, number=3, ago_s=0.0, odometry=None, status=Status.TRACKED):
    """Somebody who was seen by these cameras so long ago."""
    departures = Departures()
    departures.go_on(Frame(images={}, time_s=10.0))
    for camera in cameras:
        departures.note(camera, {number: track(8, at, status=status)})
    departures.go_on(Frame(images={}, time_s=10.0 + ago_s, odometry=odometry))
    return departures


def who(departures, at, camera=PANORAMA, present=(), others=None):
    return departures.who(track(NEW, at), present, camera, {} if others is None else others)


@pytest.mark.parametrize("camera", [PANORAMA, THERMAL])
@pytest.mark.parametrize("before", [PANORAMA, THERMAL])
def test_who_turns_up_where_somebody_was_lost_is_that_one(before, camera):
    departures = lost(before, ago_s=0.2)
    assert who(departures, (4.1, 0.2), camera) == 3
    assert who(departures, (4.1, 0.2), camera, present={3}) is None
    assert who(departures, (4.1, 2.5), camera) is None
    assert departures.who(track(NEW, None), (), camera, {}) is None


def test_nobody_is_looked_for_farther_away_than_it_can_have_gone_nor_for_long():
    for ago_s in (0.0, 1.0):
        reach = REACH_M + FASTEST_M_S * ago_s
        assert who(lost(PANORAMA, ago_s=ago_s), (4.0 + 0.95 * reach, 0.0)) == 3
        assert who(lost(PANORAMA, ago_s=ago_s), (4.0 + 1.05 * reach, 0.0)) is None
    assert who(lost(PANORAMA, ago_s=FORGET_S), LOST_M) is None


def test_the_nearest_is_meant():
    departures = lost(PANORAMA)
    departures.note(PANORAMA, {4: track(9, (4.0, 0.8))})
    assert who(departures, (4.0, 0.1)) == 3
    assert who(departures, (4.0, 0.7)) == 4
    assert who(departures, (4.0, 0.7), present={4}) == 3


@pytest.mark.parametrize(("before", "camera"), [(THERMAL, PANORAMA), (PANORAMA, THERMAL), (THERMAL, THERMAL)])
def test_depth_counts_for_less_where_the_thermal_image_tells_it(before, camera):
    reach = REACH_M / DEPTH_SHARE
    assert who(lost(before), (4.0 + 0.95 * reach, 0.0), camera) == 3
    assert who(lost(before), (4.0 + 1.05 * reach, 0.0), camera) is None
    assert who(lost(before), (4.0, 1.1 * REACH_M), camera) is None


def test_whom_both_cameras_saw_must_have_been_near_for_both():
    behind = 6.3, 0.0
    assert who(lost(THERMAL), behind) == 3
    assert who(lost(THERMAL, PANORAMA), behind) is None
    assert who(lost(THERMAL, PANORAMA), (4.3, 0.2)) == 3


def test_who_is_seen_in_another_direction_by_the_other_camera_is_not_meant():
    departures = lost(PANORAMA)
    aside, deeper = (4.0, 0.9), (6.0, 0.1)
    assert who(departures, LOST_M, others={3: track(5, aside)}) is None
    assert who(departures, LOST_M, others={9: track(5, aside)}) == 3
    assert who(departures, LOST_M, others={3: track(5, deeper)}) == 3
    assert who(departures, LOST_M, others={3: track(5, aside, status=Status.TOTALLY_OCCLUDED)}) == 3


def test_who_is_only_guessed_at_has_not_been_seen_anywhere():
    assert who(lost(PANORAMA, status=Status.TOTALLY_OCCLUDED), LOST_M) is None
    assert who(lost(PANORAMA, at=None), LOST_M) is None


def test_places_stay_in_the_room_while_the_robot_moves():
    departures = lost(PANORAMA, odometry=Odometry(advance_m=1.0, aside_m=0.0, turn_rad=math.pi / 2))
    assert who(departures, (0.0, -3.0)) == 3
    assert who(departures, LOST_M) is None
