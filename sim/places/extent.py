"""How much room fixtures take up: the upright box around shapes and around furniture from URDF files."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pybullet_data
import trimesh
from numpy.typing import NDArray

from bad_input import BadInput
from sim.places.place import Fixture
from sim.rotations import pose_matrices
from sim.shapes import Shape, ShapeKind

Extent = NDArray[np.float64]  # (2, 3) [m]: lowest and highest x, y, z

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


def fixture_extent(fixture: Fixture) -> Extent:
    """The box around a fixture in the world frame: exact for boxes, and never too small.

    Raises:
        BadInput: a URDF or a mesh cannot be read.
    """
    if fixture.part is not None:
        local = [_moved(shape_extent(s), s.position, s.orientation) for s in fixture.part.shapes]
    else:
        local = [urdf_extent(find_urdf(str(fixture.urdf))) * fixture.scale]
    world = [_moved(extent, fixture.position, fixture.orientation) for extent in local]
    return np.round(_around(np.concatenate(world)), 9)


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
    try:
        mesh = trimesh.load(path, force="mesh", skip_materials=True)
        return np.asarray(mesh.bounds, float).reshape(2, 3)
    except Exception as error:  # trimesh raises whatever its many loaders raise
        raise BadInput(f"mesh {path} cannot be read: {error}") from error


def find_urdf(name: str) -> Path:
    """Find a URDF as PyBullet does: an absolute path, or a name inside pybullet_data."""
    return Path(pybullet_data.getDataPath()) / name


@cache
def urdf_extent(path: Path) -> Extent:
    """The box around the base link of a URDF: furniture is one link.

    Raises:
        BadInput: the file is not a URDF with shapes, or names a mesh outside its own folder.
    """
    try:
        text = re.sub(r"<\?xml.*?\?>", "", path.read_text("utf-8"), count=1)
        root = ElementTree.fromstring(text)
    except (OSError, UnicodeDecodeError, ElementTree.ParseError) as error:
        raise BadInput(f"{path} cannot be read as a URDF: {error}") from error
    elements = [e for kind in ("visual", "collision") for e in root.iterfind(f"./link/{kind}")]
    extents = [_element_extent(path, element) for element in elements]
    if not extents or len(root.findall("./link")) != 1:
        raise BadInput(f"{path} is not furniture: it must be a URDF of one link with shapes")
    return _around(np.concatenate(extents))


def _element_extent(path: Path, element: ElementTree.Element) -> Extent:
    shape = element.find("./geometry/*")
    origin = element.find("origin")
    if shape is None:
        raise BadInput(f"{path} is not a URDF: a <{element.tag}> has no geometry")
    try:
        xyz = _numbers(origin, "xyz", "0 0 0")
        roll, pitch, yaw = _numbers(origin, "rpy", "0 0 0")
        return _moved(_geometry_extent(path, shape), xyz, _quaternion(roll, pitch, yaw))
    except (ValueError, TypeError) as error:
        raise BadInput(f"{path} is not a URDF: {error}") from error


def _geometry_extent(path: Path, shape: ElementTree.Element) -> Extent:
    if shape.tag == "mesh":
        name = Path(shape.get("filename", ""))
        if name.is_absolute() or ".." in name.parts:
            raise BadInput(f"{path}: mesh {str(name)!r} lies outside the file's folder")
        return mesh_extent(path.parent / name) * _numbers(shape, "scale", "1 1 1")
    if shape.tag == "box":
        size = _numbers(shape, "size", "")
    else:
        radius = float(shape.get("radius", ""))
        size = np.array([2.0 * radius, 2.0 * radius, float(shape.get("length", 2.0 * radius))])
    return np.array([-size, size]) / 2.0


def _numbers(element: ElementTree.Element | None, name: str, default: str) -> NDArray[np.float64]:
    text = default if element is None else element.get(name, default)
    numbers = np.array([float(word) for word in text.split()])
    if numbers.shape != (3,):
        raise ValueError(f"{name}={text!r} must be three numbers")
    return numbers


def _quaternion(roll: float, pitch: float, yaw: float) -> NDArray[np.float64]:
    """Turn the fixed-axis angles of a URDF [rad] into a quaternion x, y, z, w."""
    (sr, sp, sy), (cr, cp, cy) = (
        np.sin(np.divide((roll, pitch, yaw), 2)),
        np.cos(np.divide((roll, pitch, yaw), 2)),
    )
    return np.array(
        [
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        ]
    )


def _moved(extent: Extent, position: object, orientation: object) -> Extent:
    pose = pose_matrices(np.asarray(position, float), np.asarray(orientation, float))
    corners = extent[0] + _CORNERS * (extent[1] - extent[0])
    return _around(corners @ pose[:3, :3].T + pose[:3, 3])


def _around(points: NDArray[np.float64]) -> Extent:
    return np.array([points.min(axis=0), points.max(axis=0)])
