from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.sim.places.moving import Mover
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.calls.refused import assert_names
from tests.helpers.some_of import some_of

Data = dict[str, Any]

BOX: Data = {
    "kind": "block",
    "name": "box",
    "at_m": [4.0, 0.0],
    "size_m": [0.3, 0.3, 0.3],
    "actions": [{"at_s": 2.0, "kind": "glide", "to_m": [4.0, 0.5], "takes_s": 1.0, "by": "anna"}],
}
GOOD: Data = {
    "name": "try_out",
    "description": "A room in which a box is moved.",
    "duration_s": 9.0,
    "place": {"kind": "room", "length_m": 8.0, "width_m": 6.0},
    "things": [{"kind": "table", "name": "table", "at_m": [6.0, -1.5]}, BOX],
    "people": [{"name": "anna", "path": [{"at_m": [4.6, 0.2], "face": [4.0, 0.2]}]}],
    "robot": {"at_m": [1.0, 0.0]},
}


def parse(data: Data) -> Scenario:
    return parse_scenario(data, source="my.yaml", folder=Path("/nowhere"))


def with_action(**keys: Any) -> Data:
    """The good scenario with the box's action changed; None leaves a key out."""
    data = copy.deepcopy(GOOD)
    action = data["things"][1]["actions"][0]
    action.update(keys)
    data["things"][1]["actions"][0] = {key: value for key, value in action.items() if value is not None}
    return data


def with_box(**keys: Any) -> Data:
    data = copy.deepcopy(GOOD)
    data["things"][1] |= keys
    data["things"][1] = {key: value for key, value in data["things"][1].items() if value is not None}
    return data


def two(first: Data, second: Data) -> Data:
    return with_box(actions=[first, second])


GLIDE: Data = {"at_s": 2.0, "kind": "glide", "to_m": [4.0, 0.5], "takes_s": 1.0}
TURN: Data = {"kind": "turn", "to_m": None, "facing_deg": 90, "hinge_m": [4.0, 0.2]}

MISTAKES: dict[str, tuple[Data, tuple[str, ...]]] = {
    "unknown kind": (with_action(kind="fly"), ("things[1].actions[0].kind", "'fly'", "glide")),
    "before the run": (with_action(at_s=-1.0), ("actions[0].at_s", "-1", "before the run starts")),
    "after the run": (with_action(at_s=9.0), ("actions[0].at_s", "9", "duration_s")),
    "no time": (with_action(takes_s=None), ("actions[0]", "takes_s", "glide")),
    "no time at all": (with_action(takes_s=0.0), ("actions[0].takes_s", "0", "more than 0")),
    "nowhere": (with_action(to_m=None), ("actions[0]", "to_m", "glide")),
    "outside": (with_action(to_m=[14.0, 0.5]), ("actions[0].to_m", "(14, 0.5)", "outside the floor")),
    "a hinge for nothing": (with_action(hinge_m=[4.0, 1.0]), ("actions[0].hinge_m", "glide")),
    "no hinge": (with_action(**(TURN | {"hinge_m": None})), ("actions[0]", "hinge_m", "turn")),
    "no name": (with_box(name=None), ("things[1]", "'name'")),
    "never there": (with_box(actions=None, hidden_at_start=True), ("things[1].hidden_at_start", "appear")),
    "there already": (with_action(kind="appear", takes_s=None), ("actions[0].kind", "box", "there already")),
    "not there": (with_box(hidden_at_start=True), ("actions[0].kind", "box", "not there")),
    "by nobody": (with_action(by="ana"), ("actions[0].by", "'ana'", "anna")),
    "two at once": (
        two(GLIDE, GLIDE | {"at_s": 2.5, "to_m": [4.0, 0.9]}),
        ("actions[1].at_s", "2.5", "3"),
    ),
    "in the wrong order": (two(GLIDE, GLIDE | {"at_s": 1.0}), ("actions[1].at_s", "1", "after 2")),
    "off its line": (with_action(kind="slide", to_m=[4.4, 0.3]), ("actions[0].to_m", "0.3 m", "slides")),
    "through the robot": (
        with_action(to_m=[0.5, 0.0], takes_s=3.0, by=None),
        ("actions[0]", "box", "robot"),
    ),
    "too fast": (with_action(takes_s=0.1), ("actions[0].takes_s", "0.1", "0.5 m", "2.5 m/s")),
    "two things in one hand": (
        GOOD
        | {
            "things": [
                *GOOD["things"],
                BOX
                | {
                    "name": "other",
                    "at_m": [4.0, -0.6],
                    "actions": [{"at_s": 2.5, "kind": "glide", "base_m": 0.5, "takes_s": 1.0, "by": "anna"}],
                },
            ],
            "people": [{"name": "anna", "path": [{"at_m": [4.5, -0.1]}]}],
        },
        ("things[2].actions[0].by", "anna", "'box'", "2 to 3 s"),
    ),
    "in the robot": (
        with_box(at_m=[1.2, 0.0], actions=[{"at_s": 2.0, "kind": "vanish"}]),
        ("things[1]", "box", "robot", "0.0 s", "(1, 0)"),
    ),
    "through a table": (
        with_action(to_m=[7.0, -1.5], takes_s=3.0, by=None),
        ("actions[0]", "box", "'table'"),
    ),
    "through a wall": (with_action(to_m=[4.0, 2.98], takes_s=3.0, by=None), ("actions[0]", "'wall_north'")),
    "through a person": (
        with_action(to_m=[5.2, 0.3], by=None),
        ("people[0].path", "anna", "'box'", "at 2."),
    ),
    "out of reach": (with_action(to_m=[4.0, 1.5]), ("actions[0].by", "anna", "box", "0.75 m")),
}


def test_the_scenario_that_the_other_tests_break_is_good() -> None:
    (box,) = parse(GOOD).place.movers
    assert box.at(9.0).stance.position_m == pytest.approx((4.0, 0.5, 0.0))
    assert box.actions[0].by == "anna"


@pytest.mark.parametrize("mistake", MISTAKES)
def test_what_cannot_happen_to_a_thing_is_refused_in_one_line_with_its_key(mistake: str) -> None:
    data, named = MISTAKES[mistake]
    with pytest.raises(BadInput) as caught:
        parse(data)
    assert_names(str(caught.value), "my.yaml: ", *named)


@pytest.mark.parametrize("habit", ["yields", "jitter_m", "speed_jitter", "enter_jitter_s"])
def test_who_moves_things_must_be_where_the_file_says(habit: str) -> None:
    data = copy.deepcopy(GOOD)
    data["people"][0][habit] = True if habit == "yields" else 0.1
    with pytest.raises(BadInput) as caught:
        parse(data)
    assert_names(str(caught.value), "things[1].actions[0].by", "anna", habit)


def test_people_walk_where_a_thing_was_or_will_be_and_not_where_it_is() -> None:
    data = with_action(by=None)
    walker = {"name": "ben", "path": [{"at_m": [5.0, 0.0]}, {"at_m": [3.0, 0.0], "speed_m_s": 1.2}]}
    data["people"] = [walker | {"enter_s": 4.0}]
    parse(data)
    data["people"] = [walker]
    with pytest.raises(BadInput) as caught:
        parse(data)
    assert_names(str(caught.value), "people[0].path", "'ben'", "'box'")


def test_a_seed_sends_nobody_through_what_is_moved() -> None:
    data = with_action(by=None, at_s=0.5)
    path = [{"at_m": [3.0, -1.2]}, {"at_m": [4.4, -0.9]}, {"at_m": [4.6, 1.5]}]
    data["people"] = [{"name": "ben", "jitter_m": 0.5, "path": path}]
    scenario = parse(data)
    for seed in range(20):
        (ben,) = scenario.people(seed)
        assert scenario.ground.fault(ben) is None


def _hands(name: str) -> list[tuple[Mover, float]]:
    """How far the acting hand is from what it moves, at every instant of a run."""
    scenario, gaps = load_scenario(name), []
    with SimulatedWorld(scenario.world(0)) as world:
        people = {person.name: person for person in world.crowd.people}
        for _ in range(round(scenario.duration_s * 15)):
            for mover in scenario.place.movers:
                for action in mover.actions:
                    if action.by is not None and action.at_s <= world.time_s <= action.ends_s:
                        person = people[action.by]
                        x, y = person.position.tolist()
                        grip = mover.grip(action, world.time_s, (x, y))
                        gap = min(float(abs(person.palm(side) - grip).max()) for side in ("left", "right"))
                        gaps.append((mover, gap))
            world.step(0.0, 0.0)
    return gaps


@pytest.mark.slow
@pytest.mark.parametrize("name", some_of(["bears_6", "doors_1", "cans_1", "doors_4", "chairs_2"], 2))
def test_hands_are_at_the_things_that_they_move(name: str) -> None:
    gaps = [gap for _, gap in _hands(name)]
    assert len(gaps) > 30
    assert max(gaps) < 0.1
    assert sum(gaps) / len(gaps) < 0.02
