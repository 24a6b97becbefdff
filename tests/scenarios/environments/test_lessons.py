"""Options that make episodes easier or harder, and how long they hold."""

import math
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.environments.environment import PeopleBoyEnv
from peopleboy.scenarios.environments.vector_environment import PeopleBoyVectorEnv
from peopleboy.scenarios.files.variation import ActionChannel
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


def test_an_action_reaches_the_drive_after_the_latency(env: PeopleBoyEnv) -> None:
    env.reset(seed=0, options={"latency_s": 0.2})
    for step in range(4):
        env.step((0.5, -0.25))
        assert env._commands[-1].tolist() == (
            pytest.approx([0.4, -math.radians(37.5)]) if step == 3 else [0.0, 0.0]
        )


def test_action_noise_has_its_standard_deviation_and_depends_on_the_seed() -> None:
    channels = [ActionChannel(seed, {"action_noise": [0.1, 0.1]}, 1.0 / 15.0) for seed in (1, 1, 2)]
    sent = np.array([[channel.send(np.zeros(2)) for _ in range(2000)] for channel in channels])
    assert sent.std() == pytest.approx(0.1, rel=0.05)
    np.testing.assert_array_equal(sent[0], sent[1])
    assert (sent[0] != sent[2]).all()


def test_wheels_that_slip_move_the_robot_less_and_the_odometry_does_not_notice(env: PeopleBoyEnv) -> None:
    ways, odometry = [], []
    for options in ({}, {"wheel_slip": 0.5}):
        _, info = env.reset(seed=0, options=options)
        start = info["truth"].robot
        for _ in range(14):
            observation, *_, info = env.step((0.3, 0.0))
        ways.append(math.dist((start.x, start.y), (info["truth"].robot.x, info["truth"].robot.y)))
        odometry.append(observation["odometry"][0])
    assert ways[1] < 0.65 * ways[0]
    assert odometry[1] > 0.85 * odometry[0]


def test_cameras_are_mounted_elsewhere_within_the_ranges(env: PeopleBoyEnv) -> None:
    env.reset(seed=0)
    usual = env.world.config.robot.cameras
    env.reset(seed=0, options={"camera_pitch_deg": [2.0, 8.0], "camera_height_m": -0.3})
    for name, config in env.world.config.robot.cameras.items():
        turned = math.degrees(config.camera.pitch_rad - usual[name].camera.pitch_rad)
        assert 2.0 <= turned <= 8.0
        assert config.camera.position_m[2] == pytest.approx(usual[name].camera.position_m[2] - 0.3)


def test_many_worlds_are_disturbed_as_single_ones_and_saved() -> None:
    settings = {"observation": "truth", "physics": "kinematic"}
    options = {
        "action_noise": 0.3,
        "latency_s": [0.0, 0.3],
        "wheel_slip": [0.0, 0.5],
        "camera_pitch_deg": [-5.0, 5.0],
    }
    many = PeopleBoyVectorEnv(2, randomise=options, **settings)
    many.reset(seed=7)
    for number in range(2):
        single = PeopleBoyEnv(randomise=options, **settings)
        single.reset(seed=7 + number)
        if number == 0:
            rows = [many.step(np.full((2, 2), 0.5, np.float32))[0] for _ in range(12)]
        for row in rows:
            alone = single.step(np.full(2, 0.5, np.float32))[0]
            for name, array in alone.items():
                np.testing.assert_array_equal(row[name][number], array)
        np.testing.assert_array_equal(many.envs[number]._commands, single._commands)


def test_errors_of_the_calibration_shift_the_images_of_an_episode(env: PeopleBoyEnv) -> None:
    seeing = PeopleBoyEnv(
        env._scenario, observation="pixels", physics="kinematic", cameras=("colour",), image_size=(64, 48)
    )
    every = ({}, {"calibration_turned": 10.0}, {"calibration_off": 0.25})
    images = [seeing.reset(seed=0, options=options)[0]["colour"] for options in every]
    np.testing.assert_array_equal(images[2][:, 16:], images[0][:, :48])
    assert (images[1] != images[0]).mean() > 0.3
