import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.physics.bullet import Bullet
from peopleboy.sim.physics.urdf import find_model
from peopleboy.sim.places.extent import mesh_extent
from peopleboy.sim.rendering.renderer import Scene, render
from peopleboy.sim.shapes.shape_table import as_given, make_shape_table
from peopleboy.sim.shapes.shapes import Shape, ShapeKind, load_triangles
from tests.helpers.calls.refused import refused


@pytest.mark.parametrize("ending", ["obj", "stl", "dae"])
def test_every_format_gives_the_triangles_that_were_written(ending: str, tmp_path: Path) -> None:
    file = tmp_path / f"box.{ending}"
    trimesh.creation.box(extents=(1.0, 2.0, 3.0)).export(file)
    triangles = load_triangles(file)
    assert triangles.shape == (12, 3, 3)
    a, b, c = np.moveaxis(triangles, 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=-1) / 2.0
    assert areas.sum() == pytest.approx(22.0)
    # The divergence theorem: outward faces give the volume.
    assert np.sum(a * np.cross(b, c)) / 6.0 == pytest.approx(6.0)
    assert not triangles.flags.writeable


@pytest.mark.parametrize("size", [(1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (-1.0, -1.0, -1.0), (-1.0, 1.0, -2.0)])
def test_a_mirrored_mesh_keeps_its_outside_outside(size: tuple[float, float, float], tmp_path: Path) -> None:
    file = tmp_path / "box.stl"
    trimesh.creation.box(extents=(1.0, 2.0, 3.0)).export(file)
    shape = as_given(Shape(kind=ShapeKind.MESH, size=size, mesh=file), 0)
    a, b, c = np.moveaxis(make_shape_table([shape]).triangles, 1, 0)
    assert np.sum(a * np.cross(b, c)) / 6.0 == pytest.approx(6.0 * abs(np.prod(size)))


@pytest.mark.parametrize("content", ["", "v 0 0 0\nv 1 0 0\n", "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n"])
def test_a_mesh_without_proper_triangles_is_refused(content: str, tmp_path: Path) -> None:
    file = tmp_path / "broken.obj"
    file.write_text(content)
    with refused(file):
        load_triangles(file)


@pytest.mark.parametrize("text", ["", "<COLLADA>", "solid"])
@pytest.mark.parametrize("ending", ["stl", "dae", "xyz"])
def test_a_file_that_is_no_mesh_is_refused(text: str, ending: str, tmp_path: Path) -> None:
    file = tmp_path / f"broken.{ending}"
    file.write_text(text)
    with refused(file):
        load_triangles(file)


@pytest.mark.parametrize("model", ["duck.dae", "racecar/meshes/cone.dae", "racecar/meshes/chassis.dae"])
def test_dae_files_have_the_size_that_tinyrenderer_gives_them(model: str) -> None:
    mesh = find_model(model)
    scale = 1.0 / float(np.abs(load_triangles(mesh)).max())
    shape = Shape(kind=ShapeKind.MESH, size=(scale, scale, scale), mesh=mesh)
    camera = Pinhole(position_m=(-4.0, 0.5, 1.5), pitch_rad=0.35)
    with Bullet() as bullet:
        bullet.add_part("mesh", [shape], solid=False)
        scene = Scene(
            renderer="raycast",
            physics=bullet,
            table=make_shape_table(bullet.visual_shapes()),
            world_from_part=bullet.part_poses(),
            person_of_part=np.array([-1]),
            hidden=bullet.hidden_parts(),
        )
        cast, drawn = (
            render(replace(scene, renderer=name), camera, camera.robot_from_camera)
            for name in ("raycast", "bullet")
        )
    assert np.mean(cast.part == 0) > 0.01
    assert np.mean(cast.part != drawn.part) < 1e-4


def test_a_mesh_in_centimetres_takes_up_the_room_that_it_is_drawn_with(tmp_path: Path) -> None:
    path = tmp_path / "box.dae"
    box = trimesh.creation.box((10.0, 20.0, 30.0))
    text = trimesh.exchange.dae.export_collada(box).decode("utf-8")
    centimetres = re.sub(
        r"<unit[^>]*/>|(?<=<asset>)", '<unit name="centimeter" meter="0.01"/>', text, count=1
    )
    path.write_text(centimetres, encoding="utf-8")
    np.testing.assert_allclose(mesh_extent(path), [[-0.05, -0.1, -0.15], [0.05, 0.1, 0.15]])


def test_without_trimesh_a_mesh_names_the_extra_that_brings_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(BadInput, match=r"peopleboy\[meshes\]"):
        load_triangles(tmp_path / "box.stl")
