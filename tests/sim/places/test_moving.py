from __future__ import annotations

import math

import numpy as np
import pytest

from peopleboy.sim.places.moving import Action, ActionKind, Mover, Stance, ease

HINGE = (2.0, 1.0)
START = Stance((2.0, 0.5, 0.0), math.pi)


def mover(*actions: Action, hidden: bool = False) -> Mover:
    return Mover(
        name="it",
        start=START,
        low_m=(-0.02, -0.5, 0.0),
        high_m=(0.02, 0.5, 2.0),
        is_hidden_at_start=hidden,
        actions=actions,
    )


def door(by: str | None = "anna") -> Mover:
    opened = START.turned_about(HINGE, math.radians(-90.0))
    turn = Action(kind=ActionKind.TURN, at_s=2.0, takes_s=4.0, target=opened, hinge_m=HINGE, by=by)
    return mover(turn)


def test_a_door_leaf_keeps_to_its_hinge_and_ends_a_quarter_turn_on() -> None:
    for time_s in np.linspace(0.0, 8.0, 33):
        stance = door().at(float(time_s)).stance
        assert math.dist(stance.position_m[:2], HINGE) == pytest.approx(0.5)
        share = ease(min(max((time_s - 2.0) / 4.0, 0.0), 1.0))
        assert stance.heading_rad == pytest.approx(math.pi - share * math.pi / 2.0)
    x, y, z = door().at(7.0).stance.position_m
    assert (x, y, z) == pytest.approx((1.5, 1.0, 0.0))  # from below the hinge to the left of it


def test_half_of_the_time_is_half_of_the_way_and_both_ends_are_gentle() -> None:
    target = Stance((4.0, 1.5, 1.0), math.pi)
    it = mover(Action(kind=ActionKind.GLIDE, at_s=1.0, takes_s=2.0, target=target))
    assert it.at(2.0).stance.position_m == pytest.approx((3.0, 1.0, 0.5))
    assert it.at(0.9).stance == START
    assert it.at(3.0).stance == target
    step = math.dist(it.at(1.01).stance.position_m, START.position_m)
    assert step == pytest.approx(
        3.0 * (0.01 / 2.0) ** 2 * math.dist(START.position_m, target.position_m), rel=0.01
    )


def test_a_drawer_stays_on_its_line_with_its_front_where_it_was() -> None:
    target = Stance((1.7, 0.5, 0.0), math.pi)
    it = mover(Action(kind=ActionKind.SLIDE, at_s=0.0, takes_s=1.0, target=target))
    for time_s in np.linspace(0.0, 1.0, 11):
        stance = it.at(float(time_s)).stance
        assert stance.position_m[1:] == (0.5, 0.0)
        assert stance.heading_rad == math.pi
        assert stance.position_m[0] == pytest.approx(2.0 - 0.3 * ease(float(time_s)))


def test_headings_go_the_shorter_way_round() -> None:
    target = Stance(START.position_m, math.radians(-170.0))
    it = mover(Action(kind=ActionKind.GLIDE, at_s=0.0, takes_s=1.0, target=target))
    assert it.at(0.5).stance.heading_rad == pytest.approx(math.radians(185.0))


def test_what_appears_and_vanishes_is_there_in_between_and_nobody_is_asked_before() -> None:
    come = Action(kind=ActionKind.APPEAR, at_s=1.0, target=START, by="anna")
    go = Action(kind=ActionKind.VANISH, at_s=3.0, target=START, by="ben")
    it = mover(come, go, hidden=True)
    found = [(it.at(t).is_there, it.at(t).by) for t in (0.0, 1.0, 2.9, 3.0, 9.0)]
    assert found == [(False, None), (True, "anna"), (True, "anna"), (False, "ben"), (False, "ben")]


def test_where_a_thing_is_depends_on_the_time_alone() -> None:
    it = door()
    later = [it.at(t) for t in (6.0, 3.0, 1.0)]
    assert later == [door().at(t) for t in (6.0, 3.0, 1.0)]
    assert [state.is_moving for state in later] == [False, True, False]
    assert [state.by for state in later] == ["anna", "anna", None]


def test_one_holds_a_door_by_its_far_edge_a_drawer_by_its_front_and_anything_else_where_it_is_near() -> None:
    leaf, turn = door(), door().actions[0]
    assert leaf.grip(turn, 2.0, (1.0, 0.0)) == pytest.approx((2.0, 0.03, 1.0), abs=0.001)
    box = Mover(name="b", start=Stance((0.0, 0.0, 0.0), 0.0), low_m=(-0.2, -0.2, 0.0), high_m=(0.3, 0.2, 0.4))
    slide = Action(kind=ActionKind.SLIDE, at_s=0.0, takes_s=1.0, target=box.start)
    glide = Action(kind=ActionKind.GLIDE, at_s=0.0, takes_s=1.0, target=box.start)
    about = Action(kind=ActionKind.TURN, at_s=0.0, takes_s=1.0, target=box.start, hinge_m=(-1.0, 0.0))
    assert box.grip(slide, 0.0, (1.0, 0.1)) == pytest.approx((0.3, 0.0, 0.2))
    assert box.grip(glide, 0.0, (1.0, 0.1)) == pytest.approx((0.3, 0.1, 0.4))
    assert box.grip(about, 0.0, (-1.0, 0.0)) == pytest.approx((-0.2, 0.0, 0.4))  # by whom it is carried
