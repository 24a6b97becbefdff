"""Both renderers against each other.

TinyRenderer replaces spheres and capsules by polyhedra whose faces lie up to 5 % of the radius within the
true surface. Radii are kept below a sixtieth of the distance (5 pixels), so that its outlines are off by less
than a pixel and its depths by less than 1 %. Boxes, meshes and walls, which it draws as they are, may be of
any size.
"""

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Pinhole, invert_pose
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.rendering.renderer import Scene, cast, render, silhouette_area, silhouette_bounds
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.shape_table import ShapeTable, VisualShape, make_shape_table
from peopleboy.sim.shapes.shapes import Quaternion, Shape, ShapeKind
from tests.helpers.calls.refused import refused
from tests.helpers.some_of import some_of

ROOM = {
    "floor": ((0.0, 0.0, -0.05), (30.0, 6.0, 0.1)),
    "left": ((0.0, 3.0, 1.5), (30.0, 0.1, 3.0)),
    "right": ((0.0, -3.0, 1.5), (30.0, 0.1, 3.0)),
    "end": ((9.0, 0.0, 1.5), (0.1, 6.0, 3.0)),
}
# Each loads its meshes, its frames or its scale in another way; all are drawn from a few metres.
MODELS = [
    "table/table.urdf",
    "table_square/table_square.urdf",
    "kiva_shelf/model.sdf",
    "husky/husky.urdf",
    "r2d2.urdf",
    "racecar/racecar.urdf",
    "samurai.urdf",
    "duck_vhacd.urdf",
    "teddy_vhacd.urdf",
    "plane.urdf",
    "tray/tray.urdf",
    "cube.urdf",
    "laikago/laikago_toes_zup.urdf",
]


def drawn_by(name: str, bullet: Bullet, camera: Pinhole, people: NDArray[np.int64]) -> View:
    scene = Scene(
        renderer=name,
        physics=bullet,
        table=make_shape_table(bullet.visual_shapes()),
        world_from_part=bullet.part_poses(),
        person_of_part=people,
        hidden=bullet.hidden_parts(),
    )
    return render(scene, camera, camera.robot_from_camera)


def both(bullet: Bullet, camera: Pinhole, people: NDArray[np.int64]) -> tuple[View, View]:
    cast, drawn = (drawn_by(name, bullet, camera, people) for name in ("raycast", "bullet"))
    return cast, drawn


def near_boundary(mask: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Pixels of which one of the eight neighbours shows another part."""
    padded, (height, width) = np.pad(mask, 1, mode="edge"), mask.shape
    shifts = [(i, j) for i in range(3) for j in range(3)]
    return np.any([padded[i : i + height, j : j + width] != mask for i, j in shifts], axis=0)


def assert_alike(cast: View, drawn: View) -> None:
    boundary = near_boundary(cast.part) | near_boundary(drawn.part)
    assert not np.any((cast.part != drawn.part) & ~boundary)
    same = (cast.part == drawn.part) & (cast.part >= 0) & ~boundary
    np.testing.assert_allclose(drawn.depth[same], cast.depth[same], rtol=0.01)


def turned(rng: np.random.Generator) -> Quaternion:
    x, y, z, w = rng.normal(size=4)
    length = float(np.sqrt(x * x + y * y + z * z + w * w))
    return x / length, y / length, z / length, w / length


def random_shape(rng: np.random.Generator, scale: float, mesh: Path) -> Shape:
    radius, length = scale * rng.uniform(0.4, 1.0), scale * rng.uniform(0.5, 8.0)
    sizes = {
        ShapeKind.SPHERE: (radius, 0.0, 0.0),
        ShapeKind.CAPSULE: (length, radius, 0.0),
        ShapeKind.CYLINDER: (length, radius, 0.0),
        ShapeKind.BOX: (8.0 * radius, length, 3.0 * radius),
        ShapeKind.MESH: (8.0 * radius, length, 6.0 * radius),
    }
    kind = list(sizes)[rng.integers(len(sizes))]
    return Shape(
        kind=kind,
        size=sizes[kind],
        position=(0.0, 0.0, 2.0 * radius),
        orientation=turned(rng),
        mesh=mesh if kind == ShapeKind.MESH else None,
    )


def fill_at_random(bullet: Bullet, rng: np.random.Generator, mesh: Path) -> NDArray[np.int64]:
    """Put a room, or the infinite floor, and 14 random bodies into a world; return whose the parts are."""
    if rng.random() < 0.5:
        for name, (position, size) in ROOM.items():
            bullet.add_part(name, [Shape(kind=ShapeKind.BOX, size=size)], position=position)
    else:
        bullet.add_part("floor", [Shape(kind=ShapeKind.PLANE, size=(0.0, 0.0, 0.0))])
    room = len(bullet.parts())
    for i in range(14):
        x = rng.uniform(1.5, 6.0)
        place = (x, rng.uniform(-0.5, 0.5) * x, 1.2 + rng.uniform(-0.4, 0.4) * x)
        shape = random_shape(rng, 0.016 * x, mesh)
        bullet.add_part(f"body {i}", [shape], position=place, orientation=turned(rng))
    return np.concatenate([np.full(room, -1), rng.integers(-1, 4, 14)])


@pytest.fixture(scope="module")
def rock(tmp_path_factory: pytest.TempPathFactory) -> Path:
    mesh = trimesh.creation.icosphere(subdivisions=2)
    mesh.vertices *= np.random.default_rng(0).uniform(0.7, 1.0, (len(mesh.vertices), 1))
    path: Path = tmp_path_factory.mktemp("meshes") / "rock.obj"
    mesh.export(path)
    return path


@pytest.mark.parametrize("seed", some_of(range(25), 3))
def test_both_renderers_agree_on_random_worlds(seed: int, rock: Path) -> None:
    rng = np.random.default_rng(seed)
    with Bullet() as bullet:
        people = fill_at_random(bullet, rng, rock)
        camera = Pinhole(yaw_rad=rng.normal() * 0.2, pitch_rad=rng.normal() * 0.15)
        cast, drawn = both(bullet, camera, people)
    assert len(np.unique(cast.part)) > 2
    assert_alike(cast, drawn)
    for person in range(4):
        silhouettes = [(view.cover & np.uint64(1 << person) > 0).astype(np.int32) for view in (cast, drawn)]
        edge = near_boundary(silhouettes[0]) | near_boundary(silhouettes[1])
        assert np.array_equal(silhouettes[0][~edge], silhouettes[1][~edge])
    alike = np.sum(cast.normal * drawn.normal, axis=-1)[~near_boundary(cast.part) & (cast.part >= 0)]
    assert np.mean(alike > 0.98) > 0.9


@pytest.mark.slow
@pytest.mark.parametrize("model", some_of(MODELS, 3))
def test_both_renderers_agree_on_models_of_pybullet_data(model: str) -> None:
    with Bullet() as bullet:
        bullet.add_urdf(
            "model", model, scale=5.0 if "vhacd" in model else 1.0, orientation=(0.1, 0.2, 0.3, 0.9274)
        )
        distance = 30.0 if model == "samurai.urdf" else 4.0
        camera = Pinhole(position_m=(-distance, 0.3, distance / 2), pitch_rad=0.45)
        cast, drawn = both(bullet, camera, np.full(len(bullet.parts()), -1))
    assert np.mean(cast.part >= 0) > 0.001
    boundary = near_boundary(cast.part) | near_boundary(drawn.part)
    assert not np.any((cast.part != drawn.part) & ~boundary)
    same = (cast.part == drawn.part) & (cast.part >= 0) & ~boundary
    # At an edge inside a part the last digit decides which side a pixel shows.
    assert np.mean(np.abs(drawn.depth[same] / cast.depth[same] - 1.0) > 0.01) < 1e-3


@pytest.mark.parametrize("kind", ["hidden", "invisible"])
def test_what_is_hidden_or_invisible_is_drawn_by_neither(kind: str) -> None:
    cube = [Shape(kind=ShapeKind.BOX, size=(1.0, 1.0, 1.0))]
    camera = Pinhole(position_m=(0.0, 0.0, 0.0))
    with Bullet() as bullet:
        bullet.add_part(
            "ball", [Shape(kind=ShapeKind.SPHERE, size=(0.5, 0.0, 0.0))], position=(5.0, 0.0, 0.0)
        )
        bullet.add_part("cube", cube, position=(3.0, 0.0, 0.0), visible=kind != "invisible")
        if kind == "hidden":
            bullet.set_hidden("cube", True)
        for view in both(bullet, camera, np.array([0, 1])):
            assert set(np.unique(view.part)) == {-1, 0}
            assert set(np.unique(view.cover)) == {0, 1}


@pytest.mark.parametrize(
    ("name", "person", "named"),
    [("opengl", 0, ("opengl", "raycast", "bullet")), ("raycast", 64, ("64",))],
)
def test_an_unknown_renderer_and_too_many_people_are_refused(
    name: str, person: int, named: tuple[str, ...]
) -> None:
    with Bullet() as bullet:
        bullet.add_part("ball", [Shape(kind=ShapeKind.SPHERE, size=(0.5, 0.0, 0.0))])
        with refused(*named):
            drawn_by(name, bullet, Pinhole(), np.array([person]))


KINDS = [ShapeKind.SPHERE, ShapeKind.CAPSULE, ShapeKind.CYLINDER, ShapeKind.BOX]
EVERYTHING = np.ones(1, np.bool_)
HERE = np.eye(4)[None]


def bounds_of(table: ShapeTable, camera: Pinhole, pose: np.ndarray) -> np.ndarray:
    return silhouette_bounds(camera, table, invert_pose(pose) @ HERE, EVERYTHING[None])[0]


def area_of(table: ShapeTable, camera: Pinhole, pose: np.ndarray) -> int:
    bounds = bounds_of(table, camera, pose).tolist()
    return silhouette_area(camera, table, invert_pose(pose) @ HERE, EVERYTHING, bounds)


def random_table(rng: np.random.Generator, spread_m: float, distance_m: float) -> ShapeTable:
    shapes = []
    for kind in KINDS:
        orientation = rng.normal(size=4)
        pose = pose_matrices(
            rng.normal(size=3) * spread_m + (distance_m, 0, 0), orientation / np.linalg.norm(orientation)
        )
        shapes.append(VisualShape(0, kind, tuple(rng.uniform(0.1, 0.4, 3)), pose, None))
    return make_shape_table(shapes)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_bounds_lie_around_the_drawn_silhouette_by_less_than_a_pixel(seed: int) -> None:
    camera = Pinhole(position_m=(0.0, 0.0, 0.0))
    table = random_table(np.random.default_rng(seed), 0.4, 4.0)
    view = cast(table, camera, camera.robot_from_camera, HERE, np.zeros(1, np.int64), ~EVERYTHING)
    bounds = bounds_of(table, camera, camera.robot_from_camera)
    assume(bounds[0] > 0 and bounds[1] > 0 and bounds[2] < 319 and bounds[3] < 239)
    v, u = np.nonzero(view.cover)
    drawn = (u.min(), v.min(), u.max(), v.max())
    gaps = np.array(drawn) - bounds
    assert np.all(gaps[:2] > -1e-6)
    assert np.all(gaps[2:] < 1e-6)
    # A box may end in a corner that no pixel's centre falls on.
    assert np.all(np.abs(gaps) < 2.5)
    assert np.median(np.abs(gaps)) < 1.0
    area = area_of(table, camera, camera.robot_from_camera)
    assert area == np.count_nonzero(view.cover)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_bounds_of_large_shapes_are_met_within_a_pixel(kind: ShapeKind) -> None:
    rng = np.random.default_rng(kind)
    camera = Pinhole(position_m=(0.0, 0.0, 0.0), width=1600, height=1200)
    for _ in range(10):
        orientation = rng.normal(size=4)
        pose = pose_matrices((4, 0.2, 0.1), orientation / np.linalg.norm(orientation))
        table = make_shape_table([VisualShape(0, kind, (0.9, 0.6, 0.7), pose, None)])
        view = cast(table, camera, camera.robot_from_camera, HERE, np.zeros(1, np.int64), ~EVERYTHING)
        bounds = bounds_of(table, camera, camera.robot_from_camera)
        v, u = np.nonzero(view.cover)
        sharp = 3.0 if kind == ShapeKind.BOX else 1.0
        np.testing.assert_allclose(bounds, (u.min(), v.min(), u.max(), v.max()), atol=sharp)


def test_bounds_and_area_do_not_change_when_a_camera_turns_the_shape_out_of_its_image() -> None:
    table = random_table(np.random.default_rng(1), 0.1, 4.0)
    wide = Pinhole(position_m=(0.0, 0.0, 0.0), width=960, height=720, vertical_fov_rad=2 * math.atan(0.9))
    narrow = Pinhole(position_m=(0.0, 0.0, 0.0), width=320, height=240, vertical_fov_rad=2 * math.atan(0.3))
    assert wide.focal_px == pytest.approx(narrow.focal_px)
    turned = Pinhole(yaw_rad=0.4, pitch_rad=0.3, position_m=(0.0, 0.0, 0.0)).robot_from_camera
    view = cast(table, wide, turned, HERE, np.zeros(1, np.int64), ~EVERYTHING)
    seen = cast(table, narrow, turned, HERE, np.zeros(1, np.int64), ~EVERYTHING)
    assert 0 < np.count_nonzero(seen.cover) < np.count_nonzero(view.cover)
    bounds = bounds_of(table, narrow, turned)
    expected = bounds_of(table, wide, turned)
    np.testing.assert_allclose(np.add(bounds, (320, 240, 320, 240)), expected)
    assert area_of(table, narrow, turned) == np.count_nonzero(view.cover)


def test_bounds_of_what_reaches_behind_the_camera_stop_at_the_near_plane() -> None:
    camera = Pinhole(position_m=(0.0, 0.0, 0.0))
    beam = VisualShape(0, ShapeKind.BOX, (10.0, 0.2, 0.2), pose_matrices((0, 1, 0), (0, 0, 0, 1)), None)
    bounds = bounds_of(make_shape_table([beam]), camera, camera.robot_from_camera)
    u, focal = camera.centre_px[0], camera.focal_px
    assert bounds[0] == pytest.approx(u - focal * 1.1 / 0.05)
    assert bounds[2] == pytest.approx(u - focal * 0.9 / 5.0)
    rod = VisualShape(
        0, ShapeKind.CAPSULE, (9.8, 0.1, 0.0), pose_matrices((0, 1, 0), (0, 0.5**0.5, 0, 0.5**0.5)), None
    )
    same = bounds_of(make_shape_table([rod]), camera, camera.robot_from_camera)
    np.testing.assert_allclose(same[0], bounds[0], rtol=0.02)


def test_nothing_in_front_of_the_camera_has_no_bounds_and_no_area() -> None:
    camera = Pinhole(position_m=(0.0, 0.0, 0.0))
    for kind in KINDS:
        table = make_shape_table(
            [VisualShape(0, kind, (1, 1, 1), pose_matrices((-3, 0, 0), (0, 0, 0, 1)), None)]
        )
        assert np.all(np.isnan(bounds_of(table, camera, camera.robot_from_camera)))
        assert area_of(table, camera, camera.robot_from_camera) == 0
