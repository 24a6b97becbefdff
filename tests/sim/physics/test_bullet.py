import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from peopleboy.sim.geometry.pinhole import Pinhole, invert_pose, transform
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.shapes.shapes import Quaternion, Shape, ShapeKind
from tests.helpers.calls.refused import refused
from tests.helpers.pybullet_rays import PyBulletRays

CUBE = Shape(kind=ShapeKind.BOX, size=(1.0, 1.0, 1.0))
TILTED: Quaternion = (0.1, 0.5, -0.1, math.sqrt(1.0 - 0.27))


def test_names_are_taken_once_and_unknown_ones_are_refused() -> None:
    with Bullet() as bullet:
        bullet.add_part("cube", [CUBE])
        with refused("'cube'"):
            bullet.add_part("cube", [CUBE])
        with refused("'ball'", "cube"):
            bullet.pose("ball")
        with refused("'elbow'"):
            bullet.set_joint_speeds("cube", {"elbow": 1.0}, 1.0)


def test_shapes_and_files_that_cannot_be_used_are_refused_in_one_line(tmp_path: Path) -> None:
    broken = tmp_path / "broken.urdf"
    broken.write_text("<robot name='x'><link")
    mesh = Shape(kind=ShapeKind.MESH, size=(1.0, 1.0, 1.0), mesh=tmp_path / "none.obj")
    with Bullet() as bullet:
        for add in (
            lambda: bullet.add_urdf("a", "none.urdf"),
            lambda: bullet.add_urdf("a", broken),
            lambda: bullet.add_part("a", [mesh]),
            lambda: bullet.add_part("a", []),
        ):
            with refused():
                add()
        assert bullet.parts() == ()


def test_nothing_reaches_the_terminal() -> None:
    program = """
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.shapes.shapes import Shape, ShapeKind
print("before")
with Bullet() as bullet:
    bullet.add_urdf("husky", "husky/husky.urdf", position=(0, 0, 1), fixed=False)
    bullet.add_part("plane", [Shape(kind=ShapeKind.PLANE, size=(0, 0, 0))])
    bullet.step()
print("after")
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout == "before\nafter\n"
    assert run.stderr == ""


def test_a_process_without_standard_output_can_use_it() -> None:
    use = "from peopleboy.sim.physics.bullet import Bullet; Bullet().add_urdf('c', 'cube.urdf')"
    program = f"import os; os.close(1); {use}"
    assert subprocess.run([sys.executable, "-c", program]).returncode == 0


def test_two_worlds_do_not_meet() -> None:
    with Bullet() as one, Bullet() as other:
        one.add_part("cube", [CUBE], position=(2.0, 0.0, 0.0))
        other.add_part("cube", [CUBE], position=(5.0, 0.0, 0.0))
        for bullet, distance in ((one, 1.5), (other, 4.5)):
            fraction, part = bullet.cast_rays([[0.0, 0.0, 0.0]], [[10.0, 0.0, 0.0]])
            assert fraction[0] == pytest.approx(distance / 10.0)
            assert part[0] == 0


@pytest.mark.parametrize("model", ["duck_vhacd.urdf", "kiva_shelf/model.sdf", "r2d2.urdf"])
def test_the_pose_of_a_model_is_that_of_its_base_link(model: str) -> None:
    with Bullet() as bullet:
        bullet.add_urdf("model", model, position=(1.0, 2.0, 3.0), orientation=TILTED)
        expected = pose_matrices((1.0, 2.0, 3.0), TILTED)
        np.testing.assert_allclose(bullet.pose("model"), expected, atol=2e-6)
        np.testing.assert_allclose(bullet.part_poses()[0], expected, atol=2e-6)
        assert len(bullet.part_poses()) == len(bullet.parts())


def test_poses_follow_what_is_set_and_what_physics_does() -> None:
    with Bullet() as bullet:
        bullet.add_part("cube", [CUBE])
        bullet.add_urdf("free", "sphere2.urdf", position=(9.0, 0.0, 5.0), fixed=False)
        bullet.part_poses()
        bullet.set_pose("cube", (0.0, 0.0, 0.5), TILTED)
        for _ in range(24):
            bullet.step()
        poses = bullet.part_poses()
        linear, angular = bullet.velocity("free")
    np.testing.assert_allclose(linear, (0.0, 0.0, -0.981), atol=5e-3)  # PyBullet adds a little drag
    np.testing.assert_allclose(angular, 0.0, atol=1e-9)
    np.testing.assert_allclose(poses[0], pose_matrices((0.0, 0.0, 0.5), TILTED), atol=1e-9)
    # PyBullet adds g dt to the velocity before each of n steps: z falls by g dt^2 n (n + 1) / 2.
    assert poses[1, 2, 3] == pytest.approx(5.0 - 9.81 / 240**2 * 24 * 25 / 2, abs=1e-3)


def test_a_fallen_ball_presses_on_the_floor_with_its_weight() -> None:
    with Bullet() as bullet:
        bullet.add_part("floor", [Shape(kind=ShapeKind.BOX, size=(9.0, 9.0, 1.0), position=(0.0, 0.0, -0.5))])
        bullet.add_urdf("ball", "sphere2.urdf", position=(0.0, 0.0, 0.501), fixed=False)
        for _ in range(480):
            bullet.step()
        contacts = bullet.contacts("ball")
        assert {contact.other for contact in contacts} == {"floor"}
        assert sum(contact.normal_force_n for contact in contacts) == pytest.approx(10.0 * 9.81, rel=0.01)
        assert contacts[0].normal == pytest.approx((0.0, 0.0, 1.0), abs=1e-6)


def test_a_wheel_reaches_the_speed_that_is_asked_for() -> None:
    with Bullet(gravity=False) as bullet:
        bullet.add_urdf("r2d2", "r2d2.urdf", fixed=True)
        wheels = ["left_front_wheel_joint", "right_front_wheel_joint"]
        bullet.set_joint_speeds("r2d2", {wheels[0]: 2.0, wheels[1]: -1.0}, 50.0)
        for _ in range(120):
            bullet.step()
        positions, speeds = bullet.joint_states("r2d2", wheels)
    np.testing.assert_allclose(speeds, (2.0, -1.0), atol=0.02)
    assert positions[0] > 0.5
    assert positions[1] < -0.2


def test_rays_pass_what_is_ignored_hidden_or_not_solid_and_stop_at_the_invisible() -> None:
    ray = ([[0.0, 0.0, 0.0]], [[10.0, 0.0, 0.0]])
    with Bullet() as bullet:
        bullet.add_part("own", [CUBE], position=(1.0, 0.0, 0.0))
        bullet.add_part("ghost", [CUBE], position=(2.0, 0.0, 0.0), solid=False)
        bullet.add_part("away", [CUBE], position=(3.0, 0.0, 0.0))
        bullet.add_part("glass", [CUBE], position=(4.0, 0.0, 0.0), visible=False)
        bullet.set_hidden("away", True)
        fraction, part = bullet.cast_rays(*ray, ignore="own")
        assert (fraction[0], bullet.parts()[part[0]].name) == (pytest.approx(0.35), "glass")
        assert bullet.cast_rays(*ray)[0][0] == pytest.approx(0.05)
        bullet.set_hidden("away", False)
        assert bullet.cast_rays(*ray, ignore="own")[0][0] == pytest.approx(0.25)


def test_rays_meet_given_and_loaded_bodies_where_pybullet_s_own_do() -> None:
    rng = np.random.default_rng(5)
    capsule = Shape(kind=ShapeKind.CAPSULE, size=(1.0, 0.2, 0.0))
    plane = Shape(kind=ShapeKind.PLANE, size=(0.0, 0.0, 0.0))
    with Bullet() as bullet:
        bullet.add_part("ground", [plane], position=(0.0, 0.0, -2.0))
        # Fixed: where a body that moves freely goes when it starts inside others, PyBullet leaves to chance.
        bullet.add_urdf("car", "racecar/racecar.urdf", fixed=True)
        for name in ("a", "b", "c"):
            bullet.add_part(name, [CUBE, capsule], position=tuple(rng.uniform(-2, 2, 3)), orientation=TILTED)
        for ignore in (None, "car", "a", None):
            for name in ("b", "car"):
                bullet.set_pose(name, tuple(rng.uniform(-2.0, 2.0, 3)), TILTED)
            bullet.step()
            starts, ends = rng.uniform(-3.0, 3.0, (2, 300, 3))
            starts[:, 2] = np.maximum(
                starts[:, 2], -1.9
            )  # above the ground, which PyBullet's meet from below
            ends[:40] = bullet.pose("car")[:3, 3] + rng.normal(scale=0.05, size=(40, 3))
            ends[::4, 2] = starts[::4, 2]  # level, as most rays are
            fraction, part = bullet.cast_rays(starts, ends, ignore)
            their_fraction, theirs = PyBulletRays(bullet).cast_rays(starts, ends, ignore)
            # PyBullet finds round shapes by steps, and may miss them where a ray grazes them.
            same = part == theirs
            assert same.mean() > 0.98
            differences = np.abs(fraction - their_fraction)[same]
            assert np.quantile(differences, 0.98) < 1e-3
            assert differences.max() < 0.02
            is_of_car = np.array([number >= 0 and bullet.parts()[number].name == "car" for number in theirs])
            assert (differences[is_of_car[same]] == 0.0).all()
            assert 20 < np.sum(part >= 0) < 200
            assert is_of_car.any() == (ignore != "car")


def test_a_hidden_body_keeps_its_place_and_may_be_moved_meanwhile() -> None:
    with Bullet() as bullet:
        bullet.add_part("cube", [CUBE], position=(1.0, 0.0, 0.0))
        bullet.add_urdf("free", "cube.urdf", fixed=False)
        bullet.set_hidden("cube", True)
        assert bullet.hidden_parts().tolist() == [True, False]
        assert bullet.pose("cube")[0, 3] == 1.0
        bullet.set_pose("cube", (2.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
        assert bullet.part_poses()[0, 2, 3] < -100.0
        bullet.set_hidden("cube", False)
        assert bullet.part_poses()[0, 0, 3] == 2.0
        with refused("'free'"):
            bullet.set_hidden("free", True)


def test_a_part_of_many_shapes_is_whole_everywhere() -> None:
    places = [(4.0, 0.1 * (i - 20), 0.0) for i in range(40)]
    balls = [Shape(kind=ShapeKind.SPHERE, size=(0.03, 0.0, 0.0), position=place) for place in places]
    with Bullet() as bullet:
        bullet.add_part("necklace", balls)
        shapes = bullet.visual_shapes()
        assert [tuple(shape.part_from_shape[:3, 3]) for shape in shapes] == [pytest.approx(p) for p in places]
        assert {shape.part for shape in shapes} == {0}
        fraction, part = bullet.cast_rays(np.zeros((40, 3)), 2.0 * np.array(places))
        np.testing.assert_allclose(part, 0)
        assert np.all(fraction < 0.5)
        camera = Pinhole(position_m=(0.0, 0.0, 0.0))
        mask, _ = bullet.camera_image(camera, camera.robot_from_camera)
        pixels = camera.project(transform(invert_pose(camera.robot_from_camera), np.array(places)))
        u, v = np.rint(pixels).astype(int).T
        assert np.all(mask[v, u] == 0)


def test_all_kinds_of_shapes_are_read_back_as_they_were_given(tmp_path: Path) -> None:
    file = tmp_path / "triangle.obj"
    file.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    sizes = {
        ShapeKind.SPHERE: (0.3, 0.0, 0.0),
        ShapeKind.CAPSULE: (0.5, 0.2, 0.0),
        ShapeKind.CYLINDER: (0.4, 0.1, 0.0),
        ShapeKind.BOX: (0.1, 0.2, 0.3),
        ShapeKind.MESH: (1.0, 2.0, 3.0),
    }
    given = [
        Shape(
            kind=kind,
            size=size,
            position=(0.1 * kind, 0.2, 0.3),
            orientation=TILTED,
            mesh=file if kind == ShapeKind.MESH else None,
        )
        for kind, size in sizes.items()
    ]
    with Bullet() as bullet:
        bullet.add_part("unseen", [CUBE], visible=False)
        bullet.add_part("all", given)
        back = bullet.visual_shapes()
    for shape, seen in zip(given, back, strict=True):
        assert (seen.part, seen.kind, seen.mesh) == (1, shape.kind, shape.mesh)
        assert seen.size == pytest.approx(shape.size)
        expected = pose_matrices(shape.position, shape.orientation)
        np.testing.assert_allclose(seen.part_from_shape, expected, atol=1e-9)


@pytest.mark.parametrize("solid", [True, False])
def test_many_bodies_are_put_as_each_by_itself_and_as_pybullet_has_them(solid: bool) -> None:
    rng, names = np.random.default_rng(2), ("a", "b", "c")
    positions, orientations = rng.normal(size=(3, 3)), rng.normal(size=(3, 4))
    camera = Pinhole(position_m=(0.0, 0.0, 0.0))
    seen = []
    for at_once in (True, False):
        with Bullet() as bullet:
            for name in names:
                bullet.add_part(name, [CUBE], solid=solid)
            bullet.camera_image(camera, camera.robot_from_camera)
            if at_once:
                bullet.set_poses(names, positions, orientations)
            else:
                for row in zip(names, positions.tolist(), orientations.tolist(), strict=True):
                    bullet.set_pose(*row)
            drawn = bullet.camera_image(camera, camera.robot_from_camera)
            theirs = [bullet._client.getBasePositionAndOrientation(body.ids[0]) for body in bullet._bodies]
            seen.append((bullet.part_poses(), *drawn))
            np.testing.assert_allclose(
                bullet.part_poses(), pose_matrices(*zip(*theirs, strict=True)), atol=1e-7
            )
            np.testing.assert_array_equal(bullet.pose("b"), bullet.part_poses()[1])
    for one, other in zip(*seen, strict=True):
        np.testing.assert_array_equal(one, other)


def test_what_nothing_can_touch_is_no_body_of_pybullet_s_until_it_draws() -> None:
    camera = Pinhole(position_m=(-3.0, 0.0, 0.0))
    with Bullet() as bullet:
        bullet.add_part("wall", [CUBE], position=(0.0, 2.0, 0.0))
        bullet.add_part("ghost", [CUBE], solid=False)
        bullet.add_part("nothing", [CUBE], solid=False, visible=False)
        assert bullet._client.getNumBodies() == 1
        parts, _ = bullet.camera_image(camera, camera.robot_from_camera)
        assert set(np.unique(parts).tolist()) == {-1, 0, 1}
        assert bullet._client.getNumBodies() == 2
