import math
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from peopleboy.bad_input import BadInput
from peopleboy.geometry.pose2 import Pose2
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.robot.peoplebot import PeopleBot, limit_command
from peopleboy.sim.robot.robot_body import NAME, URDF, WHEEL_DISTANCE_M, WHEEL_RADIUS_M, wheel_speeds
from peopleboy.sim.robot.robot_config import DriveConfig, RobotConfig, SonarConfig
from peopleboy.sim.shapes.shapes import Shape, ShapeKind

FLOOR = Shape(kind=ShapeKind.BOX, size=(40.0, 40.0, 0.1), position=(0.0, 0.0, -0.05))
WALL = Shape(kind=ShapeKind.BOX, size=(0.2, 6.0, 2.5), position=(0.1, 0.0, 1.2))
EXACT = DriveConfig(encoder_noise_m=0.0)
# Where the body's front is, ahead of the middle between the wheels.
FRONT_M = 0.21


@contextmanager
def on_a_floor(wall_at: float | None = None, **settings: object) -> Iterator[tuple[Bullet, PeopleBot]]:
    with Bullet() as bullet:
        bullet.add_part("floor", [FLOOR])
        if wall_at is not None:
            bullet.add_part("wall", [WALL], position=(wall_at, 0.0, 0.0))
        yield bullet, PeopleBot(bullet, RobotConfig(**{"drive": EXACT, **settings}), seed=0)


def drive(bullet: Bullet, robot: PeopleBot, command: tuple[float, float], seconds: float) -> list[np.ndarray]:
    """Drive for a time; returns the robot's pose after each control step."""
    robot.command(*command)
    poses = []
    for _ in range(round(seconds * 15)):
        for _ in range(16):
            robot.drive(1.0 / 240.0)
            bullet.step()
        robot.update_odometry()
        poses.append(robot.world_from_robot())
    return poses


def tilt_deg(poses: list[np.ndarray]) -> float:
    return max(math.degrees(math.acos(min(pose[2, 2], 1.0))) for pose in poses)


@pytest.mark.parametrize("command", [(0.5, 0.0), (-0.3, 0.0), (0.0, 1.0), (0.4, -0.5), (0.8, 2.6)])
def test_it_moves_at_the_commanded_velocity(command: tuple[float, float]) -> None:
    with on_a_floor() as (bullet, robot):
        drive(bullet, robot, command, 2.0)
        before = robot.pose()
        poses = drive(bullet, robot, command, 1.0)
        turned = sum(
            math.remainder(math.atan2(b[1, 0], b[0, 0]) - math.atan2(a[1, 0], a[0, 0]), math.tau)
            for a, b in pairwise(poses)
        )
        assert robot.velocity() == pytest.approx(command, rel=0.02, abs=0.01)
        assert turned / (len(poses) - 1) * 15 == pytest.approx(command[1], rel=0.02, abs=0.01)
        if command[1] == 0.0:
            assert robot.pose().x - before.x == pytest.approx(command[0], rel=0.01)
            assert robot.pose().y == pytest.approx(0.0, abs=0.005)
        assert robot.wheel_speeds() == pytest.approx(wheel_speeds(*command), abs=0.01)


def test_it_speeds_up_and_slows_down_no_faster_than_its_limits() -> None:
    limits = DriveConfig()
    with on_a_floor() as (bullet, robot):
        velocities = [robot.velocity()]
        for command in [(0.8, 2.0)] * 20 + [(-0.8, -2.0)] * 30:
            drive(bullet, robot, command, 1.0 / 15.0)
            velocities.append(robot.velocity())
    change = np.abs(np.diff(velocities, axis=0)) * 15.0
    assert change[:, 0].max() == pytest.approx(limits.linear_acceleration_m_s2, rel=0.1)
    assert change[:, 1].max() == pytest.approx(limits.angular_acceleration_rad_s2, rel=0.1)


@given(linear=st.floats(-1e6, 1e6), angular=st.floats(-1e6, 1e6))
def test_commands_are_clipped_to_what_it_can_do(linear: float, angular: float) -> None:
    limits = DriveConfig()
    clipped = limit_command(linear, angular, limits)
    assert abs(clipped[0]) <= limits.max_linear_m_s
    assert abs(clipped[1]) <= limits.max_angular_rad_s
    assert limit_command(*clipped, limits) == clipped


def test_it_is_no_faster_than_its_limits() -> None:
    with on_a_floor() as (bullet, robot):
        drive(bullet, robot, (99.0, 99.0), 2.0)
        limits = DriveConfig()
        expected = (limits.max_linear_m_s, limits.max_angular_rad_s)
        assert robot.velocity() == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("command", [(math.nan, 0.0), (0.0, math.inf)])
def test_a_command_that_is_no_number_is_refused(command: tuple[float, float]) -> None:
    with on_a_floor() as (_, robot), pytest.raises(BadInput, match="must be finite"):
        robot.command(*command)


@pytest.mark.parametrize("speed", [0.3, 0.8])
def test_a_wall_stops_it(speed: float) -> None:
    with on_a_floor(wall_at=1.2) as (bullet, robot):
        poses = drive(bullet, robot, (speed, 0.0), 5.0)
        front = np.array([pose[0, 3] + FRONT_M for pose in poses])
        assert front.max() < 1.2 + 0.01
        assert front[-15:].min() > 1.2 - 0.02
        assert tilt_deg(poses) < 2.0
        assert robot.touching() == {"floor", "wall"}
        assert abs(robot.velocity()[0]) < 0.05
        # The wheels turn on, and odometry does not notice.
        assert robot.odometry.x > robot.pose().x + 0.1


@pytest.mark.parametrize("seed", range(3))
def test_no_command_makes_it_tip_over(seed: int) -> None:
    rng = np.random.default_rng(seed)
    with on_a_floor() as (bullet, robot):
        for _ in range(30):
            poses = drive(bullet, robot, tuple(rng.choice([-9.0, 9.0], 2)), rng.integers(1, 12) / 15.0)
            assert tilt_deg(poses) < 1.0
            assert abs(poses[-1][2, 3]) < 0.005


@pytest.mark.parametrize("turn", [-1.2, 0.0, 1.2])
@pytest.mark.parametrize("speed", [0.3, 0.55, 0.8])
def test_an_emergency_stop_takes_three_tenths_of_a_second_and_hardly_lifts_the_castor(
    speed: float, turn: float
) -> None:
    with on_a_floor() as (bullet, robot):
        drive(bullet, robot, (speed, turn), 3.0)
        robot.command(0.0, 0.0, is_emergency=True)
        poses, moves, wheels = [], [], []
        for _ in range(180):
            robot.drive(1.0 / 240.0)
            bullet.step()
            poses.append(robot.world_from_robot())
            moves.append(robot.velocity())
            wheels.append(robot.wheel_speeds())
    rest = round(0.3 * 240)
    assert -0.08 < moves[rest][0] < 0.05
    assert np.abs(wheels[rest]).max() < 0.01
    places = np.array(poses)[rest:, :2, 3]
    assert np.hypot(*(places - places[0]).T).max() < 0.005
    assert tilt_deg(poses) < 1.0
    # The hull swings back once, and the castor lands.
    assert np.abs(moves[round(0.6 * 240) :]).max() < 0.02


def test_at_rest_it_stays_where_it_is() -> None:
    with on_a_floor() as (bullet, robot):
        poses = drive(bullet, robot, (0.0, 0.0), 10.0)
        assert np.abs(poses[-1][:3, 3]).max() < 1e-3
        assert tilt_deg(poses) < 0.05


def test_it_stops_after_driving_and_then_does_not_creep() -> None:
    with on_a_floor() as (bullet, robot):
        drive(bullet, robot, (0.8, 0.5), 3.0)
        drive(bullet, robot, (0.0, 0.0), 2.0)
        poses = drive(bullet, robot, (0.0, 0.0), 10.0)
        assert np.abs(poses[-1][:3, 3] - poses[0][:3, 3]).max() < 1e-3


def test_wheels_and_caster_stand_on_the_floor() -> None:
    with on_a_floor() as (bullet, robot):
        drive(bullet, robot, (0.0, 0.0), 0.2)
        touched = np.array([contact.position for contact in bullet.contacts(NAME)])
    for expected in [(0.0, WHEEL_DISTANCE_M / 2.0), (0.0, -WHEEL_DISTANCE_M / 2.0), (-0.20, 0.0)]:
        assert np.hypot(*(touched[:, :2] - expected).T).min() < 0.01
    assert np.abs(touched[:, 2]).max() < 0.002


def test_it_weighs_what_the_real_one_does() -> None:
    masses = [float(mass.get("value", "")) for mass in ElementTree.parse(URDF).iter("mass")]
    assert sum(masses) == pytest.approx(19.0)


def test_odometry_follows_an_arc_as_its_wheels_turn() -> None:
    linear, angular = 0.4, 0.5
    with on_a_floor(at_m=(2.0, -1.0), heading_rad=1.0) as (bullet, robot):
        assert robot.odometry == Pose2(2.0, -1.0, 1.0)
        drive(bullet, robot, (linear, angular), 1.5)
        start = robot.odometry
        drive(bullet, robot, (linear, angular), 2.0)
        end, true = robot.odometry, robot.pose()
    radius, heading = linear / angular, start.heading + 2.0 * angular
    assert end.heading == pytest.approx(heading, abs=1e-3)
    assert end.x - start.x == pytest.approx(radius * (math.sin(heading) - math.sin(start.heading)), abs=2e-3)
    assert end.y - start.y == pytest.approx(radius * (math.cos(start.heading) - math.cos(heading)), abs=2e-3)
    assert math.dist((end.x, end.y), (true.x, true.y)) < 0.01
    assert math.remainder(end.heading - true.heading, math.tau) == pytest.approx(0.0, abs=0.01)


class RollingWheels:
    """A stand-in for the physics world, in which both wheels have rolled as far as it is told."""

    rolled_m = 0.0

    def joint_states(self, *_: object) -> tuple[np.ndarray, np.ndarray]:
        return np.full(2, self.rolled_m / WHEEL_RADIUS_M), np.zeros(2)

    def add_urdf(self, *_: object, **__: object) -> None: ...

    def set_joint_speeds(self, *_: object) -> None: ...


@pytest.mark.parametrize("steps", [15, 60])
def test_odometry_drifts_with_the_square_root_of_the_way(steps: int) -> None:
    noise, way = 0.004, 3.0
    ends = []
    for seed in range(400):
        wheels = RollingWheels()
        robot = PeopleBot(wheels, RobotConfig(drive=DriveConfig(encoder_noise_m=noise)), seed)
        for step in range(steps):
            wheels.rolled_m = way * (step + 1) / steps
            robot.update_odometry()
        ends.append((robot.odometry.x, robot.odometry.heading))
    x, heading = np.array(ends).T
    sigma = noise * math.sqrt(way)
    assert x.mean() == pytest.approx(way, rel=0.02)
    assert x.std() == pytest.approx(sigma / math.sqrt(2.0), rel=0.15)
    assert heading.std() == pytest.approx(sigma * math.sqrt(2.0) / WHEEL_DISTANCE_M, rel=0.15)


def test_its_heading_wraps_around() -> None:
    with on_a_floor() as (bullet, robot):
        headings = []
        for _ in range(60):
            drive(bullet, robot, (0.0, 2.6), 1.0 / 15.0)
            headings.append((robot.odometry.heading, robot.pose().heading))
    assert np.abs(headings).max() <= math.pi
    assert np.ptp(headings) > 6.0
    assert np.abs(np.exp(1j * np.array(headings)) @ [1.0, -1.0]).max() < 0.03


@pytest.mark.parametrize(
    ("ahead", "aside", "gap"),
    [
        (0.0, 0.0, 0.0),
        (0.2, -0.18, 0.0),
        (0.51, 0.1, 0.3),
        (-0.5, 0.0, 0.2),
        (0.61, 0.49, 0.5),
        (0.0, -0.29, 0.1),
    ],
)
def test_the_gap_to_a_point_is_counted_from_its_outline(ahead: float, aside: float, gap: float) -> None:
    heading = 0.7
    with on_a_floor(at_m=(3.0, -2.0), heading_rad=heading) as (_, robot):
        x = 3.0 + math.cos(heading) * ahead - math.sin(heading) * aside
        y = -2.0 + math.sin(heading) * ahead + math.cos(heading) * aside
        assert robot.gap_to(x, y) == pytest.approx(gap, abs=1e-6)


def test_wheel_speeds_add_up_to_the_robot_s_velocity() -> None:
    left, right = wheel_speeds(0.4, 0.6)
    assert (left + right) / 2.0 == pytest.approx(0.4)
    assert (right - left) / WHEEL_DISTANCE_M == pytest.approx(0.6)
    assert WHEEL_RADIUS_M == 0.0825


def test_its_sonars_do_not_see_it_nor_the_floor() -> None:
    with on_a_floor(sonar=SonarConfig(noise_m=0.0, drop_out=0.0)) as (bullet, robot):
        for command in [(0.0, 0.0), (0.8, 2.0), (-0.8, -2.0)]:
            drive(bullet, robot, command, 0.5)
            assert np.all(robot.sonar() == 5.0)
