import math
from dataclasses import replace

import numpy as np
import pytest

from peopleboy.behaviours.behaviour import STOP
from peopleboy.behaviours.echo_map import EchoMap, EchoMapConfig
from peopleboy.behaviours.go_to import GoTo
from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.geometry.pose2 import Pose2
from tests.helpers.percepts.percepts import percept, person
from tests.helpers.percepts.toy_world import Toy, drive, room, wall

NO_PEOPLE = np.zeros((0, 2))


def away(_: float) -> tuple[float, float]:
    """Return where the toy's person is out of the way."""
    return 9.0, 3.0


def length_m(route):
    return float(np.hypot(*np.diff(route, axis=0).T).sum())


def test_on_free_floor_the_route_is_the_straight_line_to_a_cell() -> None:
    there = EchoMap((0.0, 0.0), (4.0, 0.0), EchoMapConfig())
    route = there.find_route(Pose2(), (4.0, 0.0), 0.0, NO_PEOPLE, 1.0)
    assert length_m(route) == pytest.approx(4.0, abs=0.1)
    assert np.abs(route[:, 1]).max() <= 0.1


def test_a_route_keeps_its_distance_from_an_echo_and_from_people() -> None:
    there, config = EchoMap((0.0, 0.0), (4.0, 0.0), EchoMapConfig()), EchoMapConfig()
    ranges = np.full(16, 5.0)
    ranges[3:5] = 1.8
    there.update(replace(percept(0.0), sonar_m=ranges))
    route = there.find_route(Pose2(), (4.0, 0.0), 0.0, NO_PEOPLE, 1.0)
    hits = np.array([[1.95, 0.3], [1.95, -0.3]])  # 10 degrees to either side
    assert min(np.hypot(*(route - hit).T).min() for hit in hits) > config.body_m - config.cell_m
    person_at = np.array([[2.0, 2.0]])
    beside = there.find_route(Pose2(), (4.0, 0.0), 0.0, person_at, 2.5)
    assert np.hypot(*(beside - person_at[0]).T).min() > 2.4
    assert there.find_route(Pose2(), (4.0, 0.0), 0.0, np.array([[4.0, 0.5]]), 1.0) is None


def test_floor_on_which_a_cone_passes_is_free_again_and_old_echoes_are_forgotten() -> None:
    config = EchoMapConfig()
    blocked = np.full(16, 5.0)
    blocked[3:5] = 1.8
    there = EchoMap((0.0, 0.0), (4.0, 0.0), config)
    there.update(replace(percept(0.0), sonar_m=blocked))
    around = there.find_route(Pose2(), (4.0, 0.0), 0.0, NO_PEOPLE, 1.0)
    late = there.find_route(Pose2(), (4.0, 0.0), config.keep_s + 1.0, NO_PEOPLE, 1.0)
    there.update(percept(1.0))
    again = there.find_route(Pose2(), (4.0, 0.0), 1.0, NO_PEOPLE, 1.0)
    assert length_m(around) > length_m(again) == pytest.approx(length_m(late)) == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("opening", [(-3.0, -1.8), (1.5, 3.0)])
def test_the_robot_finds_the_gap_in_a_wall_and_stops_at_the_goal(opening) -> None:
    toy = Toy(path=away, walls=room(opening))
    log = drive(toy, make_behaviour("go_to", goal_m=(7.0, 0.0)), 60.0)
    assert log.mode[-1] == "arrived"
    assert math.dist(log.robot[-1, :2], (7.0, 0.0)) < 0.3
    assert not log.is_contact.any()


@pytest.mark.slow
def test_the_robot_gets_out_of_a_dead_end() -> None:
    dead_end = [wall((3.0, -1.5), (6.0, -1.5)), wall((3.0, 1.5), (6.0, 1.5)), wall((6.0, -1.5), (6.0, 1.5))]
    toy = Toy(path=away, walls=np.concatenate([room((-4.0, 4.0)), *dead_end]))
    log = drive(toy, make_behaviour("go_to", goal_m=(8.0, 0.0)), 80.0)
    assert log.mode[-1] == "arrived"
    assert not log.is_contact.any()


def test_the_robot_waits_while_a_person_stands_at_the_goal_and_without_a_goal() -> None:
    behaviour = GoTo()
    assert behaviour.command(percept(1.0)) == STOP
    assert (behaviour.mode, behaviour.reason) == ("wait", "no goal")
    at_goal = percept(2.0, person(0.0, 1.75 / (2.0 * math.tan(math.radians(22.0)) * 4.0)), goal_m=(4.0, 0.0))
    assert behaviour.command(at_goal) == STOP
    assert behaviour.reason == "people leave no route"
    assert behaviour.command(percept(3.0, goal_m=(4.0, 0.0))).linear_m_s > 0.0
    assert behaviour.mode == "drive"


def test_invalid_or_old_input_stops_the_robot() -> None:
    behaviour = GoTo()
    behaviour.command(percept(1.0, goal_m=(4.0, 0.0)))
    for wrong in (
        percept(1.0, goal_m=(4.0, 0.0)),
        percept(2.0, goal_m=(4.0, 0.0), odometry=Pose2(math.nan, 0.0, 0.0)),
    ):
        assert behaviour.command(wrong) == STOP
        assert behaviour.mode == "blind"
