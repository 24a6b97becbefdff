import math

import numpy as np
import pytest

from peopleboy.sim.geometry.vectors import remainder
from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.crowd import those_present
from peopleboy.sim.people.person_config import Reaction, Waypoint
from peopleboy.sim.people.walking.script import WALK, is_scripted, join_records, join_scripts
from peopleboy.sim.people.walking.social_force import PlanarState
from peopleboy.sim.people.walking.walk_kernels import _hypot, walk_on
from peopleboy.sim.people.walking.walker import NO_WALKERS
from tests.helpers.worlds.walkers import NO_WALLS, make_person

DT_S = 1 / 15
FACES = (None, "robot", (0.0, 7.0))


def chance_person(rng, yields=False, name="ann"):
    """Somebody whose script has corners, about-turns, pauses, seats, and times to come and go."""
    points = rng.uniform(-3.0, 3.0, (rng.integers(1, 7), 2))
    path = tuple(
        Waypoint(
            at_m=tuple(point.tolist()),
            speed_m_s=float(rng.uniform(0.3, 1.6)),
            pause_s=float(rng.choice([0.0, rng.uniform(0.1, 3.0)])),
            face=FACES[rng.integers(3)],
            posture=Posture.SITTING if rng.random() < 0.2 else Posture.STANDING,
        )
        for point in points
    )
    enter_s = float(rng.choice([0.0, rng.uniform(0.1, 2.0)]))
    leave_s = float(rng.uniform(10.0, 20.0)) if rng.random() < 0.3 else None
    return make_person(path=path, enter_s=enter_s, leave_s=leave_s, yields=yields, name=name)


def assert_walk_alike(people, walks):
    for person, walk in zip(people, walks, strict=True):
        assert person.present == walk["is_present"]
        assert person.position.tobytes() == walk["position"].tobytes()
        assert person.velocity.tobytes() == walk["velocity"].tobytes()
        assert person.heading == walk["heading"]


def write_down(people):
    """The records and scripts of all people, side by side."""
    assert all(is_scripted(person.config) for person in people)
    walks = join_records([person.walker.walks for person in people], WALK)
    return walks, join_scripts([person.walker.script for person in people])


def test_people_walk_together_to_the_last_bit_as_each_alone_with_a_robot_in_their_way():
    rng = np.random.default_rng(0)
    people = [chance_person(rng) for _ in range(40)]
    walks, scripts = write_down(people)
    stopped = 0
    for k in range(300):
        place = (2.0 * math.sin(0.02 * k), 1.5 * math.cos(0.013 * k))
        robot = PlanarState(position=np.array(place), velocity=np.zeros(2), radius_m=0.355)
        for person in people:
            person.step(k * DT_S, DT_S, NO_WALKERS, robot, NO_WALLS)
        motion = (*place, 0.0, 0.0, 0.355)
        walk_on(0, len(people), walks, scripts, k * DT_S, DT_S, motion, NO_WALLS, 2.0)
        assert_walk_alike(people, walks)
        stopped += sum(person.walker.is_walking and not person.velocity.any() for person in people)
    assert stopped > 0  # the robot was in somebody's way


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_people_make_way_together_to_the_last_bit_as_each_alone(seed):
    rng = np.random.default_rng(seed)
    people = [chance_person(rng, yields=bool(rng.random() < 0.7), name=f"p{k}") for k in range(12)]
    walks, scripts = write_down(people)
    walls = np.array([[-0.5, 1.0, 0.0, 2.0], [3.5, -4.0, 3.6, 4.0]])
    reached = 0
    for k in range(300):
        place, velocity = (2.0 * math.sin(0.02 * k), 1.0), (0.6 * math.cos(0.02 * k), 0.0)
        robot = PlanarState(np.array(place), np.array(velocity), radius_m=0.355)
        present = those_present(people)
        for person in people:
            person.step(k * DT_S, DT_S, present, robot, walls)
        walk_on(0, len(people), walks, scripts, k * DT_S, DT_S, (*place, *velocity, 0.355), walls, 2.0)
        assert_walk_alike(people, walks)
        reached += sum(person.walker.is_walking for person in people if person.config.yields)
    assert reached > 300


@pytest.mark.parametrize(
    "settings",
    [
        {"reacts": Reaction(way="ignores")},
        {"group": "pair"},
        {"path": (Waypoint(at_m=(0.0, 0.0), face="ben", pause_s=1.0), Waypoint(at_m=(1.0, 0.0)))},
        {"path": (Waypoint(at_m=(0.0, 0.0), until_robot_within_m=1.0), Waypoint(at_m=(1.0, 0.0)))},
    ],
)
def test_whoever_heeds_somebody_is_not_scripted(settings):
    assert not is_scripted(make_person(**settings).config)


def test_the_length_of_a_vector_is_that_of_the_library():
    pairs = np.random.default_rng(0).normal(size=(2000, 2)).tolist()
    assert [_hypot(x, y) for x, y in pairs] == [math.hypot(x, y) for x, y in pairs]


def test_the_remainder_of_kernels_is_that_of_the_library():
    angles = np.random.default_rng(0).uniform(-9.4, 9.4, 2000).tolist()
    assert [remainder(angle) for angle in angles] == [math.remainder(angle, math.tau) for angle in angles]
