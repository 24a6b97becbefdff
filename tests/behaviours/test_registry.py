import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.behaviours.behaviour import STOP, Command
from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.behaviours.scripted import Scripted
from tests.helpers.calls.refused import refused
from tests.helpers.percepts.percepts import free
from tests.helpers.percepts.toy_world import FRONT, HALF_WIDTH, Toy, drive, wall

SCRIPT = (
    (1.0, Command(linear_m_s=0.3, angular_rad_s=0.0)),
    (2.0, Command(linear_m_s=0.0, angular_rad_s=-1.0)),
)


def at(time_s, percept):
    return dataclasses.replace(percept, time_s=time_s)


@pytest.mark.parametrize(
    ("time_s", "expected"),
    [
        (0.0, STOP),
        (0.999, STOP),
        (1.0, SCRIPT[0][1]),
        (1.5, SCRIPT[0][1]),
        (2.0, SCRIPT[1][1]),
        (99.0, SCRIPT[1][1]),
    ],
)
def test_scripted_commands_are_given_from_their_times_on(time_s, expected):
    behaviour = make_behaviour("scripted", script=SCRIPT)
    assert behaviour.command(at(time_s, free(i12=3.0))) == expected
    assert behaviour.mode == "scripted"


@pytest.mark.parametrize("times", [(1.0, 1.0), (2.0, 1.0), (math.nan,), (0.0, math.inf)])
def test_a_script_whose_times_do_not_rise_is_refused(times):
    with pytest.raises(BadInput, match="increasing"):
        Scripted([(time_s, STOP) for time_s in times])


def test_an_empty_script_stands():
    assert make_behaviour("scripted").command(free()) == STOP


def test_standing_stands():
    behaviour = make_behaviour("stand")
    assert behaviour.command(free()) == STOP
    assert behaviour.mode == "stand"


def test_an_unknown_name_is_refused_with_the_names_there_are():
    with refused("'dance'", "follow_corridor", "patrol"):
        make_behaviour("dance")


def test_the_guard_stops_a_script_before_a_wall_and_says_so():
    behaviour = make_behaviour("scripted", script=((0.0, Command(linear_m_s=0.8, angular_rad_s=0.0)),))
    behaviour.command(free(i12=3.0))
    assert not behaviour.is_limited
    assert behaviour.command(free(i3=0.3)).linear_m_s == 0.0
    assert behaviour.is_limited


def test_one_lost_echo_does_not_set_a_stopped_robot_going():
    behaviour = make_behaviour("scripted", script=((0.0, Command(linear_m_s=0.8, angular_rad_s=0.0)),))
    for reading in (0.3, 0.3, 5.0):
        assert behaviour.command(free(i3=reading)).linear_m_s == 0.0


@pytest.mark.slow
@settings(max_examples=6, deadline=None)
@given(
    speed=st.floats(0.1, 2.0),
    slant=st.floats(-0.7, 0.7),
    aside=st.floats(-1.0, 1.0),
    seed=st.integers(0, 99),
)
def test_a_robot_sent_into_a_wall_stops_before_it(speed, slant, aside, seed):
    across = 3.0 * math.tan(slant)
    toy = Toy(
        path=lambda _: (0.0, 50.0),
        walls=wall((4.0 + across, -3.0 + aside), (4.0 - across, 3.0 + aside)),
        rng=np.random.default_rng(seed),
    )
    script = ((0.0, Command(linear_m_s=speed, angular_rad_s=0.0)),)
    log = drive(toy, make_behaviour("scripted", script=script), 4.0 / min(speed, 0.8) + 5.0)
    ahead, beside = toy.local(toy.walls).T
    assert not log.is_contact.any()
    assert toy.speed < 0.05  # the noise of the sonar lets it creep by fits and starts
    assert 0.2 < np.min(ahead[np.abs(beside) < HALF_WIDTH]) - FRONT < 1.2


def test_until_the_sonars_have_heard_anything_the_robot_creeps():
    behaviour = make_behaviour("scripted", script=((0.0, Command(linear_m_s=0.8, angular_rad_s=0.0)),))
    assert behaviour.command(free()).linear_m_s == pytest.approx(0.05)
    assert behaviour.command(free(i12=4.0)).linear_m_s == pytest.approx(0.8)
    assert behaviour.command(at(2.0, free())).linear_m_s == pytest.approx(0.8)


def ahead_at(time_s, percept, speed=0.8):
    return dataclasses.replace(at(time_s, percept), linear_m_s=speed)


def test_a_robot_without_echoes_slows_down_and_stops_within_what_the_last_echoes_proved_free():
    behaviour = make_behaviour("scripted", script=((0.0, Command(linear_m_s=0.8, angular_rad_s=0.0)),))
    behaviour.command(at(0.0, free(i12=4.0)))
    speed, driven, k = 0.8, 0.0, 0
    while behaviour.mode != "stop" and k < 300:
        k += 1
        speed = behaviour.command(ahead_at(k / 15.0, free(), speed)).linear_m_s
        driven += speed / 15.0
    assert 2.5 < driven < 4.0 - 0.32
    assert "sonars have failed" in behaviour.reason
    heard = behaviour.command(at((k + 1) / 15.0, free(i12=4.0)))
    assert heard.linear_m_s == pytest.approx(0.8)
    assert behaviour.mode != "stop"


def test_sonars_that_repeat_their_readings_while_the_robot_drives_are_stuck():
    behaviour = make_behaviour("scripted", script=((0.0, Command(linear_m_s=0.8, angular_rad_s=0.0)),))
    behaviour.command(ahead_at(0.0, free(i12=4.0), 0.0))
    assert behaviour.command(ahead_at(0.1, free(i12=4.0), 0.0)).linear_m_s > 0.0
    assert behaviour.command(ahead_at(0.2, free(i12=4.0))).is_emergency
    assert "repeat" in behaviour.reason
    assert behaviour.command(ahead_at(0.3, free(i12=3.9))).linear_m_s > 0.0
