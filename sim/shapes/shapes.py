"""What things are made of: primitive shapes, grouped into parts that share a pose and a look."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

from peopleboy.sim.shapes.materials import Material

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

UPRIGHT: Quaternion = (0.0, 0.0, 0.0, 1.0)


class ShapeKind(IntEnum):
    """The primitive shapes that both renderers draw."""

    SPHERE = 0
    CAPSULE = 1
    CYLINDER = 2
    BOX = 3
    PLANE = 4
    MESH = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """One primitive, placed in the frame of its part.

    Attributes:
        kind: which primitive.
        size: [m] sphere (radius, 0, 0); capsule and cylinder (length along z, radius, 0), the capsule's
            length without its caps; box (x, y, z) full extents; plane (0, 0, 0), it is z = 0 and
            infinite, seen from above; mesh (x, y, z) scale, no unit.
        position: [m] origin of the shape in the part's frame.
        orientation: x, y, z, w quaternion, part from shape.
        mesh: OBJ, STL or DAE file of a mesh; None otherwise.
    """

    kind: ShapeKind
    size: Vector
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = UPRIGHT
    mesh: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Shapes that move as one and look alike, such as a forearm, a wall or a robot's wheel.

    Attributes:
        name: unique within its owner, such as "left_forearm".
        shapes: what it is made of; they may overlap.
        material: how both cameras see it.
    """

    name: str
    shapes: tuple[Shape, ...]
    material: Material
