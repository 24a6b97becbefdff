"""What stands in a world and what the robot is made of, as simple solids to draw."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from scipy.spatial.transform import Rotation

from peopleboy.scenarios.drawing.palette import Rgb
from peopleboy.sim.places.extent import fixture_extent, shape_extent
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.materials import Material
from peopleboy.sim.shapes.shapes import UPRIGHT, Quaternion, Shape, ShapeKind, Vector


@dataclass(frozen=True, slots=True, kw_only=True)
class Solid:
    """A box, cylinder or ball.

    Attributes:
        kind: BOX, CYLINDER or SPHERE, with sizes as in `Shape`.
        size: [m].
        position, orientation: in the frame that the solid is drawn in; x, y, z, w.
        colour: sRGB.
    """

    kind: ShapeKind
    size: Vector
    position: Vector
    orientation: Quaternion
    colour: Rgb


def group_fixtures(fixtures: Iterable[Fixture]) -> dict[str, list[Fixture]]:
    """Sort fixtures into floor, ceiling, walls and things, which are shown or hidden together."""
    groups: dict[str, list[Fixture]] = {}
    for fixture in fixtures:
        kind = fixture.name.replace("/", "_").split("_")[0]
        group = {"floor": "floor", "ceiling": "ceiling", "wall": "walls", "door": "walls"}.get(kind, "things")
        groups.setdefault(group, []).append(fixture)
    return groups


def fixture_solids(fixture: Fixture) -> Iterator[Solid]:
    """Give a fixture's solids in the world frame; a URDF and a mesh become the boxes around them."""
    if fixture.part is None:
        (low, high), material = fixture_extent(fixture), fixture.material
        yield _box((low + high) / 2.0, high - low, _srgb(material))
        return
    turn = Rotation.from_quat(fixture.orientation)
    for shape in fixture.part.shapes:
        if shape.kind is ShapeKind.PLANE:
            continue
        kind, size, position = _simplify(shape)
        yield Solid(
            kind=kind,
            size=size,
            position=_vector(turn.apply(position) + fixture.position),
            orientation=_quaternion(turn * Rotation.from_quat(shape.orientation)),
            colour=_srgb(fixture.part.material),
        )


def urdf_solids(path: Path) -> list[Solid]:
    """Read the visual shapes of a URDF, in the frame of its root link, all joints at zero."""
    root = ElementTree.parse(path).getroot()
    colours = {m.get("name", ""): _material_colour(m) for m in root.iterfind("./material")}
    joints = {_named(joint, "child"): joint for joint in root.iterfind("./joint")}
    return [
        _visual_solid(visual, _link_pose(link.get("name", ""), joints), colours)
        for link in root.iterfind("./link")
        for visual in link.iterfind("./visual")
    ]


_Pose = tuple[np.ndarray[tuple[int], np.dtype[np.float64]], Rotation]


def _link_pose(link: str, joints: dict[str, ElementTree.Element]) -> _Pose:
    """Where a link is in the root link's frame: position and rotation."""
    if link not in joints:
        return np.zeros(3), Rotation.identity()
    position, turn = _link_pose(_named(joints[link], "parent"), joints)
    offset, rotation = _origin(joints[link])
    return position + turn.apply(offset), turn * rotation


def _visual_solid(visual: ElementTree.Element, link: _Pose, colours: dict[str, Rgb]) -> Solid:
    offset, rotation = _origin(visual)
    geometry = next(iter(visual.iterfind("./geometry/*")))
    material = visual.find("material")
    kind = {"box": ShapeKind.BOX, "cylinder": ShapeKind.CYLINDER, "sphere": ShapeKind.SPHERE}[geometry.tag]
    size = _numbers(geometry.get("size") or f"{geometry.get('length', 0)} {geometry.get('radius')} 0")
    if kind is ShapeKind.SPHERE:
        size = np.array([size[1], 0.0, 0.0])
    return Solid(
        kind=kind,
        size=_vector(size),
        position=_vector(link[0] + link[1].apply(offset)),
        orientation=_quaternion(link[1] * rotation),
        colour=(128, 128, 128) if material is None else colours[material.get("name", "")],
    )


def _simplify(shape: Shape) -> tuple[ShapeKind, Vector, Vector]:
    """Make a mesh a box, a capsule a cylinder: give kind, size and position in the part's frame."""
    if shape.kind is ShapeKind.CAPSULE:
        length, radius, _ = shape.size
        return ShapeKind.CYLINDER, (length + 2.0 * radius, radius, 0.0), shape.position
    if shape.kind is not ShapeKind.MESH:
        return shape.kind, shape.size, shape.position
    low, high = shape_extent(shape)
    middle = Rotation.from_quat(shape.orientation).apply((low + high) / 2.0)
    return ShapeKind.BOX, _vector(high - low), _vector(np.array(shape.position) + middle)


def _box(centre: np.ndarray, size: np.ndarray, colour: Rgb) -> Solid:
    return Solid(
        kind=ShapeKind.BOX, size=_vector(size), position=_vector(centre), orientation=UPRIGHT, colour=colour
    )


def _srgb(material: Material | None) -> Rgb:
    """Encode a look's linear reflectance for the screen."""
    red, green, blue = (0.5, 0.5, 0.5) if material is None else material.rgb
    return _byte(red ** (1 / 2.2)), _byte(green ** (1 / 2.2)), _byte(blue ** (1 / 2.2))


def _material_colour(material: ElementTree.Element) -> Rgb:
    colour = material.find("color")
    red, green, blue = _numbers("0.5 0.5 0.5 1" if colour is None else colour.get("rgba", ""))[:3]
    return _byte(red), _byte(green), _byte(blue)


def _byte(share: float) -> int:
    return round(255 * min(max(float(share), 0.0), 1.0))


def _named(joint: ElementTree.Element, tag: str) -> str:
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")


def _origin(element: ElementTree.Element) -> _Pose:
    origin = element.find("origin")
    if origin is None:
        return np.zeros(3), Rotation.identity()
    turn = Rotation.from_euler("xyz", _numbers(origin.get("rpy", "0 0 0")))
    return _numbers(origin.get("xyz", "0 0 0")), turn


def _numbers(text: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.array([float(word) for word in text.split()])


def _vector(numbers: np.ndarray) -> Vector:
    x, y, z = (float(number) for number in numbers)
    return x, y, z


def _quaternion(rotation: Rotation) -> Quaternion:
    x, y, z, w = (float(number) for number in rotation.as_quat())
    return x, y, z, w
