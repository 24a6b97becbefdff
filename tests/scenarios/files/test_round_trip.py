from __future__ import annotations

import itertools
import math
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.scenarios.files.load import parse_scenario
from peopleboy.scenarios.files.read_yaml import read_yaml
from peopleboy.sim.people.body.clothes import BOTTOMS, TOPS
from peopleboy.sim.shapes.materials import COLOURS

NOWHERE = Path("/nowhere")


def reals(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda value: round(value, 3))


# The room spans x 0..9 and y -4..4; the robot stands at (0.8, 0).
points = st.tuples(reals(2.0, 8.5), reals(-3.5, 3.5)).map(list)
waypoints = st.fixed_dictionaries(
    {"at_m": points},
    optional={
        "speed_m_s": reals(0.1, 2.5),
        "pause_s": reals(0.0, 5.0),
        "face": st.one_of(st.just("robot"), points),
        "posture": st.sampled_from(["standing", "sitting", "bending", "arms_raised", "arms_crossed"]),
    },
)


def is_path(path: list[Any]) -> bool:
    return all(math.dist(a["at_m"], b["at_m"]) > 0.1 for a, b in itertools.pairwise(path))


paths = st.lists(waypoints, min_size=1, max_size=5).filter(is_path)
colours = st.one_of(st.sampled_from(sorted(COLOURS)), st.lists(reals(0.0, 1.0), min_size=3, max_size=3))
people = st.fixed_dictionaries(
    {"path": paths},
    optional={
        "height_m": reals(1.5, 2.0),
        "sex": st.sampled_from(["female", "male"]),
        "build": st.sampled_from(["slim", "average", "stout"]),
        "clothes": st.fixed_dictionaries(
            {},
            optional={
                "top": st.sampled_from(sorted(TOPS)),
                "bottom": st.sampled_from(sorted(BOTTOMS)),
                "top_colour": colours,
            },
        ),
        "enter_s": reals(0.0, 9.0),
        "leave_s": reals(9.5, 99.0),
        "bag": st.booleans(),
        "yields": st.booleans(),
        "jitter_m": reals(0.0, 1.0),
        "speed_jitter": reals(0.0, 0.5),
        "enter_jitter_s": reals(0.0, 3.0),
    },
)
lights = st.lists(reals(0.0, 30.0), unique=True, max_size=3).map(
    lambda times: [{"at_s": time, "level": 0.5} for time in sorted(times)]
)
things = st.lists(
    st.fixed_dictionaries(
        {
            "kind": st.sampled_from(["radiator", "window", "poster"]),
            "wall": st.sampled_from(["north", "south"]),
            "along_m": reals(1.0, 8.0),
        },
        optional={"temperature_c": reals(10.0, 60.0), "emissivity": reals(0.1, 1.0), "colour": colours},
    ),
    max_size=3,
)


def start_apart(crowd: list[dict[str, Any]]) -> bool:
    starts = [person["path"][0]["at_m"] for person in crowd]
    return all(math.dist(a, b) > 0.05 for a, b in combinations(starts, 2))


@st.composite
def scenarios(draw: st.DrawFn) -> dict[str, Any]:
    crowd = draw(st.lists(people, max_size=3).filter(start_apart))
    return {
        "name": "random",
        "description": draw(st.text("abc :#'\"%é\n-", min_size=1, max_size=30)),
        "duration_s": draw(reals(13.0, 50.0)),
        "place": {"kind": "room", "length_m": 9.0, "width_m": 8.0, "height_m": draw(reals(2.5, 4.0))},
        "things": draw(things),
        "people": [{"name": f"person_{index}", **person} for index, person in enumerate(crowd)],
        "lights": draw(lights),
        "robot": {"at_m": [0.8, 0.0], "heading_deg": draw(reals(-180.0, 180.0))},
    }


@pytest.mark.slow
@given(data=scenarios(), seed=st.integers(0, 2**40))
@settings(max_examples=60, deadline=None)
def test_any_scenario_survives_being_resolved_written_and_read(
    data: dict[str, Any], seed: int, tmp_path_factory: Any
) -> None:
    scenario = parse_scenario(data, source="random.yaml", folder=NOWHERE)
    path = tmp_path_factory.mktemp("run") / "scenario.yaml"
    path.write_text(yaml.safe_dump(scenario.resolved(seed), allow_unicode=True), encoding="utf-8")
    again = parse_scenario(read_yaml(path), source=str(path), folder=NOWHERE)
    assert again.resolved(seed) == scenario.resolved(seed)
    assert again.world(seed).people == scenario.world(seed).people
    assert again.world(seed).robot == scenario.world(seed).robot
    assert again.place.fixtures == scenario.place.fixtures
    assert again.place.light == scenario.place.light


@given(data=scenarios(), seed=st.integers(0, 2**40))
@settings(max_examples=40, deadline=None)
def test_the_seed_moves_people_no_farther_than_the_file_allows(data: dict[str, Any], seed: int) -> None:
    scenario = parse_scenario(data, source="random.yaml", folder=NOWHERE)
    for given_person, person in zip(scenario.spec.people, scenario.people(seed), strict=True):
        assert scenario.ground.fault(person) is None
        for a, b in zip(given_person.path, person.path, strict=True):
            assert math.dist(a.at_m, b.at_m) <= given_person.jitter_m + 2e-4
            assert 0.1 <= b.speed_m_s <= 2.5
        assert 0.0 <= person.enter_s - given_person.enter_s <= given_person.enter_jitter_s + 1e-4
