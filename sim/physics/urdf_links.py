"""The links of a URDF file as physics needs them: where they hang, what is solid of them, what they weigh."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from peopleboy.bad_input import BadInput
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.physics.urdf import Joints, link_named, link_pose, parse_urdf, read_numbers, read_shape
from peopleboy.sim.shapes.shapes import Shape

_HERE = (np.zeros(3), Rotation.identity())


@dataclass(frozen=True, slots=True, eq=False)
class UrdfLink:
    """One link with all joints at zero.

    Attributes:
        name: its own.
        joint: name of the joint on which it hangs; empty for the root.
        turns: whether that joint turns without end, as a wheel's does.
        base_from_link: (4, 4) in the root link's frame.
        visible, solid: what is seen of it, and what others bump into, in its own frame.
        mass_kg: [kg].
        centre_m: (3,) [m] of mass, in its own frame.
        inertia_kg_m2: [kg m2] about the vertical through that centre.
    """

    name: str
    joint: str
    turns: bool
    base_from_link: Matrix
    visible: tuple[Shape, ...]
    solid: tuple[Shape, ...]
    mass_kg: float
    centre_m: Matrix
    inertia_kg_m2: float


def read_links(path: Path, scale: float = 1.0) -> tuple[UrdfLink, ...]:
    """Read all links, the root first, each before what hangs on it, all lengths times a factor.

    Raises:
        BadInput: the file is no URDF, or has a shape or a number that cannot be read.
    """
    return tuple(_scaled(link, scale) for link in _read_links(path))


@cache
def _read_links(path: Path) -> tuple[UrdfLink, ...]:
    root = parse_urdf(path)
    joints = {link_named(joint, "child"): joint for joint in root.iterfind("./joint")}
    links = {link.get("name", ""): link for link in root.iterfind("./link")}
    try:
        first = next(name for name in links if name not in joints)
        return tuple(_read_link(links[name], joints, path) for name in _in_order(first, joints))
    except (KeyError, ValueError, RecursionError, StopIteration) as error:
        raise BadInput(f"{path} cannot be read as a URDF: {error}") from error


def _in_order(name: str, joints: Joints) -> list[str]:
    children = [child for child, joint in joints.items() if link_named(joint, "parent") == name]
    return [name, *(below for child in children for below in _in_order(child, joints))]


def _read_link(link: ElementTree.Element, joints: Joints, path: Path) -> UrdfLink:
    name = link.get("name", "")
    joint = joints.get(name)
    position, rotation = link_pose(name, joints)
    base_from_link = np.eye(4)
    base_from_link[:3, :3], base_from_link[:3, 3] = rotation.as_matrix(), position
    solid = link.findall("./collision")
    centre = link.find("./inertial/origin")
    return UrdfLink(
        name=name,
        joint="" if joint is None else joint.get("name", ""),
        turns=joint is not None and joint.get("type") == "continuous",
        base_from_link=base_from_link,
        visible=tuple(read_shape(each, _HERE, path) for each in link.findall("./visual") or solid),
        solid=tuple(read_shape(each, _HERE, path) for each in solid),
        mass_kg=_number(link, "./inertial/mass", "value"),
        centre_m=np.zeros(3) if centre is None else read_numbers(centre.get("xyz", "0 0 0")),
        inertia_kg_m2=_number(link, "./inertial/inertia", "izz"),
    )


def _number(link: ElementTree.Element, where: str, key: str) -> float:
    found = link.find(where)
    return 0.0 if found is None else float(found.get(key, "0"))


def _scaled(link: UrdfLink, scale: float) -> UrdfLink:
    if scale == 1.0:
        return link
    pose = link.base_from_link.copy()
    pose[:3, 3] *= scale
    return replace(
        link,
        base_from_link=pose,
        visible=tuple(_scaled_shape(shape, scale) for shape in link.visible),
        solid=tuple(_scaled_shape(shape, scale) for shape in link.solid),
        centre_m=scale * link.centre_m,
    )


def _scaled_shape(shape: Shape, scale: float) -> Shape:
    a, b, c = shape.size
    x, y, z = shape.position
    return replace(shape, size=(scale * a, scale * b, scale * c), position=(scale * x, scale * y, scale * z))
