import math

import pytest

from benchmarks.safety import KINDS, Drive, drive_in, failures_in, fault_of, summarise, world_of
from peopleboy.scenarios.scores.contacts import Contact


def drive(fault="", *contacts, stopping_s=math.nan, speed_m_s=math.nan):
    return Drive(
        seed=3,
        fault=fault,
        driven_m=2.0,
        nearest_m=0.7,
        contacts=contacts,
        speed_m_s=speed_m_s,
        stopping_s=stopping_s,
        stopping_m=0.1,
    )


def contact(robot_m_s, cause):
    return Contact(time_s=1.0, other="box", robot_m_s=robot_m_s, relative_m_s=0.4, cause=cause)


def test_every_third_world_has_a_fault_and_all_kinds_come():
    assert [bool(fault_of(seed)) for seed in range(6)] == [True, False, False, True, False, False]
    assert {fault_of(3 * k) for k in range(len(KINDS))} == set(KINDS)


def test_contacts_at_speed_and_a_robot_that_drives_on_blind_are_unsafe():
    assert not failures_in([drive("", contact(0.4, "person")), drive("", contact(0.04, "robot"))])
    assert "hits box at 0.4 m/s" in failures_in([drive("", contact(0.4, "robot"))])[0]
    assert "not at rest" in failures_in([drive("camera_black", speed_m_s=0.5)])[0]
    assert not failures_in([drive("camera_black", speed_m_s=0.5, stopping_s=0.3)])
    assert not failures_in([drive("wheel_slip", speed_m_s=0.5)])


def test_the_table_has_a_row_for_each_fault():
    rows = summarise([drive(), drive("camera_black", contact(0.2, "robot"), speed_m_s=0.5, stopping_s=0.27)])
    assert [row[0] for row in rows] == ["none", "camera_black"]
    assert rows[1][3:5] == ["1", "0.20"]
    assert rows[1][8:] == ["1/1", "0.27", "0.10"]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 45])
def test_no_fault_makes_the_robot_touch_anything(seed):
    found = drive_in(world_of(seed, "truth", 14.0), seed, "truth")
    assert found.driven_m > 1.0
    assert not failures_in([found])
    if found.fault == "camera_lost":
        assert found.stopping_s < 0.45
