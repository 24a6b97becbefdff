import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.behaviours.behaviour import EMERGENCY_STOP, STOP
from peopleboy.behaviours.following.follow_person import FollowConfig, FollowPerson, FollowState, follow
from peopleboy.behaviours.make_behaviour import make_behaviour
from peopleboy.behaviours.safety_limits import SafetyConfig
from peopleboy.scenarios.scores.following_metrics import score_following
from tests.helpers.drives import made_drive
from tests.helpers.percepts.percepts import percept, person
from tests.helpers.percepts.toy_world import STEP_S, Toy, drive, room, straight, wall

CONFIG = FollowConfig()


def follow_frames(*frames_of_people):
    """Feed one group of people per frame; give the last state and command."""
    state, command = FollowState(), STOP
    for frame, people in enumerate(frames_of_people):
        turned = command.angular_rad_s
        state, command = follow(state, percept(frame * STEP_S, *people, angular_rad_s=turned), CONFIG)
    return state, command


def test_a_person_in_the_right_half_turns_the_robot_right_and_in_the_left_half_left():
    assert follow_frames([person(x=0.4)])[1].angular_rad_s < 0.0
    assert follow_frames([person(x=-0.4)])[1].angular_rad_s > 0.0


def test_a_small_person_is_approached_a_tall_one_not_and_a_very_tall_one_left_slowly():
    keep, near = CONFIG.keep_height, CONFIG.near_height
    heights = (0.5 * keep, 0.9 * keep, 1.05 * keep, 0.99 * near, 1.1 * near, 2.0 * near)
    speeds = [follow_frames([person(height=h)])[1].linear_m_s for h in heights]
    assert speeds == sorted(speeds, reverse=True)
    assert speeds[0] == CONFIG.max_linear_m_s
    assert speeds[2] == speeds[3] == 0.0
    assert 0.0 > speeds[4] > speeds[5] == -CONFIG.back_off_m_s


def test_the_farther_off_the_middle_the_slower_and_at_the_border_hardly():
    speeds = [follow_frames([person(x=x)])[1].linear_m_s for x in (0.0, 0.4, 0.7, 1.0)]
    assert speeds == sorted(speeds, reverse=True)
    assert speeds[-1] < 0.2 * speeds[0]


def test_with_nobody_in_sight_the_robot_turns_in_place():
    state, command = follow_frames([])
    assert state.mode == "search"
    assert (command.linear_m_s, command.angular_rad_s) == (0.0, CONFIG.search_rad_s)


@pytest.mark.parametrize("name", ["x", "height", "top", "bottom", "confidence"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_person_with_a_senseless_number_is_not_followed(name, value):
    assert follow_frames([person(**{name: value})])[1].linear_m_s == 0.0


@pytest.mark.parametrize("name", ["time_s", "linear_m_s", "angular_rad_s"])
def test_a_percept_with_a_senseless_number_stops_the_robot_and_is_forgotten(name):
    state, _ = follow_frames([person()])
    after, command = follow(state, dataclasses.replace(percept(1.0, person()), **{name: math.nan}), CONFIG)
    assert command == STOP
    assert after == dataclasses.replace(state, mode="blind", reason="invalid or old input")


def test_an_image_seen_before_stops_the_robot():
    state, _ = follow_frames([person()], [person()])
    after, command = follow(state, percept(STEP_S, person()), CONFIG)
    assert command == STOP
    assert after.mode == "blind"


def test_a_track_that_is_not_visible_stops_the_robot_when_it_is_too_old():
    hidden = [person(is_visible=False)]
    frames = math.ceil(CONFIG.max_age_s / STEP_S)
    state, command = follow_frames([person()], *[hidden] * (frames + 1))
    assert state.mode == "wait"
    assert command.linear_m_s == 0.0


@pytest.mark.parametrize(("x", "side"), [(0.9, -1.0), (-0.9, 1.0)])
def test_a_person_who_left_is_waited_for_and_then_searched_on_that_side(x, side):
    path = [[person(x=x * share)] for share in np.linspace(0.6, 1.0, 8)]
    state, command = follow_frames(*path, *[[]] * 9)
    assert state.mode == "wait"
    assert command.linear_m_s == 0.0
    assert side * command.angular_rad_s > 0.0
    state, command = follow_frames(*path, *[[]] * 30)
    assert state.mode == "search"
    assert command.angular_rad_s == side * CONFIG.search_rad_s


def test_a_search_that_an_obstacle_stops_goes_on_the_other_way_round():
    state, turns = FollowState(), []
    for frame in range(40):
        state, command = follow(state, percept(frame * STEP_S), CONFIG)
        turns.append(command.angular_rad_s)
    assert turns[0] > 0.0
    assert min(turns) < 0.0
    state = FollowState()
    for frame in range(40):
        state, command = follow(state, percept(frame * STEP_S, angular_rad_s=CONFIG.search_rad_s), CONFIG)
        assert command.angular_rad_s > 0.0


def test_after_a_long_gap_between_images_the_robot_starts_afresh():
    state, _ = follow_frames([person(x=0.5)])
    state, _ = follow(state, percept(100.0, person(x=-0.5, id=7)), CONFIG)
    assert state.target.id == 7
    assert state.target.drift_rad_s == 0.0


def test_after_a_stop_without_images_the_robot_follows_the_same_person_also_beside_a_taller_one():
    state, _ = follow_frames([person(x=0.5)], [person(x=0.4)])
    state, _ = follow(state, percept(3.0, person(x=-0.5), person(id=2, height=0.9)), CONFIG)
    assert state.target.id == 1
    assert state.target.bearing_rad > 0.1
    assert state.target.drift_rad_s == 0.0


def test_another_person_who_comes_nearer_does_not_draw_the_robot_away():
    state, _ = follow_frames([person()], [person(), person(id=2, height=0.8)])
    assert state.target.id == 1


def test_a_person_of_low_confidence_is_not_followed():
    assert follow_frames([person(confidence=0.9 * CONFIG.min_confidence)])[0].target is None


def test_nobody_else_is_followed_while_the_person_is_hidden_or_has_no_track():
    hidden = (person(is_visible=False), person(id=2))
    for people in (hidden, hidden[1:]):
        state, _ = follow_frames([person()], *[people] * 30)
        assert state.target.id == 1
        assert state.mode == "wait"


def test_the_tallest_person_is_followed_once_the_track_was_away_for_the_time_to_give_up():
    others = [person(id=2, height=0.3), person(id=3, height=0.5)]
    away = math.ceil(CONFIG.give_up_s / STEP_S)
    state, _ = follow_frames([person()], *[others] * (away - 1))
    assert state.target.id == 1
    state, _ = follow_frames([person()], *[others] * (away + 1))
    assert (state.target.id, state.mode) == (3, "follow")


def test_after_a_stop_without_images_the_person_is_searched_not_sought_where_it_was():
    state, _ = follow_frames([person()])
    state, command = follow(state, percept(2.0 * CONFIG.patience_s, person(id=2)), CONFIG)
    assert state.target.id == 1
    assert state.mode == "search"
    assert command.linear_m_s == 0.0


def test_a_person_who_went_out_of_sight_ahead_is_gone_after_and_looked_for_from_there():
    corner = [((-2, 0.8), (2.8, 0.8)), ((2.8, 0.8), (2.8, 9)), ((4.8, -1), (4.8, 9)), ((-2, -1), (4.8, -1))]
    walls = np.concatenate([wall(a, b) for a, b in corner])
    toy = Toy(path=straight((3.6, -0.2), (0.0, 0.6), begin_s=3.0, end_s=13.0), walls=walls)
    log = drive(toy, make_behaviour("follow_person"), 25.0)
    modes = [mode for mode, before in zip(log.mode, ["", *log.mode], strict=False) if mode != before]
    assert "recover" in modes
    assert modes[-1] == "follow"
    assert not log.is_contact.any()


@pytest.mark.parametrize(("changes", "why"), [({"image_age_s": 0.2}, "image"), ({"fault": "dead"}, "dead")])
def test_the_guard_stops_at_once_without_images_or_tracker_and_goes_on_afterwards(changes, why):
    guarded = make_behaviour("follow_person")
    assert guarded.command(percept(0.0, person(height=0.3))).linear_m_s > 0.0
    assert guarded.command(percept(STEP_S, person(height=0.3), **changes)) == EMERGENCY_STOP
    assert guarded.mode == "stop"
    assert why in guarded.reason
    for frame in (2, 3):
        assert guarded.command(percept(frame * STEP_S, person(height=0.3))) == EMERGENCY_STOP
        assert "in a row" in guarded.reason
    assert guarded.command(percept(4 * STEP_S, person(height=0.3))).linear_m_s > 0.0
    assert guarded.mode == "follow"


def test_the_guard_does_not_go_on_while_a_camera_loses_every_third_image():
    guarded = make_behaviour("follow_person")
    ages_s = [0.0, *(STEP_S if frame % 3 == 0 else 0.0 for frame in range(30)), 0.0, 0.0, 0.0]
    modes = []
    for frame, age_s in enumerate(ages_s):
        guarded.command(percept(frame * STEP_S, person(height=0.3), image_age_s=age_s))
        modes.append(guarded.mode)
    assert modes == ["follow", *(["stop"] * 30), "follow", "follow", "follow"]


seen_people = st.builds(
    person,
    x=st.floats(-2.0, 2.0) | st.just(math.nan),
    height=st.floats(-1.0, 50.0) | st.just(math.inf),
    id=st.integers(1, 3),
    confidence=st.floats(0.0, 1.0),
    is_visible=st.booleans(),
)
wild_percepts = st.builds(
    percept,
    st.floats(0.0, 3.0),
    seen_people,
    seen_people,
    sonar_m=st.lists(st.floats(-1.0, 9.0) | st.just(math.nan), min_size=16, max_size=16).map(np.array),
    linear_m_s=st.floats(-1.0, 1.0),
    angular_rad_s=st.floats(-3.0, 3.0),
)


@given(st.lists(wild_percepts, max_size=6))
def test_whatever_is_seen_commands_are_finite_and_within_the_limits(percepts):
    guarded = make_behaviour("follow_person")
    limits = SafetyConfig()
    for each in percepts:
        command = guarded.command(each)
        assert abs(command.linear_m_s) <= limits.max_linear_m_s
        assert abs(command.angular_rad_s) <= limits.max_angular_rad_s


@pytest.mark.slow
@settings(max_examples=3, deadline=None)
@given(
    distance=st.floats(1.0, 8.0),
    angle=st.floats(-math.pi, math.pi),
    tall_m=st.floats(1.5, 2.0),
    seed=st.integers(0, 99),
)
def test_a_standing_person_is_found_anywhere_faced_and_kept_at_the_same_height(distance, angle, tall_m, seed):
    place = (distance * math.cos(angle), distance * math.sin(angle))
    toy = Toy(path=lambda _: place, tall_m=tall_m, rng=np.random.default_rng(seed))
    log = drive(toy, make_behaviour("follow_person"), 35.0)
    depth_at = [
        0.14 + tall_m / (h * 2.0 * math.tan(math.radians(22.0)))
        for h in (CONFIG.near_height * 1.1, CONFIG.keep_height * 0.9)
    ]
    assert np.max(np.abs(log.bearing[-30:])) < math.radians(3.0)
    assert depth_at[0] < log.distance[-1] < depth_at[1]
    assert not log.is_contact.any()


@pytest.mark.slow
@settings(max_examples=3, deadline=None)
@given(
    speed=st.floats(0.2, 0.7),
    course=st.floats(-1.2, 1.2),
    start=st.floats(3.0, 5.0),
    seed=st.integers(0, 99),
)
def test_a_person_who_walks_away_is_kept_in_view_and_in_the_band(speed, course, start, seed):
    velocity = (speed * math.cos(course), speed * math.sin(course))
    toy = Toy(path=straight((start, 0.0), velocity, 3.0, 18.0), rng=np.random.default_rng(seed))
    log = drive(toy, make_behaviour("follow_person"), 25.0)
    assert log.is_tracked.all()
    assert np.all(log.distance < 5.5)
    assert np.max(np.abs(log.bearing[60:])) < math.radians(15.0)
    assert np.max(np.abs(log.bearing[-30:])) < math.radians(3.0)
    assert 2.0 < log.distance[-1] < 4.6


@pytest.mark.slow
@settings(max_examples=3, deadline=None)
@given(speed=st.floats(0.2, 0.8), radius=st.floats(4.0, 8.0), sign=st.sampled_from([-1.0, 1.0]))
def test_a_person_who_walks_in_circles_is_followed(speed, radius, sign):
    def path(time_s):
        angle = speed / radius * time_s
        return 3.0 + radius * math.sin(angle), sign * radius * (1.0 - math.cos(angle))

    toy = Toy(path=path, rng=np.random.default_rng(0))
    log = drive(toy, make_behaviour("follow_person"), 30.0)
    track = log.is_tracked.astype(np.int64)
    score = score_following(
        made_drive(log.time_s, log.robot, target=log.person, track=track, is_contact=log.is_contact)
    )
    assert score.followed == 1.0
    assert score.facing > 0.95
    assert score.collisions == 0


@settings(max_examples=5, deadline=None)
@given(speed=st.floats(0.3, 1.2), seed=st.integers(0, 99))
def test_a_person_who_walks_up_to_the_robot_meets_one_that_never_drives_on(speed, seed):
    toy = Toy(path=straight((7.0, 0.0), (-speed, 0.0), 3.0), rng=np.random.default_rng(seed))
    behaviour = make_behaviour("follow_person")
    while toy.distance() > 1.0 and toy.time_s < 30.0:
        command = toy.step(behaviour)
        if toy.distance() < 2.2:
            assert command.linear_m_s <= 0.0
    assert toy.speed <= 0.0


@pytest.mark.slow
@settings(max_examples=2, deadline=None)
@given(
    opening=st.floats(0.9, 1.6),
    aside=st.floats(-1.0, 1.0),
    speed=st.floats(0.3, 0.7),
    seed=st.integers(0, 99),
)
def test_through_a_door_the_person_is_followed_without_touching_the_posts(opening, aside, speed, seed):
    velocity = (speed, aside * speed / 6.0)
    walls = room((-opening / 2.0, opening / 2.0))
    toy = Toy(
        path=straight((3.0, 0.0), velocity, 2.0, 2.0 + 6.0 / speed),
        walls=walls,
        rng=np.random.default_rng(seed),
    )
    log = drive(toy, make_behaviour("follow_person"), 12.0 + 6.0 / speed)
    assert not log.is_contact.any()
    assert log.robot[-1, 0] > 4.5
    assert 2.0 < log.distance[-1] < 4.6


@pytest.mark.thorough
@settings(max_examples=6, deadline=None)
@given(
    start=st.tuples(st.floats(1.0, 4.0), st.floats(-2.0, 2.0)),
    speed=st.floats(0.2, 1.0),
    course=st.floats(-math.pi, math.pi),
    seed=st.integers(0, 99),
)
def test_the_robot_touches_no_wall_wherever_the_person_goes(start, speed, course, seed):
    """The person walks through walls, which the robot must not."""
    velocity = (speed * math.cos(course), speed * math.sin(course))
    toy = Toy(
        path=straight(start, velocity, 2.0, 12.0), walls=room((0.0, 1.5)), rng=np.random.default_rng(seed)
    )
    behaviour = make_behaviour("follow_person")
    for _ in range(300):
        toy.step(behaviour)
        assert toy.wall_gap() > 0.0


def test_behind_a_steady_walker_the_lag_is_learnt_away():
    toy = Toy(path=straight((4.0, 0.0), (0.6, 0.0)))
    log = drive(toy, make_behaviour("follow_person"), 30.0)
    apparent = toy.people()[0].height
    assert apparent == pytest.approx(CONFIG.keep_height, rel=0.05)
    assert log.commands[-1].linear_m_s == pytest.approx(0.6, abs=0.03)


def test_drop_outs_of_the_track_are_bridged_and_longer_ones_searched_for():
    toy = Toy(path=straight((4.0, 0.0), (0.5, 0.0)), hidden=lambda t: 5.0 < t < 5.2 or 10.0 < t < 14.0)
    log = drive(toy, make_behaviour("follow_person"), 28.0)
    mode = np.array(log.mode)
    assert np.all(mode[(log.time_s < 10.0)] == "follow")
    assert set(mode[(log.time_s > 10.4) & (log.time_s < 13.9)]) <= {"wait", "recover", "search"}
    assert mode[-1] == "follow"


def test_two_followers_share_nothing():
    one, other = FollowPerson(), FollowPerson()
    one.command(percept(0.0, person()))
    assert one.mode == "follow"
    assert other.mode == "search"
