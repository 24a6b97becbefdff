"""Room for a person who was lost by being too near, and the return of a lost person."""

import dataclasses

import numpy as np

from peopleboy.behaviours.behaviour import STOP
from peopleboy.behaviours.following.avoidance import ClearanceConfig, is_person_near, is_way_out
from peopleboy.behaviours.following.follow_person import FollowConfig, FollowState, follow
from tests.helpers.percepts.percepts import free, percept, person
from tests.helpers.percepts.toy_world import STEP_S

CONFIG, ROOM = FollowConfig(), ClearanceConfig()


def play(state, from_s, seconds, *people, **changes):
    command = STOP
    for k in range(round(seconds / STEP_S)):
        state, command = follow(state, percept(from_s + k * STEP_S, *people, **changes), CONFIG)
    return state, command


def test_a_person_who_comes_back_under_the_same_id_is_followed_at_once_also_beside_another():
    state, _ = play(FollowState(), 1.0, 1.0, person())
    state, _ = play(state, 2.0, 20.0, person(x=0.3, id=2))
    state, _ = play(state, 22.0, 0.2, person(x=-0.4), person(x=0.3, id=2))
    assert (state.mode, state.target.id) == ("follow", 1)


def test_who_came_too_near_to_be_seen_has_room_made_only_while_somebody_is_there():
    state, _ = play(FollowState(), 1.0, 1.0, person(height=1.2))
    near = dataclasses.replace(free(i3=0.6, i4=0.6), time_s=3.0)
    _, command = follow(state, near, CONFIG)
    assert command.linear_m_s < 0.0
    _, command = follow(state, dataclasses.replace(near, sonar_m=free().sonar_m), CONFIG)
    assert command.linear_m_s >= 0.0


def test_something_is_near_within_the_lane_ahead_and_farther_where_somebody_was_near():
    ahead, beside, behind = np.array([[1.8, 0.2]]), np.array([[1.0, 0.8]]), np.array([[-0.5, 0.0]])
    assert is_person_near(ahead, ROOM, was_near=True)
    assert not is_person_near(ahead, ROOM, was_near=False)
    assert not is_person_near(np.concatenate([beside, behind]), ROOM, was_near=True)


def test_a_way_leads_out_of_a_narrow_place_where_nothing_is_ahead():
    post, wall = [0.0, 0.6], [2.0, 0.0]
    assert is_way_out(np.array([post]), ROOM, 0.0)
    assert not is_way_out(np.array([post, wall]), ROOM, 0.0)
    assert not is_way_out(np.array([[0.0, 3.0]]), ROOM, 0.0)
    aside = np.array([[0.0, 1.3]])
    assert is_way_out(aside, ROOM, 0.0)
    assert not is_way_out(aside, ROOM, ROOM.farthest_m)
