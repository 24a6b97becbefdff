import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.behaviours.safety_limits import SafetyConfig, limit, safe_speed
from peopleboy.behaviours.sonar_echoes import echoes, fill_drop_outs
from tests.helpers.percepts.percepts import free, percept_of, person
from tests.helpers.percepts.toy_world import SONAR_ANGLE, SONAR_X, SONAR_Y

CONFIG = SafetyConfig()
FULL = Command(linear_m_s=0.8, angular_rad_s=0.0)
speeds = st.floats(-5.0, 5.0)
ranges = st.lists(st.one_of(st.floats(0.0, 5.0), st.just(math.nan)), min_size=16, max_size=16)


def test_free_space_lets_a_command_within_the_limits_pass_unchanged():
    command = Command(linear_m_s=0.7, angular_rad_s=-2.0)
    assert limit(command, free(), CONFIG) == command


@given(speeds, speeds, ranges)
def test_whatever_is_asked_the_result_is_within_limits_and_no_part_changes_its_sign(
    linear, angular, ranges_m
):
    safe = limit(Command(linear_m_s=linear, angular_rad_s=angular), percept_of(ranges_m), CONFIG)
    assert abs(safe.linear_m_s) <= min(abs(linear), CONFIG.max_linear_m_s)
    assert abs(safe.angular_rad_s) <= min(abs(angular), CONFIG.max_angular_rad_s)
    assert safe.linear_m_s * linear >= 0.0
    assert safe.angular_rad_s * angular >= 0.0


@given(speeds, speeds, ranges)
def test_limiting_twice_is_limiting_once(linear, angular, ranges_m):
    percept = percept_of(ranges_m)
    once = limit(Command(linear_m_s=linear, angular_rad_s=angular), percept, CONFIG)
    assert limit(once, percept, CONFIG) == once


@given(st.floats(0.0, 3.0))
def test_from_the_safe_speed_reaction_and_braking_take_no_more_than_the_room(room_m):
    speed = safe_speed(room_m, CONFIG)
    way = speed * CONFIG.reaction_s + speed**2 / (2.0 * CONFIG.braking_m_s2)
    assert way <= room_m + 1e-9
    assert speed == CONFIG.max_linear_m_s or way == pytest.approx(room_m, abs=1e-9)


@pytest.mark.parametrize("sonar", range(2, 6))
def test_an_obstacle_ahead_stops_the_way_forwards_only(sonar):
    percept = free(**{f"i{sonar}": 0.25})
    assert limit(FULL, percept, CONFIG).linear_m_s == 0.0
    assert limit(Command(linear_m_s=-0.3, angular_rad_s=0.0), percept, CONFIG).linear_m_s == -0.3


@pytest.mark.parametrize("sonar", range(10, 14))
def test_an_obstacle_behind_stops_the_way_backwards_only(sonar):
    percept = free(**{f"i{sonar}": 0.25})
    assert limit(Command(linear_m_s=-0.3, angular_rad_s=0.0), percept, CONFIG).linear_m_s == 0.0
    assert limit(FULL, percept, CONFIG).linear_m_s == 0.8


def test_a_wall_beside_the_robot_does_not_slow_it():
    assert limit(FULL, free(i0=0.3, i15=0.3), CONFIG) == FULL


def test_with_a_corner_ahead_left_the_robot_may_turn_right_slowly_but_not_left():
    percept = free(i1=0.15)
    left = limit(Command(linear_m_s=0.0, angular_rad_s=1.0), percept, CONFIG)
    right = limit(Command(linear_m_s=0.0, angular_rad_s=-1.0), percept, CONFIG)
    assert left.angular_rad_s == 0.0
    assert right.angular_rad_s == -CONFIG.tight_turn_rad_s


def test_turning_is_slower_the_nearer_the_obstacle():
    turn = Command(linear_m_s=0.0, angular_rad_s=2.6)
    rates = [limit(turn, free(i2=d), CONFIG).angular_rad_s for d in (0.2, 0.25, 0.3, 0.4, 1.0)]
    assert rates == sorted(rates)
    assert rates[0] < 1.0 < rates[-1]


@pytest.mark.parametrize("name", ["time_s", "linear_m_s", "angular_rad_s"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_percept_with_a_senseless_number_stops_the_robot(name, value):
    assert limit(FULL, percept_of(np.full(16, 5.0), **{name: value}), CONFIG) == STOP


def test_without_sonars_the_robot_stands():
    blind = percept_of(np.full(16, 5.0), sonar_m=np.zeros(0), sonar_angle_rad=np.zeros(0))
    assert limit(FULL, blind, CONFIG) == STOP


def test_sonars_that_read_no_number_block_every_way():
    blind = percept_of(np.full(16, math.nan))
    assert limit(FULL, blind, CONFIG).linear_m_s == 0.0
    assert limit(Command(linear_m_s=-0.3, angular_rad_s=0.0), blind, CONFIG).linear_m_s == 0.0


def test_echoes_lie_within_three_centimetres_of_the_real_rings():
    real = np.stack([SONAR_X + np.cos(SONAR_ANGLE), SONAR_Y + np.sin(SONAR_ANGLE)], axis=1)
    off = np.linalg.norm(echoes(percept_of(np.ones(16))) - real, axis=1)
    looks_sideways = np.isclose(np.abs(SONAR_ANGLE), math.pi / 2.0)
    assert np.all(off[~looks_sideways] < 0.03)
    assert np.all(off[looks_sideways] < 0.12)


def test_one_lost_echo_is_filled_from_the_readings_before():
    steady = np.full(16, 0.5)
    lost = steady.copy()
    lost[3] = 5.0
    assert np.array_equal(fill_drop_outs([steady, steady, lost]), steady)


def test_readings_of_another_ring_are_left_out_of_the_filling():
    assert np.array_equal(fill_drop_outs([np.zeros(3), np.ones(2)]), np.ones(2))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_command_that_is_not_finite_is_refused(value):
    with pytest.raises(BadInput, match="finite"):
        Command(linear_m_s=value, angular_rad_s=0.0)
    with pytest.raises(BadInput, match="finite"):
        Command(linear_m_s=0.0, angular_rad_s=value)


def test_a_percept_with_more_ranges_than_angles_is_refused():
    with pytest.raises(BadInput, match="sonar"):
        percept_of(np.ones(15))


def test_a_percept_keeps_its_own_read_only_sonar():
    ranges_m = np.ones(16)
    percept = percept_of(ranges_m)
    ranges_m[0] = 3.0
    assert percept.sonar_m[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        percept.sonar_m[0] = 2.0


def among(*people):
    """Free space with people at positions [m] with velocities [m/s]."""
    seen = [person(position_m=at_m, velocity_m_s=velocity_m_s) for at_m, velocity_m_s in people]
    return replace(free(), people=tuple(seen))


def speed_among(*people, wanted=0.8):
    return limit(Command(linear_m_s=wanted, angular_rad_s=0.3), among(*people), CONFIG).linear_m_s


@pytest.mark.parametrize(
    ("at_m", "velocity_m_s"),
    [
        ((1.2, 0.0), (0.9, 0.0)),  # a leader who walks away, nearer than the comfortable distance
        ((4.0, 0.3), (0.7, 0.0)),  # a slower one, far ahead
        ((2.0, 2.0), (0.0, 1.0)),
        ((-2.0, 0.0), (1.2, 0.0)),  # from behind: a robot that waits would only be in the way sooner
        ((3.0, 0.0), (0.0, 0.0)),  # people who stand are left to the sonars
        ((9.0, 0.0), (-1.0, 0.0)),
    ],
)
def test_people_who_do_not_come_near_do_not_slow_the_robot(at_m, velocity_m_s):
    assert speed_among((at_m, velocity_m_s)) == 0.8


def test_a_robot_stops_for_a_person_who_walks_at_it_and_gradually():
    speeds_m_s = [speed_among(((x, 0.0), (-1.2, 0.0))) for x in (8.0, 6.5, 6.0, 5.5, 4.0, 1.0)]
    assert speeds_m_s[0] == 0.8
    assert speeds_m_s[-1] == 0.0
    assert speeds_m_s == sorted(speeds_m_s, reverse=True)
    assert len(set(speeds_m_s)) > 3


def test_a_robot_slows_down_for_a_person_who_walks_into_its_lane_but_not_for_one_who_walks_past():
    assert speed_among(((3.0, 2.0), (-0.3, -1.0))) < 0.4
    assert speed_among(((3.0, 2.5), (-1.0, 0.0))) == 0.8


@given(st.floats(0.5, 5.0), st.floats(-3.0, 3.0), st.floats(-1.5, 1.5), st.floats(-1.5, 1.5))
def test_at_the_given_speed_people_stay_away_unless_standing_does_not_help(x, y, ahead, left):
    speed = speed_among(((x, y), (ahead, left)))
    times = np.linspace(0.0, CONFIG.foresight_s, 60)

    def nearest(own):
        return np.hypot(x + (ahead - own) * times, y + left * times).min()

    near_m = min(CONFIG.comfort_m, np.hypot(x, y) - CONFIG.slack_m)
    if np.hypot(ahead, left) > CONFIG.walking_m_s and nearest(0.0) > near_m + 0.01:
        assert nearest(speed) > near_m - 0.01


def test_tracks_without_a_position_or_a_velocity_do_not_slow_the_robot():
    assert speed_among((None, None), ((2.0, 0.0), None)) == 0.8
