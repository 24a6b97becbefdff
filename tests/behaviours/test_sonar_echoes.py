import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.behaviours.sonar_echoes import EchoMemory, EchoMemoryConfig, remember
from tests.helpers.percepts.percepts import free
from tests.helpers.percepts.toy_world import Toy, room, straight

CONFIG = EchoMemoryConfig()


def at(time_s, speed=0.0, turn=0.0, **ranges_m):
    return dataclasses.replace(free(**ranges_m), time_s=time_s, linear_m_s=speed, angular_rad_s=turn)


@given(st.floats(-0.5, 0.5), st.floats(-2.0, 2.0))
def test_a_remembered_echo_stays_where_it_is_in_the_world(speed, turn):
    first = remember(EchoMemory(), at(0.0, i1=0.15), CONFIG)
    later = remember(first, at(0.1, speed, turn), EchoMemoryConfig(within_m=0.9))
    pose = 0.1 * speed * np.exp(0.05j * turn)  # where the robot is by now, as a complex number
    x, y = later.points[0]
    world = pose + (x + 1j * y) * np.exp(0.1j * turn)
    assert [world.real, world.imag] == pytest.approx(first.points[0], abs=1e-9)


def test_far_echoes_are_not_remembered_and_old_ones_forgotten():
    memory = remember(EchoMemory(), at(0.0, i1=0.15, i4=1.5), CONFIG)
    assert len(memory.points) == 1
    assert len(remember(memory, at(CONFIG.keep_s - 0.1), CONFIG).points) == 1
    assert len(remember(memory, at(CONFIG.keep_s + 0.1), CONFIG).points) == 0


def test_senseless_input_leaves_the_memory_alone():
    memory = remember(EchoMemory(), at(0.0, i1=0.15), CONFIG)
    assert remember(memory, at(math.nan), CONFIG) is memory


def test_a_post_that_slips_between_two_cones_is_not_swept_by_the_corner():
    """The person walks on behind the wall, and the robot turns beside the door post to search."""
    speed, course = 0.7355481649769062, 0.7226185879294431
    path = straight((2.9991, -0.7044), (speed * math.cos(course), speed * math.sin(course)), 2.0, 12.0)
    toy = Toy(path=path, walls=room((0.0, 1.5)), rng=np.random.default_rng(4))
    behaviour = make_behaviour("follow_person")
    for _ in range(300):
        toy.step(behaviour)
        assert toy.wall_gap() > 0.03
