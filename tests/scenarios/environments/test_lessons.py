"""Options that make episodes easier or harder, and how long they hold."""

import math
from pathlib import Path

import pytest

from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.vector_environment import PeopleBoyVectorEnv
from peopleboy.scenarios.random_worlds.distribution import narrowed
from peopleboy.scenarios.random_worlds.random_world import random_world
from tests.helpers.calls.refused import refused

SCENE = """
name: lesson
description: Two people walk along a corridor.
duration_s: 1.0
place: {kind: corridor, length_m: 20.0, width_m: 4.0}
people:
  - {name: anna, path: [{at_m: [4.0, 1.0]}, {at_m: [18.0, 1.0], speed_m_s: 1.0}]}
  - {name: ben, path: [{at_m: [4.0, -1.0]}, {at_m: [18.0, -1.0], speed_m_s: 2.0}]}
robot: {at_m: [1.5, -1.0], heading_deg: 90}
"""


@pytest.fixture
def env(tmp_path: Path) -> PeopleBoyEnv:
    path = tmp_path / "lesson.yaml"
    path.write_text(SCENE, encoding="utf-8")
    return PeopleBoyEnv(path, observation="truth", physics="kinematic")


def test_pace_is_a_factor_on_walking_speeds_up_to_the_fastest(env: PeopleBoyEnv) -> None:
    env.reset(seed=0, options={"pace": 0.5})
    for _ in range(14):
        *_, info = env.step((0.0, 0.0))
    assert math.hypot(*info["truth"].people[0].velocity_m_s) == pytest.approx(0.5, abs=0.01)
    env.reset(seed=0, options={"pace": 1.5})
    assert [person.path[1].speed_m_s for person in env._world.config.people] == [1.5, 2.5]


def test_the_robot_looks_to_where_the_first_person_comes_in(env: PeopleBoyEnv) -> None:
    _, info = env.reset(seed=0, options={"facing": True})
    assert info["truth"].robot.heading == pytest.approx(math.atan2(2.0, 2.5))
    assert info["truth"].people[0].bearing_rad == pytest.approx(0.0, abs=1e-6)
    _, info = env.reset(seed=0)
    assert info["truth"].robot.heading == pytest.approx(math.pi / 2.0)


def test_a_lesson_holds_until_the_next_in_one_world_and_in_many(env: PeopleBoyEnv, tmp_path: Path) -> None:
    env.vary_by({"people": 1})
    assert [len(env.reset()[1]["truth"].people) for _ in range(2)] == [1, 1]
    assert len(env.reset(options={})[1]["truth"].people) == 2
    assert len(env.reset()[1]["truth"].people) == 1
    with refused("'peopel'", "'people'"):
        env.vary_by({"peopel": 1})
    many = PeopleBoyVectorEnv(2, scenario=tmp_path / "lesson.yaml", observation="truth", physics="kinematic")
    many.reset(seed=0)
    many.vary_by({"people": 1})
    for step in range(16):
        *_, infos = many.step(0.0 * many.action_space.sample())
        assert [len(truth.people) for truth in infos["truth"]] == [2, 2] if step < 15 else [1, 1]


def test_random_worlds_are_narrowed_to_what_is_said_and_else_as_ever() -> None:
    given = {"place": "room", "room_length": [6.0, 7.0], "people": 1, "things": [0, 2], "has_sun": 0.0}
    for seed in range(2):
        world = random_world(seed, distribution=narrowed(given))
        assert world["place"]["kind"] == "room"
        assert 6.0 <= world["place"]["length_m"] <= 7.0
        assert len(world.get("things", ())) <= 2
        assert len(world.get("people", ())) <= 1
        assert "sun" not in world["place"]
    assert random_world(5, distribution=narrowed({})) == random_world(5)


def test_an_environment_of_random_worlds_takes_them_and_draws_the_first_of_all_as_ever() -> None:
    env = PeopleBoyEnv(None, observation="truth", physics="kinematic", randomise={"world": {"people": 0}})
    assert env.reset(seed=2)[1]["truth"].people == ()
    assert env.reset(seed=2, options={})[1]["truth"].people != ()


@pytest.mark.parametrize(
    ("world", "named"),
    [
        ({"poeple": 1}, ("options.world.poeple", "'people'")),
        ({"people": [3, 99]}, ("options.world.people", "[3, 99]", "whole", "0 .. 10")),
        ({"people": 1.5}, ("1.5", "whole")),
        ({"speed": [1.0, 0.5]}, ("options.world.speed", "0.4 .. 1.8 m/s")),
        ({"place": "castle"}, ("options.world.place", "'castle'", "corridor")),
        ({"has_sun": 2}, ("options.world.has_sun", "0 .. 1")),
        ("room", ("options.world", "'room'", "mapping")),
    ],
)
def test_worlds_that_are_not_drawn_are_refused_in_one_line(world: object, named: tuple[str, ...]) -> None:
    with refused(*named):
        PeopleBoyEnv(None, observation="truth", randomise={"world": world})
