import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.behaviours.corridor.corridor_from_sonar import corridor_from_sonar, mounts
from peopleboy.behaviours.corridor.corridor_geometry import Corridor, Unknown, blend, drive_on
from peopleboy.behaviours.dead_reckoning import RobotMotion
from tests.helpers.images.drawn_corridors import percept_of, sonar_in_corridor
from tests.helpers.percepts.toy_world import SONAR_ANGLE, SONAR_X, SONAR_Y

places = {
    "share": st.floats(-0.5, 0.5),  # of the room beside the robot
    "heading": st.floats(-0.5, 0.5),
    "width": st.floats(1.8, 4.0),
}


def test_the_ring_is_that_of_the_parameter_file_within_3_cm():
    assert np.abs(mounts(SONAR_ANGLE) - np.stack([SONAR_X, SONAR_Y], axis=1)).max() < 0.03


@settings(deadline=None)
@given(**places)
def test_offset_heading_and_width_are_recovered_from_one_reading(share, heading, width):
    offset = share * (width - 1.0)
    found = corridor_from_sonar(percept_of(sonar_in_corridor(offset, heading, width)))
    assert isinstance(found, Corridor)
    assert abs(found.offset_m - offset) < 0.02
    assert abs(found.heading_rad - heading) < math.radians(1.5)
    assert abs(found.width_m - width) < 0.04


@settings(deadline=None)
@given(**places, seed=st.integers(0, 999))
def test_noise_of_a_centimetre_shifts_it_by_no_more_than_two(share, heading, width, seed):
    offset = share * (width - 1.0)
    ranges = sonar_in_corridor(offset, heading, width) + np.random.default_rng(seed).normal(0.0, 0.01, 16)
    found = corridor_from_sonar(percept_of(ranges))
    assert isinstance(found, Corridor)
    assert abs(found.offset_m - offset) < 0.03
    assert abs(found.heading_rad - heading) < math.radians(3.0)


def test_with_a_place_expected_one_wall_is_enough():
    ranges = sonar_in_corridor(0.2, 0.05, 3.0)
    ranges[np.sin(SONAR_ANGLE) > 0.0] = 5.0  # the left side is open
    expected = Corridor(offset_m=0.25, heading_rad=0.0, width_m=3.0)
    found = corridor_from_sonar(percept_of(ranges), expected)
    assert isinstance(found, Corridor)
    assert found.offset_m == pytest.approx(0.2, abs=0.02)
    assert found.heading_rad == pytest.approx(0.05, abs=0.03)
    assert isinstance(corridor_from_sonar(percept_of(ranges)), Unknown)


def test_people_beside_the_robot_are_not_taken_for_a_wall_that_is_expected_elsewhere():
    ranges = sonar_in_corridor(0.0, 0.0, 3.0)
    ranges[[0, 1]] = 0.6
    found = corridor_from_sonar(percept_of(ranges), Corridor(offset_m=0.0, heading_rad=0.0, width_m=3.0))
    assert isinstance(found, Corridor)
    assert abs(found.offset_m) < 0.02


@pytest.mark.parametrize("reading", [5.0, math.nan])
def test_where_nothing_is_heard_no_corridor_is_told_and_why(reading):
    found = corridor_from_sonar(percept_of(np.full(16, reading)))
    assert found == Unknown("the sonars detect no corridor walls")


def test_dead_reckoning_follows_the_arc_and_blending_goes_a_share_of_the_way():
    start = Corridor(offset_m=0.1, heading_rad=0.0, width_m=3.0)
    turned = drive_on(start, RobotMotion(1.0, 0.2, 1.0))
    assert turned.offset_m == pytest.approx(0.1 + (1.0 - math.cos(0.2)) / 0.2, abs=1e-3)  # a circle's
    assert turned.heading_rad == 0.2
    assert blend(start, dataclasses.replace(start, offset_m=0.5), 0.25).offset_m == pytest.approx(0.2)
