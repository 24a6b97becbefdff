import math
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.loop.loop import closed_loop
from peopleboy.scenarios.scores.corridor_metrics import Leg, centre_line, legs_of, score_corridor
from peopleboy.scenarios.scores.drive_record import DriveLog
from peopleboy.sim.places.floor_plan import Rectangle
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.drives import made_drive

LEG = Leg((0.0, 0.0), (20.0, 0.0), 3.0)


def score(x, y, heading, contact=None, legs=(LEG,)):
    count = len(x)
    robot = np.stack([x, np.broadcast_to(y, count), np.broadcast_to(heading, count)], axis=1).astype(float)
    is_contact = np.zeros(count, bool) if contact is None else np.array(contact)
    return score_corridor(made_drive(np.arange(count) / 2.0, robot, is_contact=is_contact), legs)


def test_a_robot_beside_the_middle_has_that_lateral_error_either_way_along():
    there, back = np.linspace(0.0, 20.0, 41), np.linspace(20.0, 0.0, 41)
    for x, heading in ((there, 0.1), (back, math.pi - 0.1)):
        found = score(x, -0.2, heading)
        assert found.lateral_rms_m == pytest.approx(0.2)
        assert found.lateral_max_m == pytest.approx(0.2)
        assert found.heading_error_rad == pytest.approx(0.1)
        assert found.mean_speed_m_s == pytest.approx(1.0)
        assert (found.way_m, found.legs, found.contacts) == (pytest.approx(20.0), 1, 0)


def test_near_ends_and_junctions_nothing_counts():
    branch = Leg((10.0, 1.5), (10.0, 12.0), 3.0)
    x = np.linspace(0.0, 20.0, 401)
    off = np.where((np.abs(x - 10.0) < 3.0) | (x < 3.0) | (x > 17.0), 1.0, 0.1)
    assert score(x, off, 0.0, legs=(LEG, branch)).lateral_max_m == pytest.approx(0.1)
    assert score(x, off, 0.0).lateral_max_m == pytest.approx(1.0)


def test_contacts_count_once_each_and_a_robot_on_no_leg_has_no_error():
    found = score(np.full(5, 50.0), 0.0, 0.0, [True, True, False, True, False])
    assert found.contacts == 2
    assert math.isnan(found.lateral_rms_m)
    assert found.legs == 0


def test_arrays_that_do_not_belong_together_are_refused():
    with pytest.raises(BadInput, match="shapes"):
        score(np.zeros(3), 0.0, 0.0, [False, True])


def test_a_centre_line_runs_along_the_longer_side():
    assert centre_line(Rectangle(0.0, -1.0, 9.0, 1.0)) == Leg((0.0, 0.0), (9.0, 0.0), 2.0)
    assert centre_line(Rectangle(7.0, 1.0, 9.0, 9.0)) == Leg((8.0, 1.0), (8.0, 9.0), 2.0)


class NoTracker:
    cameras = ()

    def update(self, _frame):
        return ()


@pytest.mark.slow
def test_a_robot_in_a_world_follows_its_corridor_by_the_image_and_keeps_the_middle():
    scenario = load_scenario("corridor_straight")
    robot = replace(scenario.spec.robot, walls_by="image")
    scenario = replace(scenario, spec=replace(scenario.spec, robot=robot))
    log = DriveLog()
    with SimulatedWorld(scenario.world(0)) as world:
        modes = set()
        for tick in closed_loop(world, NoTracker(), scenario.make_behaviour(), 7 * 15):
            log.add(tick.truth, track=0)
            modes.add(tick.mode)
    found = score_corridor(log.record(), legs_of(scenario.plan))
    assert "corridor" in modes
    assert found.contacts == 0
    assert found.way_m > 2.0
    assert found.lateral_rms_m < 0.1
