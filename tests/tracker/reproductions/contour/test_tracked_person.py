from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.reproductions.contour.particle_filter import Belief
from peopleboy.tracker.reproductions.contour.particles import equally_weighted
from peopleboy.tracker.reproductions.contour.tracked_person import (
    HEIGHT,
    PERSON_M,
    SIZE,
    TrackedPerson,
    approached,
)

FOCAL_PX = 297.0
HORIZON = 119.5


def standing(distance_m, camera_m=1.2):
    h = FOCAL_PX * PERSON_M / distance_m / HEIGHT
    state = np.array([160, HORIZON, 0.4 * h, h, 0, 0, 0, 0, 0])
    cloud = equally_weighted(state[None].astype(np.float32))
    foot = HORIZON + FOCAL_PX * camera_m / distance_m
    return TrackedPerson(1, 0.0, Belief(cloud, cloud, state, 0.9, 1.0), state, np.zeros(2), foot, state[SIZE])


@given(distance_m=st.floats(2, 12), advance_m=st.floats(-0.1, 0.1))
def test_who_stands_grows_as_the_pinhole_camera_says_when_the_robot_drives(distance_m, advance_m):
    view = SimpleNamespace(mount=Mount(HORIZON, FOCAL_PX, 1.2), advance_m=advance_m)
    later, expected = approached(standing(distance_m), view), standing(distance_m - advance_m)
    assert later.size == pytest.approx(expected.size)
    assert later.foot == pytest.approx(expected.foot)


def test_a_robot_that_drives_through_a_person_does_not_make_it_grow_without_end():
    view = SimpleNamespace(mount=Mount(HORIZON, FOCAL_PX, 1.2), advance_m=5.0)
    assert approached(standing(4.0), view).size == pytest.approx(2 * standing(4.0).size)
