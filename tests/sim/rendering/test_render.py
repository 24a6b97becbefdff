"""Both renderers against each other.

TinyRenderer replaces spheres and capsules by polyhedra whose faces lie up to 5 % of the radius within the
true surface. Radii are kept below a sixtieth of the distance (5 pixels), so that its outlines are off by less
than a pixel and its depths by less than 1 %. Boxes, meshes and walls, which it draws as they are, may be of
any size.
"""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.rendering.render import render
from peopleboy.sim.rendering.view import View
from peopleboy.sim.shapes.shape_table import make_shape_table
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


def both(bullet: Bullet, camera: Pinhole, people: NDArray[np.int64]) -> tuple[View, View]:
    table = make_shape_table(bullet.visual_shapes())
    poses, hidden = bullet.part_poses(), bullet.hidden_parts()
    pose = camera.robot_from_camera
    cast, drawn = (
        render(name, bullet, table, camera, pose, poses, people, hidden) for name in ("raycast", "bullet")
    )
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
        table = make_shape_table(bullet.visual_shapes())
        camera, people = Pinhole(), np.array([person])
        pose, poses, hidden = camera.robot_from_camera, bullet.part_poses(), bullet.hidden_parts()
        with refused(*named):
            render(name, bullet, table, camera, pose, poses, people, hidden)
