"""URDFs as other tools write them: paths of meshes, encodings, and macros."""

from pathlib import Path

import pytest

from peopleboy.sim.physics.urdf import read_urdf
from tests.helpers.calls.refused import refused

trimesh = pytest.importorskip("trimesh")


def urdf(folder: Path, mesh: str, head: str = "", encoding: str = "utf-8") -> Path:
    """Write a package `robot_desc` with a mesh, and a URDF deep inside that names the mesh."""
    meshes = folder / "robot_desc" / "meshes" / "visual"
    meshes.mkdir(parents=True)
    trimesh.creation.box(extents=(1.0, 2.0, 3.0)).export(meshes / "box.stl")
    path = folder / "robot_desc" / "urdf" / "deep" / "a" / "robot.urdf"
    path.parent.mkdir(parents=True)
    shape = f'<visual><geometry><mesh filename="{mesh}"/></geometry></visual>'
    path.write_text(f'{head}<robot name="a"><link name="base">{shape}</link></robot>', encoding=encoding)
    return path


@pytest.mark.parametrize(
    "mesh",
    [
        "package://robot_desc/meshes/visual/box.stl",
        "model://robot_desc/meshes/visual/box.stl",
        "../../../meshes/visual/box.stl",
        "file://../../../meshes/visual/box.stl",
        "file://{folder}/robot_desc/meshes/visual/box.stl",
        "file://localhost{folder}/robot_desc/meshes/visual/box.stl",
        "{folder}/robot_desc/meshes/visual/box.stl",
    ],
)
def test_meshes_are_found_by_every_usual_path(tmp_path: Path, mesh: str) -> None:
    (found,) = read_urdf(urdf(tmp_path, mesh.format(folder=tmp_path)))
    assert found.shape.mesh == (tmp_path / "robot_desc/meshes/visual/box.stl").resolve()


def test_a_file_in_latin_1_is_read(tmp_path: Path) -> None:
    head = '<?xml version="1.0" encoding="ISO-8859-1"?><!-- J\u00fcrgen -->'
    assert read_urdf(urdf(tmp_path, "package://robot_desc/meshes/visual/box.stl", head, "latin-1"))


@pytest.mark.parametrize(
    "text",
    [
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="w" value="1"/></robot>',
        '<robot><link name="b"><visual><geometry><box size="${w} 1 1"/></geometry></visual></link></robot>',
    ],
)
def test_a_xacro_that_is_not_expanded_is_named(tmp_path: Path, text: str) -> None:
    path = tmp_path / "robot.urdf.xacro"
    path.write_text(text)
    with refused("robot.urdf.xacro", "xacro that is not expanded", "`xacro robot.urdf.xacro`"):
        read_urdf(path)
