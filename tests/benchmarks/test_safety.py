import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.reliability.safety import (
    COLUMNS,
    KINDS,
    Approach,
    Drive,
    blamed,
    drive_of,
    failures_in,
    fault_of,
    groups_of,
    measure_stop,
    summarise,
)
from peopleboy.scenarios.files.scenario_file import FaultSpec
from peopleboy.scenarios.scores.contacts import Contact
from tests.helpers.some_of import some_of


def drive(fault="", *contacts, stopping_s=math.nan, speed_m_s=math.nan):
    return Drive(
        seed=3,
        fault=fault,
        driven_m=2.0,
        fastest_s=1.0,
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


def test_a_person_who_enters_where_the_robot_stands_counts_when_they_are_apart():
    approach = Approach()
    for gap_m in (0.0, 0.2):
        approach.add({"anna": gap_m})
    assert approach.nearest_m == math.inf
    for gap_m in (0.5, 0.25, 0.9):
        approach.add({"anna": gap_m, "bert": 0.0})
    assert approach.nearest_m == 0.25


def test_drives_are_grouped_by_fault_and_summarised():
    stopped = drive("camera_black", contact(0.2, "robot"), speed_m_s=0.5, stopping_s=0.27)
    groups = groups_of([drive(), stopped, drive("wheel_slip", contact(0.0, "person"))])
    assert {name: len(own) for name, own in groups.items()} == {
        "none": 1, "blinding": 1, "other": 1, "camera_black": 1, "wheel_slip": 1,
    }  # fmt: skip
    assert summarise(groups["none"])["fastest"] is None
    found = summarise(groups["blinding"])
    assert (found["by robot"], found["fastest"], found["at rest"], found["after"]) == (1, 0.2, 1, 0.27)
    assert summarise(groups["other"])["by person"] == 1
    assert list(found) == list(COLUMNS)


def test_a_stop_is_measured_between_the_frames():
    time_s, speed = np.arange(6) / 10.0, np.array([0.8, 0.8, 0.5, 0.1, 0.0, 0.0])
    fault = FaultSpec(kind="camera_black", from_s=0.1, lasts_s=0.35)
    stop = measure_stop(time_s, speed, np.cumsum(speed) / 10.0, fault)
    assert stop == pytest.approx((0.8, 0.25, 0.06))
    assert math.isnan(measure_stop(time_s, speed + 1.0, speed, fault).after_s)
    assert measure_stop(time_s, 0.0 * speed, speed, fault).after_s == 0.0


def test_a_contact_while_the_robot_is_pushed_is_not_its_own():
    fault = FaultSpec(kind="robot_pushed", from_s=0.5, lasts_s=1.0)
    late = replace(contact(0.4, "robot"), time_s=3.0)
    found = blamed([contact(0.4, "robot"), late], [fault])
    assert [one.cause for one in found] == ["person", "robot"]


@pytest.mark.slow
@pytest.mark.parametrize("seed", some_of([0, 45], 2))
def test_no_fault_makes_the_robot_touch_anything(seed):
    found = drive_of(seed, "truth", 14.0)
    assert found.fault == fault_of(seed)
    assert found.speed_m_s > 0.15
    assert not failures_in([found])
    if found.fault == "camera_lost":
        assert found.stopping_s < 0.31


@pytest.mark.slow
def test_worlds_in_which_the_robot_hardly_drives_do_not_count():
    assert drive_of(117, "truth", 6.0) is None
