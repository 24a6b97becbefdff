from __future__ import annotations

import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import yaml

from peopleboy.behaviours.following.follow_person import FollowConfig
from peopleboy.scenarios.drawing.draw_plan import draw_plan
from peopleboy.scenarios.files.library import LIBRARY, library
from peopleboy.scenarios.files.load import load_scenario, parse_scenario
from peopleboy.scenarios.files.robot import RobotSpec
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.files.scenario_file import json_schema, to_data
from peopleboy.settings import settings_of
from peopleboy.sim.people.walking.walker import timetable
from peopleboy.sim.world_config import WorldConfig
from tests.helpers.calls.refused import refused
from tests.helpers.some_of import some_of

NAMES = sorted(path.stem for path in LIBRARY.glob("*.yaml"))
every_scenario = pytest.mark.parametrize("name", NAMES)
some_scenarios = pytest.mark.parametrize("name", some_of(NAMES, 4))


@cache
def loaded(name: str) -> Scenario:
    """A scenario of the library; loading takes longer than most of what is asked of it."""
    return load_scenario(name)


def same(a: WorldConfig, b: WorldConfig) -> bool:
    """Whether two worlds have equal settings; places compare by what stands in them."""
    return (
        (a.people, a.robot, a.seed, a.renderer) == (b.people, b.robot, b.seed, b.renderer)
        and a.place.fixtures == b.place.fixtures
        and a.place.light == b.place.light
        and a.place.surroundings_c == b.place.surroundings_c
        and np.array_equal(a.place.obstacles, b.place.obstacles)
    )


def test_the_library_holds_the_eight_scenarios_with_descriptions() -> None:
    assert set(library()) >= {
        "single_stationary",
        "single_follow",
        "corridor_meeting",
        "pass_behind",
        "crossing_pair",
        "empty_room",
        "fast_turn",
        "dark_room",
    }
    assert all(entry.description and "\n" not in entry.description for entry in library().values())


@every_scenario
def test_a_file_is_called_as_its_scenario(name: str) -> None:
    assert loaded(name).name == name


@pytest.mark.slow
@some_scenarios
def test_a_scenario_repeats_with_its_seed_and_varies_with_another(name: str) -> None:
    world = loaded(name).world(3)
    assert same(world, load_scenario(LIBRARY / f"{name}.yaml").world(3))
    assert world.seed == 3
    others = [loaded(name).world(seed) for seed in (4, 5)]
    assert not any(same(world, other) for other in others)
    if world.people:
        assert len({repr(config.people) for config in (world, *others)}) == 3


@pytest.mark.slow
@some_scenarios
def test_a_resolved_scenario_gives_the_same_world_from_its_file(name: str, tmp_path: Path) -> None:
    scenario = loaded(name)
    path = tmp_path / "scenario.yaml"
    path.write_text(yaml.safe_dump(scenario.resolved(7, {"peopleboy": "0.1.0"}), sort_keys=False))
    again = load_scenario(path)
    assert same(again.world(7), scenario.world(7))
    assert again.resolved(7, {"peopleboy": "0.1.0"}) == scenario.resolved(7, {"peopleboy": "0.1.0"})
    assert again.world(8).people == scenario.world(7).people  # nothing is left to draw


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.thorough)])
@every_scenario
def test_people_get_to_the_end_of_their_paths_in_time(name: str, seed: int) -> None:
    scenario = loaded(name)
    for person in scenario.people(seed):
        assert timetable(person)[-1].time_s < scenario.duration_s + 3.0


@pytest.mark.parametrize("seeds", [range(1), pytest.param(range(1, 10), marks=pytest.mark.thorough)], ids=str)
@every_scenario
def test_every_seed_keeps_people_clear_of_walls_and_things(name: str, seeds: range) -> None:
    scenario = loaded(name)
    for seed in seeds:
        for person in scenario.people(seed):
            assert scenario.ground.fault(person) is None


@pytest.mark.slow
@pytest.mark.parametrize("name", some_of(NAMES[::8], 7))
def test_a_plan_is_drawn(name: str, tmp_path: Path) -> None:
    draw_plan(loaded(name), 0, tmp_path / "plan.png")
    assert (tmp_path / "plan.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.thorough
def test_worlds_are_the_same_in_a_fresh_process() -> None:
    load = "from peopleboy.scenarios.files.load import load_scenario"
    code = f"{load}; print(load_scenario('dark_room').world(5).people)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.strip() == str(load_scenario("dark_room").world(5).people)


def test_another_person_in_the_file_changes_nobody_else() -> None:
    alone = load_scenario("dark_room")
    data = to_data(alone.spec)
    data["people"].insert(0, {"name": "zoe", "path": [{"at_m": [7.0, -3.0]}]})
    more = parse_scenario(data, source="x.yaml", folder=LIBRARY)
    assert more.world(1).people[1:] == alone.world(1).people


def test_what_a_file_says_about_looks_is_kept_for_every_seed() -> None:
    scenario = load_scenario("pass_behind")
    for seed in range(5):
        bernd = scenario.world(seed).people[0]
        assert (bernd.height_m, bernd.sex, bernd.build, bernd.clothes.top) == (
            1.86,
            "male",
            "stout",
            "jacket",
        )


def test_groups_walk_abreast() -> None:
    data = to_data(load_scenario("empty_room").spec)
    path = [{"at_m": [1.5, -1.0]}, {"at_m": [3.0, -1.0]}]
    data |= {"things": [], "groups": [{"names": ["a", "b", "c"], "spacing_m": 0.8, "path": path}]}
    people = parse_scenario(data, source="x.yaml", folder=LIBRARY).world(0).people
    assert [person.name for person in people] == ["a", "b", "c"]
    assert [person.path[0].at_m for person in people] == [(1.5, -1.8), (1.5, -1.0), (1.5, -0.2)]


def test_nobody_at_all_is_fine() -> None:
    assert load_scenario("empty_room").world(0).people == ()


def test_a_following_robot_and_a_scripted_one_get_their_behaviour() -> None:
    behaviours = next(one.choices for one in settings_of(RobotSpec) if one.key == "behaviour")
    for name in NAMES:
        scenario = loaded(name)
        assert scenario.make_behaviour() is not scenario.make_behaviour()
        assert scenario.robot.behaviour in behaviours


def test_a_follower_waits_for_a_person_for_as_long_as_the_scenario_says() -> None:
    assert loaded("follow_absence").follow_config().give_up_s == 300.0
    assert loaded("single_follow").follow_config() == FollowConfig()


@pytest.mark.parametrize(
    ("seed", "renderer", "named"),
    [(-1, "raycast", ("seed", "-1")), (0, "opengl", ("opengl", "raycast, bullet"))],
)
def test_a_negative_seed_and_an_unknown_renderer_are_refused(
    seed: int, renderer: str, named: tuple[str, ...]
) -> None:
    with refused(*named):
        load_scenario("empty_room").world(seed, renderer)


def test_the_json_schema_knows_the_keys_and_says_what_they_mean() -> None:
    schema = json_schema()
    assert {"name", "place", "people", "robot", "things"} <= set(schema["properties"])
    assert "waypoint" in str(schema).lower()
    assert schema["additionalProperties"] is False


def test_people_whose_clothes_differ_share_no_colour() -> None:
    for seed in range(5):
        clothes = [person.clothes for person in load_scenario("crowd_8").people(seed)]
        tops = {c["top_colour"] for c in clothes if c is not None}
        bottoms = {c["bottom_colour"] for c in clothes if c is not None}
        assert (len(tops), len(bottoms)) == (8, 8)


def test_a_file_that_is_like_another_replaces_whole_keys_and_keeps_the_rest() -> None:
    dark, model = load_scenario("dark_crossing"), load_scenario("crossing_2")
    assert dark.spec.people == model.spec.people
    assert (dark.name, len(dark.spec.lights)) == ("dark_crossing", 3)
    assert dark.spec.like is None


def test_a_file_that_is_like_nothing_known_is_refused() -> None:
    data = {"name": "x", "description": "x", "like": "crosing_2"}
    with refused("x.yaml: like: ", "'crosing_2'", "'crossing_2'"):
        parse_scenario(data, source="x.yaml", folder=LIBRARY)
