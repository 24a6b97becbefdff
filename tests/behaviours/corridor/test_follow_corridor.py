import math

import numpy as np
import pytest

from peopleboy.behaviours.corridor.corridor_from_sonar import EndConfig, open_room, wall_ahead
from peopleboy.behaviours.corridor.corridor_geometry import Corridor, LaneConfig, best_lane
from peopleboy.behaviours.corridor.follow_corridor import FollowCorridor, FollowCorridorConfig
from peopleboy.behaviours.make_behaviour import make_behaviour
from tests.helpers.images.drawn_corridors import CAMERA, drawn_corridor, percept_of, sonar_in_corridor
from tests.helpers.percepts.toy_world import SONAR_ANGLE, Toy, drive, wall

STRAIGHT = Corridor(offset_m=0.0, heading_rad=0.0, width_m=3.0)


def percept_before_wall(distance, width=3.0):
    """Ranges in a straight corridor with a wall across it."""
    fan = np.radians(np.linspace(-7.5, 7.5, 61))
    ahead = np.cos(SONAR_ANGLE[:, None] + fan)
    to_wall = np.where(ahead > 0.0, (distance - 0.15) / np.maximum(ahead, 1e-9), 99.0).min(axis=1)
    return percept_of(np.minimum(sonar_in_corridor(0.0, 0.0, width), to_wall))


@pytest.mark.parametrize("distance", [0.8, 1.5, 2.0])
def test_a_wall_across_is_told_by_its_distance_and_a_person_is_not_one(distance):
    assert wall_ahead(percept_before_wall(distance), STRAIGHT, EndConfig()) == pytest.approx(
        distance, abs=0.1
    )
    ranges = sonar_in_corridor(0.0, 0.0, 3.0)
    ranges[[3, 4]] = distance
    assert wall_ahead(percept_of(ranges), STRAIGHT, EndConfig()) is None


def test_a_side_without_its_wall_is_open():
    ranges = sonar_in_corridor(0.0, 0.0, 3.0)
    assert open_room(percept_of(ranges), STRAIGHT, EndConfig()) == (0.0, 0.0)
    ranges[[7, 8]] = 4.0
    assert open_room(percept_of(ranges), STRAIGHT, EndConfig()) == (0.0, pytest.approx(2.5))


def test_the_lane_is_the_middle_unless_somebody_is_near_it_and_then_the_clearest_side():
    config = LaneConfig()
    assert best_lane(np.zeros((0, 2)), STRAIGHT, config).offset_m == 0.0
    assert best_lane(np.array([(1.0, 0.9)]), STRAIGHT, config).offset_m == 0.0
    assert best_lane(np.array([(1.0, 0.4)]), STRAIGHT, config).offset_m == pytest.approx(-0.35)
    across = best_lane(np.array([(1.0, y) for y in (-1.0, -0.3, 0.3, 1.0)]), STRAIGHT, config)
    assert across.clearance_m < config.least_m


def corridor_walls(length=14.0, width=3.0):
    half = width / 2.0
    sides = [wall((-2.0, side * half), (length, side * half)) for side in (1.0, -1.0)]
    return np.concatenate([*sides, wall((length, -half), (length, half)), wall((-2.0, -half), (-2.0, half))])


def nobody(_):
    return (99.0, 99.0)


def drive_to_the_end(width, beside, length, seconds):
    toy = Toy(path=nobody, walls=corridor_walls(length, width), rng=np.random.default_rng(0))
    toy.pose = np.array([0.0, beside, 0.2])
    return drive(toy, make_behaviour("follow_corridor"), seconds)


@pytest.mark.slow
def test_the_robot_finds_the_middle_keeps_it_and_turns_back_at_the_dead_end():
    log = drive_to_the_end(width=3.0, beside=0.5, length=14.0, seconds=40.0)
    x, y, heading = log.robot.T
    assert not log.is_contact.any()
    assert np.abs(y[(log.time_s > 8.0)]).max() < 0.1
    assert x.max() > 11.0
    assert abs(math.remainder(heading[-1] - math.pi, math.tau)) < 0.1
    assert "turn" in log.mode


@pytest.mark.slow
@pytest.mark.parametrize("width", [2.2, 1.4])
def test_the_end_of_a_narrow_corridor_is_not_taken_for_people_who_stand_there(width):
    log = drive_to_the_end(width=width, beside=0.1, length=6.0, seconds=22.0)
    x, y, heading = log.robot.T
    assert not log.is_contact.any()
    assert np.abs(y[(log.time_s > 4.0)]).max() < 0.1
    assert abs(math.remainder(heading[-1] - math.pi, math.tau)) < 0.1
    assert x[-1] < x.max() - 0.5  # on its way back


def test_the_robot_waits_for_who_stands_in_the_way_and_goes_on_when_the_way_is_free():
    toy = Toy(
        path=lambda t: (5.0, 0.0) if t < 11.0 else (5.0, 1.2),
        walls=corridor_walls(),
        rng=np.random.default_rng(0),
    )
    log = drive(toy, make_behaviour("follow_corridor"), 20.0)
    assert not log.is_contact.any()
    assert "wait" in log.mode
    assert log.robot[-1, 0] > 5.0


@pytest.mark.slow
def test_the_robot_passes_who_stays_in_the_way():
    toy = Toy(path=lambda _: (5.0, 0.0), walls=corridor_walls(), rng=np.random.default_rng(0))
    log = drive(toy, make_behaviour("follow_corridor"), 28.0)
    assert not log.is_contact.any()
    assert log.mode.index("wait") < log.mode.index("pass")
    assert log.robot[-1, 0] > 7.0


def test_people_all_across_the_way_are_waited_for():
    walls = np.concatenate([corridor_walls(), *(wall((5.0, y), (5.1, y + 0.25)) for y in (-0.9, 0.6))])
    toy = Toy(path=lambda _: (5.0, 0.0), walls=walls, rng=np.random.default_rng(0))
    log = drive(toy, make_behaviour("follow_corridor"), 20.0)
    assert not log.is_contact.any()
    assert log.robot[:, 0].max() < 4.6


@pytest.mark.slow
def test_the_robot_turns_into_the_side_that_is_open():
    walls = np.concatenate(
        [
            wall((-2.0, -1.5), (10.0, -1.5)),
            wall((-2.0, 1.5), (7.0, 1.5)),
            wall((10.0, -1.5), (10.0, 12.0)),
            wall((7.0, 1.5), (7.0, 12.0)),
        ]
    )
    log = drive(Toy(path=nobody, walls=walls), make_behaviour("follow_corridor"), 28.0)
    assert not log.is_contact.any()
    assert log.robot[-1, 1] > 3.0
    assert log.robot[-1, 0] == pytest.approx(8.5, abs=0.1)


def test_in_the_dark_the_sonars_take_over_and_the_reason_says_so():
    behaviour = FollowCorridor(FollowCorridorConfig(sense="image", camera=CAMERA))
    ranges = sonar_in_corridor(0.4, 0.0, 3.0)
    behaviour.command(percept_of(ranges, 1.0, images={"colour": drawn_corridor(0.2, 0.0, 3.0)}))
    assert behaviour.mode == "corridor"
    assert behaviour.state.corridor.offset_m == pytest.approx(0.2, abs=0.05)  # the image's word
    for step in range(1, 30):
        dark = drawn_corridor(0.2, 0.0, 3.0, light=0.0)
        command = behaviour.command(percept_of(ranges, 1.0 + step / 15.0, images={"colour": dark}))
    assert behaviour.mode == "sonar"
    assert "too dark" in behaviour.reason
    assert behaviour.state.corridor.offset_m == pytest.approx(0.4, abs=0.03)  # the sonars'
    assert command.linear_m_s > 0.0


def test_without_new_input_or_walls_the_robot_does_not_drive():
    behaviour = FollowCorridor()
    assert behaviour.command(percept_of(np.full(16, 5.0))).linear_m_s == 0.0
    assert behaviour.mode == "search"
    behaviour.command(percept_of(sonar_in_corridor(0.0, 0.0, 3.0), 1.1))
    command = behaviour.command(percept_of(sonar_in_corridor(0.0, 0.0, 3.0), 1.1))
    assert (command.linear_m_s, command.angular_rad_s, behaviour.mode) == (0.0, 0.0, "blind")
