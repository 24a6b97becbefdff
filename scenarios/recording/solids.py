"""What stands in a world and what the robot is made of, as simple solids to draw."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from peopleboy.scenarios.drawing.palette import Rgb
from peopleboy.sim.physics.urdf import read_urdf
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
    """Give what is to be seen of a URDF, in the frame of its root link, all joints at zero."""
    return [
        Solid(
            kind=kind,
            size=size,
            position=position,
            orientation=visible.shape.orientation,
            colour=_bytes(visible.rgb),
        )
        for visible in read_urdf(path)
        for kind, size, position in [_simplify(visible.shape)]
    ]


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
    return _bytes((red ** (1 / 2.2), green ** (1 / 2.2), blue ** (1 / 2.2)))


def _bytes(shares: tuple[float, float, float]) -> Rgb:
    red, green, blue = (round(255 * min(max(share, 0.0), 1.0)) for share in shares)
    return red, green, blue


def _vector(numbers: np.ndarray) -> Vector:
    x, y, z = (float(number) for number in numbers)
    return x, y, z


def _quaternion(rotation: Rotation) -> Quaternion:
    x, y, z, w = (float(number) for number in rotation.as_quat())
    return x, y, z, w
