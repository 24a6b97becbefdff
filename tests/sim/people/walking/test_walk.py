import math
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.sim.people.body.postures import Posture
from peopleboy.sim.people.person_config import Waypoint
from peopleboy.sim.people.walking.path import CORNER_CUT_M, abreast, route
from peopleboy.sim.people.walking.script import TURN_RATE_RAD_S
from peopleboy.sim.people.walking.social_force import PlanarState
from peopleboy.sim.people.walking.walk_kernels import ACCELERATION_M_S2, _put
from peopleboy.sim.people.walking.walker import ALONE, Present, Walker, Wish, timetable
from tests.helpers.worlds.walkers import make_person, settle, walk, walk_together


def path(*points, **options):
    return tuple(Waypoint(at_m=p, **options) for p in points)


def track_of(person, seconds, **options):
    rows = [(t, *person.position, person.heading) for t in walk(person, seconds, **options)]
    return np.array(rows)


@pytest.mark.parametrize(("distance", "speed"), [(8.0, 1.2), (3.0, 0.5), (20.0, 1.6), (0.5, 1.5)])
def test_a_straight_walk_takes_distance_over_speed_plus_ramps(distance, speed):
    top = min(speed, math.sqrt(distance * ACCELERATION_M_S2))
    expected = distance / top + top / ACCELERATION_M_S2
    person = make_person(path=path((0.0, 0.0), (distance, 0.0), speed_m_s=speed))
    arrival = timetable(person.config)[-1]
    assert arrival.time_s == pytest.approx(expected, abs=0.2)
    assert (arrival.x_m, arrival.y_m) == pytest.approx((distance, 0.0))
    track = track_of(person, expected + 1.0)
    arrived = track[np.abs(track[:, 1] - distance) < 1e-3][0, 0]
    assert arrived == pytest.approx(arrival.time_s, abs=0.15)


def test_the_timetable_tells_pauses_passing_and_leaving():
    way = (
        Waypoint(at_m=(0.0, 0.0), pause_s=2.0),
        Waypoint(at_m=(2.0, 0.0)),
        Waypoint(at_m=(4.0, 1.0), pause_s=3.0),
        Waypoint(at_m=(4.0, 4.0)),
    )
    entries = timetable(make_person(path=way, enter_s=5.0, leave_s=60.0).config)
    assert [e.what for e in entries] == [
        "enters", "leaves 0", "passes 1", "reaches 2", "leaves 2", "reaches 3", "leaves the world",
    ]  # fmt: skip
    times = [e.time_s for e in entries]
    assert times == sorted(times)
    assert times[0] == 5.0
    assert times[1] == pytest.approx(7.0, abs=0.2)
    assert times[-1] == 60.0


def test_the_timetable_is_what_the_person_does():
    way = (
        *path((0.0, 0.0), (3.0, 0.0), (3.0, 3.0)),
        Waypoint(at_m=(0.0, 3.0), pause_s=1.0),
        Waypoint(at_m=(0.0, 0.0)),
    )
    person = make_person(path=way)
    for k, entry in enumerate(timetable(person.config)):
        settle(
            person,
            entry.time_s - float(person.stance["time_s"][0]) if k else 0.0,
            start=float(person.stance["time_s"][0]),
        )
        assert math.dist(person.position, (entry.x_m, entry.y_m)) < 0.15


def distance_to_line(points, line):
    """(N,) [m] from points to the nearest place of a polyline."""
    best = np.full(len(points), np.inf)
    for a, b in pairwise(line):
        along = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - a - along[:, None] * (b - a), axis=1))
    return best


def test_a_script_is_followed_within_centimetres():
    line = np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (1.0, 4.0), (1.2, 0.5)])
    person = make_person(path=path(*map(tuple, line), speed_m_s=1.4))
    track = track_of(person, 20.0)
    assert distance_to_line(track[:, 1:3], line).max() < CORNER_CUT_M + 0.005
    assert math.dist(track[-1, 1:3], line[-1]) < 0.01
    for corner in line:
        assert np.linalg.norm(track[:, 1:3] - corner, axis=1).min() < CORNER_CUT_M + 0.01


def test_speed_acceleration_and_turning_are_limited():
    line = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (1.0, 4.0), (1.2, 0.5)]
    track = track_of(make_person(path=path(*line, speed_m_s=1.4)), 20.0)
    velocity = np.diff(track[:, 1:3], axis=0) * 60
    speed = np.linalg.norm(velocity, axis=1)
    assert speed.max() < 1.4 + 1e-6
    assert np.abs(np.diff(speed)).max() * 60 < 1.5 * ACCELERATION_M_S2
    turns = np.abs(np.remainder(np.diff(track[:, 3]) + np.pi, 2 * np.pi) - np.pi) * 60
    assert turns.max() < TURN_RATE_RAD_S + 1e-6


def test_sharp_corners_are_taken_slowly():
    def slowest(corner):
        person = make_person(path=path((0.0, 0.0), (4.0, 0.0), corner, speed_m_s=1.4))
        track = track_of(person, 10.0)
        speed = np.linalg.norm(np.diff(track[:, 1:3], axis=0), axis=1) * 60
        near = np.linalg.norm(track[1:, 1:3] - [4.0, 0.0], axis=1) < 0.5
        return speed[near].min()

    assert slowest((8.0, 0.5)) > 1.3 > slowest((6.0, 2.0)) > slowest((4.0, 4.0)) > slowest((0.0, 0.5))


def test_the_length_of_the_steps_does_not_change_the_way():
    line = path((0.0, 0.0), (3.0, 0.0), (3.0, 3.0))
    coarse, fine = (settle(make_person(path=line), 4.0, dt=dt) for dt in (1 / 15, 1 / 240))
    assert math.dist(coarse.position, fine.position) < 0.05


def test_a_pausing_person_faces_the_point_the_robot_or_the_other():
    robot = PlanarState(position=np.array([2.0, -5.0]), velocity=np.zeros(2))
    other = Present({"bob": 0}, np.array([[-3.0, 0.0, 0.0, 0.0]]))
    for face, expected in (((2.0, 7.0), math.pi / 2), ("robot", -math.pi / 2), ("bob", math.pi)):
        person = make_person(path=(Waypoint(at_m=(0.0, 0.0)), Waypoint(at_m=(2.0, 0.0), face=face)))
        for k in range(400):
            person.step(k / 60, 1 / 60, other, robot, np.empty((0, 4)))
        assert math.cos(person.heading - expected) > 0.999, face


def test_postures_take_the_pause_and_end_before_walking_on():
    way = (
        Waypoint(at_m=(0.0, 0.0)),
        Waypoint(at_m=(1.0, 0.0), pause_s=3.0, posture=Posture.SITTING),
        Waypoint(at_m=(4.0, 0.0)),
    )
    person = make_person(path=way)
    postures, moving_while_sitting = set(), 0
    for _ in walk(person, 12.0):
        postures.add(person.posture)
        moving_while_sitting += person.posture is Posture.SITTING and np.hypot(*person.velocity) > 0
    assert postures == {Posture.STANDING, Posture.SITTING}
    assert moving_while_sitting == 0
    assert person.position[0] == pytest.approx(4.0)


def test_a_person_is_there_from_entering_to_leaving():
    person = make_person(path=path((0.0, 0.0), (9.0, 0.0)), enter_s=1.0, leave_s=3.0)
    present = {round(t, 3): person.present for t in walk(person, 4.0, dt=0.1)}
    assert not present[0.9]
    assert present[1.0]
    assert present[2.9]
    assert not present[3.0]
    assert make_person().present


def test_who_enters_later_faces_the_robot_at_once():
    robot = PlanarState(position=np.array([0.0, -5.0]), velocity=np.zeros(2))
    way = (Waypoint(at_m=(0.0, 0.0), pause_s=5.0, face="robot"), Waypoint(at_m=(5.0, 0.0)))
    person = make_person(path=way, enter_s=1.0)
    settle(person, 1.0, robot=robot)
    assert person.present
    assert person.heading == pytest.approx(-math.pi / 2)


def test_a_script_waits_for_a_robot_that_stands_in_the_way():
    robot = PlanarState(position=np.array([3.0, 0.1]), velocity=np.zeros(2))
    person = make_person(path=path((0.0, 0.0), (6.0, 0.0)))
    settle(person, 8.0, robot=robot)
    gap = math.dist(person.position, robot.position) - person.model.radius_m - robot.radius_m
    assert 0.1 < gap < 0.5
    assert np.hypot(*person.velocity) == 0.0
    settle(person, 8.0, start=8.0)
    assert person.position[0] == pytest.approx(6.0)


def test_a_script_walks_on_beside_or_before_a_robot():
    robot = PlanarState(position=np.array([3.0, 1.0]), velocity=np.zeros(2))
    person = settle(make_person(path=path((0.0, 0.0), (6.0, 0.0))), 8.0, robot=robot)
    assert person.position[0] == pytest.approx(6.0)


@settings(deadline=None, max_examples=40)
@given(
    st.lists(st.tuples(st.floats(-10, 10), st.floats(-10, 10)), min_size=2, max_size=5),
    st.floats(-1.5, 1.5),
)
def test_paths_of_a_group_are_parallel(points, offset):
    lines = np.diff(np.array(points), axis=0)
    lengths = np.linalg.norm(lines, axis=1)
    if lengths.min() < 0.5:
        return
    along = lines / lengths[:, None]
    if any(a @ b < -0.9 for a, b in pairwise(along)):
        return
    shifted = np.array(abreast(points, offset))
    left = np.stack([-along[:, 1], along[:, 0]], axis=-1)
    for k, normal in enumerate(left):
        for end in (k, k + 1):
            assert (shifted[end] - points[k]) @ normal == pytest.approx(offset, abs=1e-6)


def test_a_route_is_continuous_in_place_and_direction():
    def end_of(piece):
        walk = SimpleNamespace(along=piece.length_m, position=np.zeros(2))
        curve = SimpleNamespace(start=piece.start, heading=piece.heading_rad, curvature=piece.curvature)
        return walk.position, _put.py_func(walk, curve)

    pieces = route([(0.0, 0.0), (3.0, 0.0), (4.0, 2.0), (4.0, 2.3), (0.0, 5.0)], 1)
    for before, after in pairwise(pieces):
        place, heading = end_of(before)
        np.testing.assert_allclose(place, after.start, atol=1e-9)
        assert math.cos(heading - after.heading_rad) == pytest.approx(1.0)
    np.testing.assert_allclose(end_of(pieces[-1])[0], (0.0, 5.0), atol=1e-9)
    assert [piece.goal for piece in pieces] == sorted(piece.goal for piece in pieces)


def yielding(name, *points):
    return make_person(name=name, path=path(*points), yields=True)


def closest(track):
    gaps = [
        np.linalg.norm(track[:, a] - track[:, b], axis=1).min()
        for a in range(track.shape[1])
        for b in range(a)
    ]
    return min(gaps)


def test_people_who_meet_head_on_pass_each_other_on_the_right():
    track = walk_together(
        [yielding("a", (0.0, 0.0), (10.0, 0.0)), yielding("b", (10.0, 0.0), (0.0, 0.0))], 13.0
    )
    assert closest(track) > 0.5
    np.testing.assert_allclose(track[-1], [[10.0, 0.0], [0.0, 0.0]], atol=0.06)
    assert track[:, 0, 1].min() < -0.2
    assert track[:, 1, 1].max() > 0.2


def test_people_pass_each_other_in_a_corridor_without_leaving_it():
    walls = np.array([[-2.0, 0.8, 12.0, 1.0], [-2.0, -1.0, 12.0, -0.8]])
    people = [yielding("a", (0.0, 0.0), (10.0, 0.0)), yielding("b", (10.0, 0.0), (0.0, 0.0))]
    track = walk_together(people, 16.0, walls=walls)
    assert closest(track) > 0.4
    assert np.abs(track[..., 1]).max() < 0.65
    np.testing.assert_allclose(track[-1], [[10.0, 0.0], [0.0, 0.0]], atol=0.06)


@pytest.mark.parametrize("aside", [0.0, 0.15, -0.3])
def test_who_yields_walks_around_a_robot(aside):
    robot = PlanarState(position=np.array([5.0, aside]), velocity=np.zeros(2))
    track = walk_together([yielding("a", (0.0, 0.0), (10.0, 0.0))], 13.0, robot=robot)
    assert np.linalg.norm(track[:, 0] - robot.position, axis=1).min() > 0.5
    np.testing.assert_allclose(track[-1, 0], [10.0, 0.0], atol=0.06)


def test_who_yields_settles_beside_a_taken_place():
    people = [yielding("a", (0.0, 0.0), (6.0, 0.0)), make_person(name="b", path=path((6.0, 0.0)))]
    track = walk_together(people, 15.0)
    assert closest(track) > 0.4
    assert np.ptp(track[-15:, 0], axis=0).max() < 0.02


def test_four_people_cross_without_touching():
    people = [
        yielding("a", (0.0, 0.0), (10.0, 0.0)), yielding("b", (10.0, 0.0), (0.0, 0.0)),
        yielding("c", (5.0, 5.0), (5.0, -5.0)), yielding("d", (5.0, -5.0), (5.0, 5.0)),
    ]  # fmt: skip
    track = walk_together(people, 14.0)
    assert closest(track) > 0.5
    for person in people:
        assert math.dist(person.position, person.config.path[-1].at_m) < 0.06


def test_who_yields_brakes_as_gently_as_others():
    for yields in (True, False):
        way = (*path((0.0, 0.0)), Waypoint(at_m=(4.0, 0.0), pause_s=1.0), *path((4.0, 3.0)))
        person = make_person(path=way, yields=yields)
        speeds = np.array([np.hypot(*person.velocity) for _ in walk(person, 12.0, dt=1 / 15)])
        assert np.diff(speeds).min() > -0.3
        np.testing.assert_allclose(person.position, (4.0, 3.0), atol=0.03)


@pytest.mark.parametrize("gap", [0.3, 0.5, 1.0])
def test_who_yields_stops_before_a_wall_that_is_too_near_and_goes_on(gap):
    way = (*path((0.0, 0.0)), Waypoint(at_m=(4.0, 0.0), pause_s=1.0), *path((0.0, 0.0)))
    person = make_person(path=way, yields=True)
    wall = np.array([[4.0 + gap, -3.0, 4.2 + gap, 3.0]])
    farthest = max(person.position[0] for _ in walk(person, 12.0, walls=wall))
    assert farthest > 3.5
    np.testing.assert_allclose(person.position, (0.0, 0.0), atol=0.03)


@pytest.mark.parametrize("dt_s", [1 / 60, 1 / 15])
def test_an_errand_that_ends_beside_the_waypoint_goes_on_from_there_without_a_jump(dt_s):
    walker = Walker((Waypoint(at_m=(0.0, 0.0), pause_s=6.0), Waypoint(at_m=(4.0, 0.0))), False, 0.2)
    errands = {0: Wish(goes_to=np.array([1.0, 0.3])), 2: Wish(goes_to=np.zeros(2)), 5: Wish()}
    track = [walker.position]
    for k in range(round(18.0 / dt_s)):
        due = max(start for start in errands if start <= k * dt_s)
        walker.step(dt_s, ALONE, errands[due])
        track.append(walker.position)
        if not walker.is_walking and k * dt_s > 5.0 and walker.reached == 0:
            assert 0.0 < math.dist(walker.position, (0.0, 0.0)) < 0.12
    assert np.linalg.norm(np.diff(track, n=2, axis=0), axis=1).max() < 6.0 * dt_s**2
    assert walker.position.tolist() == [4.0, 0.0]
