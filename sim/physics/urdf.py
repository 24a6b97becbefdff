"""What is to be seen of a URDF file: the shapes of all its links, in the frame of its root link."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from peopleboy.bad_input import BadInput
from peopleboy.sim.physics.model_files import data_folder
from peopleboy.sim.shapes.shapes import Quaternion, Shape, ShapeKind, Vector

# Where PyBullet looks for what a URDF names, from the URDF's own folder.
MESH_PLACES = (".", "..", "../..")
_GREY = (0.5, 0.5, 0.5)

Numbers = NDArray[np.float64]
Joints = dict[str, ElementTree.Element]  # by the link that hangs on it


@dataclass(frozen=True, slots=True)
class UrdfShape:
    """One visible shape of a URDF.

    Attributes:
        shape: where it is with all joints at zero, in the root link's frame.
        rgb: red, green, blue in 0..1 as the file has it; grey where it says nothing.
    """

    shape: Shape
    rgb: tuple[float, float, float]


def find_urdf(name: str) -> Path:
    """Find a URDF as PyBullet does: an absolute path, or a name inside pybullet_data.

    Raises:
        BadInput: it is a name, and PyBullet is not installed.
    """
    return Path(name) if Path(name).is_absolute() else data_folder() / name


@cache
def read_urdf(path: Path) -> tuple[UrdfShape, ...]:
    """Read the visible shapes of all links, in the file's order.

    Raises:
        BadInput: the file is no URDF, or has a shape or a number that cannot be read.
    """
    root = parse_urdf(path)
    joints = {link_named(joint, "child"): joint for joint in root.iterfind("./joint")}
    colours = {m.get("name", ""): _rgb(m) for m in root.iterfind("./material") if m.find("color") is not None}
    try:
        return tuple(
            _read_visual(visual, link_pose(link.get("name", ""), joints), colours, path)
            for link in root.iterfind("./link")
            for visual in link.findall("./visual") or link.findall("./collision")  # as PyBullet shows it
        )
    except (KeyError, ValueError, RecursionError) as error:
        raise BadInput(f"{path} cannot be read as a URDF: {error}") from error


def mesh_files(path: Path) -> Iterator[str]:
    """Yield the mesh files that a URDF names, as it names them.

    Raises:
        BadInput: the file is no XML.
    """
    for mesh in parse_urdf(path).iter("mesh"):
        yield mesh.get("filename", "")


def parse_urdf(path: Path) -> ElementTree.Element:
    """Read a file as XML.

    Raises:
        BadInput: it cannot be read, or is none.
    """
    try:
        # A declaration may claim an encoding that is not the file's.
        return ElementTree.fromstring(re.sub(r"<\?xml.*?\?>", "", path.read_text("utf-8"), count=1))
    except (OSError, UnicodeDecodeError, ElementTree.ParseError) as error:
        raise BadInput(f"{path} cannot be read as a URDF: {error}") from error


def link_pose(link: str, joints: Joints) -> tuple[Numbers, Rotation]:
    """Where a link is in the root link's frame: position and rotation."""
    if link not in joints:
        return np.zeros(3), Rotation.identity()
    position, turn = link_pose(link_named(joints[link], "parent"), joints)
    offset, rotation = _origin(joints[link])
    return position + turn.apply(offset), turn * rotation


def _read_visual(
    visual: ElementTree.Element,
    link: tuple[Numbers, Rotation],
    colours: dict[str, tuple[float, float, float]],
    path: Path,
) -> UrdfShape:
    material = visual.find("material")
    shape = read_shape(visual, link, path)
    if material is None:
        return UrdfShape(shape, _GREY)
    named = colours.get(material.get("name", ""), _GREY)
    return UrdfShape(shape, _rgb(material) if material.find("color") is not None else named)


def read_shape(element: ElementTree.Element, link: tuple[Numbers, Rotation], path: Path) -> Shape:
    """Read a visual or a collision of a link, whose position and rotation are given."""
    offset, rotation = _origin(element)
    kind, size, mesh = _read_geometry(element, path)
    return Shape(
        kind=kind,
        size=size,
        position=_vector(link[0] + link[1].apply(offset)),
        orientation=_quaternion(link[1] * rotation),
        mesh=mesh,
    )


def _read_geometry(visual: ElementTree.Element, path: Path) -> tuple[ShapeKind, Vector, Path | None]:
    geometry = visual.find("./geometry/*")
    if geometry is None:
        raise ValueError("a visual without a geometry")
    tag = geometry.tag
    if tag == "mesh":
        return ShapeKind.MESH, _scale(geometry), _find_mesh(path, geometry.get("filename", ""))
    if tag == "box":
        return ShapeKind.BOX, _vector(read_numbers(geometry.attrib["size"])), None
    if tag == "sphere":
        return ShapeKind.SPHERE, (float(geometry.attrib["radius"]), 0.0, 0.0), None
    if tag == "plane":
        return ShapeKind.PLANE, (0.0, 0.0, 0.0), None
    kind = {"cylinder": ShapeKind.CYLINDER, "capsule": ShapeKind.CAPSULE}[tag]
    return kind, (float(geometry.attrib["length"]), float(geometry.attrib["radius"]), 0.0), None


def _scale(mesh: ElementTree.Element) -> Vector:
    factors = read_numbers(mesh.get("scale", "1 1 1"))
    return _vector(np.broadcast_to(factors, 3) if len(factors) == 1 else factors)


def _find_mesh(urdf: Path, name: str) -> Path:
    places = [urdf.parent / place / name.removeprefix("package://") for place in MESH_PLACES]
    found = [place.resolve() for place in places if place.is_file()]
    if not found:
        raise ValueError(f"there is no mesh {name!r}")
    return found[0]


def _origin(element: ElementTree.Element) -> tuple[Numbers, Rotation]:
    origin = element.find("origin")
    if origin is None:
        return np.zeros(3), Rotation.identity()
    turn = Rotation.from_euler("xyz", read_numbers(origin.get("rpy", "0 0 0"))[:3])
    return read_numbers(origin.get("xyz", "0 0 0"))[:3], turn


def link_named(joint: ElementTree.Element, tag: str) -> str:
    """Name the parent or the child of a joint."""
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")


def _rgb(material: ElementTree.Element) -> tuple[float, float, float]:
    colour = material.find("color")
    return _vector(read_numbers("0.5 0.5 0.5" if colour is None else colour.get("rgba", "")))


def read_numbers(text: str) -> Numbers:
    """Read numbers as PyBullet does, which takes commas for spaces."""
    return np.array([float(word) for word in text.replace(",", " ").split()])


def _vector(numbers: Numbers) -> Vector:
    x, y, z = (float(number) for number in numbers[:3])
    return x, y, z


def _quaternion(rotation: Rotation) -> Quaternion:
    x, y, z, w = (float(number) for number in rotation.as_quat())
    return x, y, z, w
