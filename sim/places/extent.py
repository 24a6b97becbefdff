"""How much room fixtures take up: the upright box around shapes and around furniture from URDF files."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.model_files import data_folder, is_in_data
from peopleboy.sim.physics.urdf import find_urdf, mesh_files, read_urdf
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.shapes import Shape, ShapeKind, load_triangles

Extent = NDArray[np.float64]  # (2, 3) [m]: lowest and highest x, y, z

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


def fixture_extent(fixture: Fixture) -> Extent:
    """The box around a fixture in the world frame: exact for boxes, and never too small.

    Raises:
        BadInput: a URDF or a mesh cannot be read.
    """
    world = [_moved(extent, fixture.position, fixture.orientation) for extent in shape_extents(fixture)]
    return np.round(_around(np.concatenate(world)), 9)


def shape_extents(fixture: Fixture) -> list[Extent]:
    """The boxes around each shape of a fixture, in the fixture's own frame; a URDF is a single one.

    Raises:
        BadInput: a URDF or a mesh cannot be read.
    """
    if fixture.part is not None:
        return [_moved(shape_extent(s), s.position, s.orientation) for s in fixture.part.shapes]
    return [urdf_extent(find_urdf(str(fixture.urdf))) * fixture.scale]


def shape_extent(shape: Shape) -> Extent:
    """The box around a shape in its own frame.

    Raises:
        BadInput: a plane has no extent, or a mesh cannot be read.
    """
    a, b, _ = shape.size
    if shape.kind == ShapeKind.MESH:
        scaled: Extent = mesh_extent(Path(str(shape.mesh))) * np.array(shape.size)
        return scaled
    if shape.kind == ShapeKind.PLANE:
        raise BadInput("a plane has no extent; use a box")
    half = {
        ShapeKind.SPHERE: (a, a, a),
        ShapeKind.CAPSULE: (b, b, a / 2.0 + b),
        ShapeKind.CYLINDER: (b, b, a / 2.0),
        ShapeKind.BOX: tuple(side / 2.0 for side in shape.size),
    }[shape.kind]
    return np.array([half, half]) * [[-1.0], [1.0]]


@cache
def mesh_extent(path: Path) -> Extent:
    """The box around a mesh file.

    Raises:
        BadInput: the file cannot be read as a mesh.
    """
    corners = load_triangles(path).reshape(-1, 3)
    return np.stack([corners.min(axis=0), corners.max(axis=0)])


@cache
def urdf_extent(path: Path) -> Extent:
    """The box around everything that is seen of a URDF, all links in their rest pose.

    Raises:
        BadInput: the file is not a URDF with shapes, or names a mesh outside its own folder.
    """
    _check_meshes(path)
    shapes = [visible.shape for visible in read_urdf(path)]
    if not shapes:
        raise BadInput(f"{path} is not furniture: it has no visible shapes")
    return _around(np.concatenate([_moved(shape_extent(s), s.position, s.orientation) for s in shapes]))


def _check_meshes(path: Path) -> None:
    """Refuse meshes that lie outside the file's folder, or outside pybullet_data if the file is of there."""
    home = data_folder() if is_in_data(path) else path.parent
    for name in mesh_files(path):
        if not (path.parent / name).resolve().is_relative_to(home.resolve()):
            raise BadInput(f"{path}: mesh {name!r} lies outside the file's folder")


def _moved(extent: Extent, position: object, orientation: object) -> Extent:
    return _placed(extent, pose_matrices(np.asarray(position, float), np.asarray(orientation, float)))


def _placed(extent: Extent, pose: NDArray[np.float64]) -> Extent:
    corners = extent[0] + _CORNERS * (extent[1] - extent[0])
    return _around(corners @ pose[:3, :3].T + pose[:3, 3])


def _around(points: NDArray[np.float64]) -> Extent:
    return np.array([points.min(axis=0), points.max(axis=0)])
