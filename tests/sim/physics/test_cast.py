from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from peopleboy.scenarios.files.load import load_scenario
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.physics.kinematic import Kinematic
from peopleboy.sim.robot.robot_body import NAME
from peopleboy.sim.robot.sonar import SonarRing
from peopleboy.sim.shapes.shapes import Shape, ShapeKind
from peopleboy.sim.world import SimulatedWorld
from tests.helpers.pybullet_rays import PyBulletRays

TILTED = (0.18257419, 0.36514837, 0.54772256, 0.73029674)
SHAPES = {
    "ball": Shape(kind=ShapeKind.SPHERE, size=(0.4, 0.0, 0.0)),
    "capsule": Shape(kind=ShapeKind.CAPSULE, size=(0.6, 0.2, 0.0), position=(0.1, 0.0, 0.0)),
    "cylinder": Shape(kind=ShapeKind.CYLINDER, size=(0.6, 0.3, 0.0), orientation=TILTED),
    "box": Shape(kind=ShapeKind.BOX, size=(0.5, 0.4, 0.3), position=(0.0, -0.2, 0.1)),
}
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@pytest.mark.parametrize("kind", [*SHAPES, "mesh"])
def test_rays_meet_a_shape_where_pybullet_s_do(kind: str, tmp_path: Path) -> None:
    (tmp_path / "rock.obj").write_text(TETRAHEDRON)
    mesh = Shape(kind=ShapeKind.MESH, size=(0.8, 0.9, 1.0), mesh=tmp_path / "rock.obj")
    rng = np.random.default_rng(3)
    starts = rng.normal(size=(400, 3))
    starts *= 2.0 / np.linalg.norm(starts, axis=1, keepdims=True)
    ends = rng.uniform(-0.5, 0.5, (400, 3))
    ends += ends - starts
    with Bullet() as bullet:
        kinematic = Kinematic()
        for physics in (bullet, kinematic):
            shape = SHAPES.get(kind, mesh)
            physics.add_part("shape", [shape], position=(0.1, 0.2, 0.0), orientation=TILTED)
        theirs, hit = PyBulletRays(bullet).cast_rays(starts, ends)
        ours, also_hit = kinematic.cast_rays(starts, ends)
        fraction, part = bullet.cast_rays(starts, ends)
        np.testing.assert_allclose(fraction, ours, atol=1e-9)
        np.testing.assert_array_equal(part, also_hit)
    assert 60 < (hit >= 0).sum() < 399
    # PyBullet finds round shapes by steps, the fewer the more a ray grazes them, and may miss them then.
    same = hit == also_hit
    assert same.mean() > 0.98
    differences = np.abs(ours[same] - theirs[same])
    assert np.quantile(differences, 0.98) < 1e-3
    assert differences.max() < 0.02


@pytest.mark.parametrize("name", ["corridor_straight", "crowd_8", "warm_office"])
def test_sonars_hear_in_the_library_what_they_hear_through_pybullet(name: str) -> None:
    config = replace(load_scenario(name).world(0), renderer="none")
    config = replace(
        config, robot=replace(config.robot, sonar=replace(config.robot.sonar, noise_m=0.0, drop_out=0.0))
    )
    with SimulatedWorld(config) as world:
        differences = []
        for _ in range(30):
            world.step(0.1, 0.8)
            pose = world.robot.world_from_robot()
            rings = [
                SonarRing(physics, config.robot.sonar, np.random.default_rng(0), NAME)
                for physics in (PyBulletRays(world.physics), world.physics)
            ]
            heard = [ring.read(pose) for ring in rings]
            differences.append(np.abs(heard[0] - heard[1]))
    assert np.median(differences) < 1e-5
    assert np.quantile(differences, 0.98) < 2e-3


def test_what_is_hidden_ignored_or_not_solid_lets_rays_pass() -> None:
    cube, ray = SHAPES["ball"], ([[0.0, 0.0, 0.0]], [[10.0, 0.0, 0.0]])
    physics = Kinematic()
    physics.add_part("own", [cube], position=(1.0, 0.0, 0.0))
    physics.add_part("ghost", [cube], position=(2.0, 0.0, 0.0), solid=False)
    physics.add_part("away", [cube], position=(3.0, 0.0, 0.0))
    physics.add_part("glass", [cube], position=(4.0, 0.0, 0.0), visible=False)
    physics.set_hidden("away", True)
    fraction, part = physics.cast_rays(*ray, ignore="own")
    assert (fraction[0], physics.parts()[part[0]].name) == (pytest.approx(0.36), "glass")
    assert physics.cast_rays(*ray)[0][0] == pytest.approx(0.06)
    physics.set_hidden("away", False)
    assert physics.cast_rays(*ray, ignore="own")[0][0] == pytest.approx(0.26)
    assert physics.cast_rays([[0.0, 0.0, 5.0]], [[1.0, 0.0, 5.0]])[1][0] == -1
