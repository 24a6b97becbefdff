import math
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from peopleboy.random_streams import stream
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.robot.robot_body import SONAR_ANGLE_RAD, SONAR_POSITION_M
from peopleboy.sim.robot.robot_config import SonarConfig
from peopleboy.sim.robot.sonar import SonarRing, cone_rays
from peopleboy.sim.shapes.shapes import Shape, ShapeKind

EXACT = SonarConfig(noise_m=0.0, drop_out=0.0)
HALF_CONE = EXACT.cone_rad / 2.0


@pytest.fixture(scope="module")
def wall() -> Iterator[Bullet]:
    """A wall whose face is the plane x = 0, seen from x < 0, and the body that carries the ring."""
    with Bullet() as bullet:
        bullet.add_part("wall", [Shape(kind=ShapeKind.BOX, size=(0.2, 60.0, 4.0), position=(0.1, 0.0, 1.0))])
        bullet.add_part("robot", [Shape(kind=ShapeKind.BOX, size=(0.1, 0.1, 0.1))], position=(50.0, 0.0, 0.0))
        yield bullet


def ring(bullet: Bullet, config: SonarConfig, seed: int = 0) -> SonarRing:
    return SonarRing(bullet, config, stream(seed, "sonar.noise"), "robot")


def pose(x: float, y: float, heading: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:2, :2] = [[math.cos(heading), -math.sin(heading)], [math.sin(heading), math.cos(heading)]]
    matrix[:2, 3] = x, y
    return matrix


@given(distance=st.floats(0.5, 6.0), heading=st.floats(-math.pi, math.pi))
@settings(deadline=None, max_examples=60)
def test_each_reads_the_way_to_the_nearest_point_of_a_wall_in_its_cone(
    wall: Bullet, distance: float, heading: float
) -> None:
    world_from_robot = pose(-distance, 3.0, heading)
    readings = ring(wall, EXACT).read(world_from_robot)
    from_wall = distance - (SONAR_POSITION_M @ world_from_robot[:2, :2].T)[:, 0]
    angle = np.abs(np.remainder(SONAR_ANGLE_RAD + heading + math.pi, math.tau) - math.pi)
    slant = np.maximum(angle - HALF_CONE, 0.0)
    expected = np.where(slant < math.pi / 2.0, from_wall / np.maximum(np.cos(slant), 1e-9), np.inf)
    # Between rays a quarter of the cone apart the nearest point may be missed by a little.
    assert readings == pytest.approx(np.clip(expected, 0.15, 5.0), rel=2e-3)


def test_nothing_is_nearer_than_the_nearest_reading(wall: Bullet) -> None:
    assert ring(wall, EXACT).read(pose(-0.2, 0.0, 0.0))[[3, 4]] == pytest.approx([0.15, 0.15])


def test_where_nothing_answers_it_reads_the_farthest(wall: Bullet) -> None:
    assert np.all(ring(wall, SonarConfig()).read(pose(-30.0, 0.0, 0.0)) == 5.0)


def test_the_stated_share_of_readings_is_lost(wall: Bullet) -> None:
    sonars = ring(wall, SonarConfig(noise_m=0.0, drop_out=0.2))
    readings = np.array([sonars.read(pose(-2.0, 0.0, 0.0))[2:6] for _ in range(400)])
    assert (readings == 5.0).mean() == pytest.approx(0.2, abs=0.04)
    assert np.all((readings == 5.0) | (readings < 2.5))


def test_noise_has_the_stated_size_and_repeats_with_its_stream(wall: Bullet) -> None:
    sonars = ring(wall, SonarConfig(noise_m=0.03, drop_out=0.0))
    readings = np.array([sonars.read(pose(-2.0, 0.0, 0.0))[3:5] for _ in range(400)])
    exact = ring(wall, EXACT).read(pose(-2.0, 0.0, 0.0))[3:5]
    assert (readings - exact).std() == pytest.approx(0.03, rel=0.1)
    assert (readings - exact).mean() == pytest.approx(0.0, abs=0.005)
    again = ring(wall, SonarConfig(noise_m=0.03, drop_out=0.0))
    assert np.array_equal(again.read(pose(-2.0, 0.0, 0.0))[3:5], readings[0])


def test_the_floor_is_not_heard_but_what_lies_on_it_is() -> None:
    with Bullet() as bullet:
        floor = Shape(kind=ShapeKind.BOX, size=(40.0, 40.0, 0.1), position=(0.0, 0.0, -0.05))
        bullet.add_part("floor", [floor])
        bullet.add_part("robot", [Shape(kind=ShapeKind.SPHERE, size=(0.1, 0.0, 0.0))])
        assert np.all(ring(bullet, EXACT).read(np.eye(4)) == 5.0)
        crate = Shape(kind=ShapeKind.BOX, size=(0.2, 2.0, 0.2))
        bullet.add_part("crate", [crate], position=(1.6, 0.0, 0.1))
        assert ring(bullet, EXACT).read(np.eye(4))[3] == pytest.approx(1.5 - 0.166, rel=0.01)


def test_the_body_that_carries_the_ring_is_not_heard() -> None:
    with Bullet() as bullet:
        screen = Shape(kind=ShapeKind.BOX, size=(0.05, 2.0, 1.0), position=(1.0, 0.0, 0.3))
        bullet.add_part("robot", [screen])
        assert np.all(ring(bullet, EXACT).read(np.eye(4)) == 5.0)


def test_the_ring_is_that_of_the_real_robot() -> None:
    degrees = np.degrees(SONAR_ANGLE_RAD).round()
    front, rear = [90, 50, 30, 10, -10, -30, -50, -90], [-90, -130, -150, -170, 170, 150, 130, 90]
    assert degrees.tolist() == front + rear
    # Its left side mirrors its right side.
    assert SONAR_POSITION_M[:8] == pytest.approx(SONAR_POSITION_M[7::-1] * [1.0, -1.0])
    assert SONAR_POSITION_M[8:] == pytest.approx(SONAR_POSITION_M[:7:-1] * [1.0, -1.0])
    assert np.hypot(*SONAR_POSITION_M.T).max() < 0.27


def test_the_rays_of_a_sonar_fill_its_cone_and_no_more() -> None:
    rays = cone_rays(EXACT.cone_rad)
    axes = np.stack([np.cos(SONAR_ANGLE_RAD), np.sin(SONAR_ANGLE_RAD), np.zeros(16)], axis=1)
    angles = np.arccos(np.clip(np.einsum("snk,sk->sn", rays, axes), -1.0, 1.0))
    assert np.linalg.norm(rays, axis=-1) == pytest.approx(1.0)
    assert angles.max() == pytest.approx(HALF_CONE)
    assert angles[:, 0] == pytest.approx(0.0, abs=1e-7)
