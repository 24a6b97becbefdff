import importlib.util
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.physics.kinematic import Kinematic
from peopleboy.sim.physics.physics_engine import default_physics
from peopleboy.sim.robot.peoplebot import PeopleBot
from peopleboy.sim.robot.robot_body import NAME, URDF
from peopleboy.sim.robot.robot_config import DriveConfig, RobotConfig
from peopleboy.sim.shapes.shapes import UPRIGHT, Shape, ShapeKind
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.calls.command_line import refusal

EXACT = RobotConfig(drive=DriveConfig(encoder_noise_m=0.0))
WALL = Shape(kind=ShapeKind.BOX, size=(0.2, 6.0, 2.5), position=(0.1, 0.0, 1.2))
PERSON = Shape(kind=ShapeKind.CAPSULE, size=(1.3, 0.22, 0.0))
FRONT_M = 0.21
GONE = """
import importlib.util, sys
find = importlib.util.find_spec
importlib.util.find_spec = lambda name, *more: None if "pybullet" in name else find(name, *more)
sys.modules["pybullet"] = sys.modules["pybullet_data"] = None
"""


def drive(physics: Kinematic, robot: PeopleBot, command: tuple[float, float], seconds: float) -> list[Pose2]:
    robot.command(*command)
    poses = []
    for _ in range(round(seconds * 240)):
        robot.drive(1.0 / 240.0)
        physics.step()
        poses.append(robot.pose())
    robot.update_odometry()
    return poses


def test_it_drives_circles_and_odometry_without_noise_is_the_truth() -> None:
    physics = Kinematic()
    robot = PeopleBot(physics, EXACT, seed=0)
    drive(physics, robot, (0.4, 0.5), 2.0)
    start = robot.pose()
    end = drive(physics, robot, (0.4, 0.5), 3.0)[-1]
    radius, heading = 0.8, start.heading + 1.5
    assert math.remainder(end.heading - heading, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert end.x - start.x == pytest.approx(radius * (math.sin(heading) - math.sin(start.heading)), abs=1e-9)
    assert end.y - start.y == pytest.approx(radius * (math.cos(start.heading) - math.cos(heading)), abs=1e-9)
    # Wheels are read once a control step in a run, and here after seconds: the chord, not the arc.
    assert robot.velocity() == pytest.approx((0.4, 0.5), abs=1e-4)
    assert robot.odometry.heading == pytest.approx(end.heading, abs=1e-9)


@pytest.mark.parametrize("heading", [0.0, 0.4, -1.2])
def test_a_wall_stops_it_while_its_wheels_turn_on(heading: float) -> None:
    physics = Kinematic()
    physics.add_part("wall", [WALL], position=(1.2, 0.0, 0.0))
    robot = PeopleBot(physics, replace(EXACT, heading_rad=heading), seed=0)
    poses = drive(physics, robot, (0.5, 0.0), 6.0)
    corners = [
        pose.x + along * math.cos(pose.heading) - aside * math.sin(pose.heading)
        for pose in poses
        for along in (-0.30, 0.21)
        for aside in (-0.19, 0.19)
    ]
    assert 1.2 - 1e-3 < max(corners) < 1.2 + 1e-4
    assert physics.touching(NAME) == {"wall"}
    if heading == 0.0:
        assert robot.pose().x == pytest.approx(1.2 - FRONT_M, abs=1e-4)
        assert abs(robot.velocity()[0]) < 1e-3
        assert robot.pose().heading == pytest.approx(0.0, abs=1e-6)
        assert robot.odometry.x > robot.pose().x + 0.5
    elif heading == 0.4:  # it is turned to face the wall
        assert robot.pose().heading == pytest.approx(0.0, abs=5e-3)
        assert robot.pose().x == pytest.approx(1.2 - FRONT_M, abs=5e-3)
    else:  # it is turned along the wall, and slides
        assert -math.pi / 2.0 < robot.pose().heading < -1.35
        assert robot.pose().y < -2.5


def test_people_push_it_and_what_is_low_or_hidden_does_not() -> None:
    physics = Kinematic()
    physics.add_part("sill", [Shape(kind=ShapeKind.BOX, size=(9.0, 9.0, 0.08), position=(0.0, 0.0, 0.04))])
    physics.add_part("ben", [PERSON])
    physics.add_part("anna", [PERSON], position=(0.0, 0.0, 0.87))
    physics.set_hidden("anna", True)
    robot = PeopleBot(physics, EXACT, seed=0)
    for step in range(240):
        physics.set_pose("ben", (0.1 - 1.5 + step / 240.0, 0.0, 0.87), UPRIGHT)
        physics.step()
        pushed = -0.30 - (0.1 - 1.5 + step / 240.0 + 0.22)
        assert robot.pose().x == pytest.approx(max(0.0, -pushed), abs=2e-3)
        assert physics.touching(NAME) == ({"ben"} if pushed < -1e-9 else set())
    assert robot.odometry == Pose2(0.0, 0.0, 0.0)


def test_what_hits_it_aside_turns_it_as_a_free_body_about_its_centre_of_mass() -> None:
    physics = Kinematic()
    robot = PeopleBot(physics, EXACT, seed=0)
    physics.add_part("ball", [Shape(kind=ShapeKind.SPHERE, size=(0.1, 0.0, 0.0))])
    physics.set_pose("ball", (FRONT_M + 0.0999, 0.15, 0.2), UPRIGHT)
    physics.step()
    # 19 kg, of which the centre lies 6.26 cm behind the axis; a radius of gyration of 12.7 cm.
    push = 1e-4 / (1.0 + 0.15**2 / 0.0163)
    assert robot.pose().heading == pytest.approx(push * 0.15 / 0.0163, rel=0.02)
    assert robot.pose().x == pytest.approx(-push, rel=0.05)


def test_only_one_body_that_rolls_on_two_wheels_can_move() -> None:
    physics = Kinematic()
    physics.add_part("cube", [WALL])
    with pytest.raises(BadInput, match="vehicles only"):
        physics.velocity("cube")
    physics.add_urdf("robot", URDF, fixed=False)
    with pytest.raises(BadInput, match="moves only one body"):
        physics.add_urdf("other", URDF, fixed=False)
    with pytest.raises(BadInput, match="left_wheel_joint"):
        physics.joint_states("robot", ["elbow"])
    with pytest.raises(BadInput, match="cannot be hidden"):
        physics.set_hidden("robot", True)
    with pytest.raises(BadInput, match="two wheels"):
        Kinematic().add_urdf("table", "table/table.urdf", fixed=False)


def test_an_image_is_the_same_by_either_physics_until_the_robot_moves() -> None:
    config = load_scenario("single_follow").world(3)
    with SimulatedWorld(config) as theirs, SimulatedWorld(replace(config, physics="kinematic")) as ours:
        assert theirs.physics.parts() == ours.physics.parts()
        for one, other in zip(theirs.physics.visual_shapes(), ours.physics.visual_shapes(), strict=True):
            assert (one.part, one.kind, one.mesh) == (other.part, other.kind, other.mesh)
            np.testing.assert_allclose(one.size, other.size, atol=1e-12)
            np.testing.assert_allclose(one.part_from_shape, other.part_from_shape, atol=1e-12)
        images = [world.observe().images for world in (theirs, ours)]
        for name in images[0]:
            one, other = (np.asarray(image[name], np.float64) for image in images)
            np.testing.assert_allclose(one, other, atol=1e-4 if name == "thermal_c" else 1.0)
            assert np.mean(one != other) < (0.1 if name == "thermal_c" else 1e-3)


@pytest.mark.slow
def test_it_gets_as_far_as_with_pybullet_to_a_few_millimetres() -> None:
    config = replace(load_scenario("corridor_straight").world(0), renderer="none")
    rng, off = np.random.default_rng(1), []
    with SimulatedWorld(config) as theirs, SimulatedWorld(replace(config, physics="kinematic")) as ours:
        for step in range(200):
            if step % 15 == 0:
                command = tuple(rng.uniform((-0.1, -0.8), (0.3, 0.8)))
            robots = []
            for world in (theirs, ours):
                world.step(*command)
                robots.append(world.scene().robot)
            off.append(math.hypot(robots[0].x - robots[1].x, robots[0].y - robots[1].y))
    assert max(off) < 5e-3


@pytest.mark.slow
def test_a_world_with_people_needs_no_pybullet() -> None:
    play = (
        "from peopleboy.scenarios.files.load import load_scenario\n"
        "from peopleboy.sim.world import SimulatedWorld\n"
        "scenario = load_scenario('single_follow')\n"
        "assert scenario.spec.physics == 'kinematic'\n"
        "with SimulatedWorld(scenario.world(0)) as world:\n"
        "    world.step(0.2, 0.1)\n"
        "    print(len(world.truth().people), world.sense().sonar_m.shape)\n"
        "try: SimulatedWorld(scenario.moved_by('bullet').world(0))\n"
        "except Exception as error: print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", GONE + play], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    first, second = done.stdout.splitlines()
    assert first.endswith("(16,)")
    assert "kinematic" in second
    assert done.stderr.splitlines() == ["PyBullet is not installed; physics is kinematic"]


def test_physics_that_there_is_not_or_that_cannot_draw_is_refused() -> None:
    scenario = load_scenario("single_follow")
    with pytest.raises(BadInput, match="choose from bullet, kinematic"):
        scenario.moved_by("magic")
    with pytest.raises(BadInput, match="choose raycast"):
        scenario.moved_by("kinematic").world(0, "bullet")


@pytest.mark.parametrize("command", ["run", "sweep", "compare"])
def test_missing_physics_are_refused_without_a_notice_of_others(
    command: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    find = importlib.util.find_spec
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None if name == "pybullet" else find(name))
    default_physics.cache_clear()
    message = refusal(capsys, command, "crossing_2", "--physics", "bullet", "--out", tmp_path / "run")
    default_physics.cache_clear()
    assert message.startswith("peopleboy: PyBullet is not installed")
    assert not (tmp_path / "run").exists()
