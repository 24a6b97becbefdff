"""Primitive shapes, grouped into parts that share a pose and an appearance."""

from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.sim.shapes.materials import Material

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

UPRIGHT: Quaternion = (0.0, 0.0, 0.0, 1.0)


class ShapeKind(IntEnum):
    """The primitive shapes that both renderers support, and skins, which only the ray caster draws."""

    SPHERE = 0
    CAPSULE = 1
    CYLINDER = 2
    BOX = 3
    PLANE = 4
    MESH = 5
    SKIN = 6  # see `skins`


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """One primitive, placed in the frame of its part.

    Attributes:
        kind: kind of primitive.
        size: [m] sphere (radius, 0, 0); capsule and cylinder (length along z, radius, 0), the capsule's
            length without its caps; box (x, y, z) full extents; plane (0, 0, 0), it is z = 0 and
            infinite, seen from above; mesh (x, y, z) scale, no unit.
        position: [m] origin of the shape in the part's frame.
        orientation: x, y, z, w quaternion, part from shape.
        mesh: OBJ, STL or DAE file of a mesh; None otherwise.
        is_stand_in: whether it stands in for a skin, where skins are not drawn.
    """

    kind: ShapeKind
    size: Vector
    position: Vector = (0.0, 0.0, 0.0)
    orientation: Quaternion = UPRIGHT
    mesh: Path | None = None
    is_stand_in: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """Shapes with a common pose and material, such as a forearm, a wall or a robot's wheel.

    Attributes:
        name: unique within its owner, such as "left_forearm".
        shapes: shapes of the part; they may overlap.
        material: material for all cameras.
    """

    name: str
    shapes: tuple[Shape, ...]
    material: Material


# Triangle meshes from files.


@cache
def load_triangles(path: Path) -> NDArray[np.float64]:
    """Read an OBJ, STL or DAE file: (T, 3, 3) corners of its triangles, in the file's frame, read-only.

    Like PyBullet, it applies the unit of length of a DAE file and ignores its up axis. Unlike PyBullet, it
    applies the rotations in a DAE file, so TinyRenderer draws the few files with rotations differently.

    Raises:
        BadInput: the file does not exist, cannot be read, or contains no triangles, or trimesh is not
            installed.
    """
    try:
        import trimesh  # imported late: loading takes a second, and most worlds have no meshes
    except ImportError as error:
        raise BadInput(f"mesh {path}: reading it needs trimesh: pip install 'peopleboy[meshes]'") from error
    try:
        mesh: Any = trimesh.load(path, force="mesh", process=False, skip_materials=True)
        triangles = np.array(mesh.triangles, np.float64) * _unit_m(path)
    # Each of the parsers of trimesh raises different errors.
    except Exception as error:
        reason = " ".join(str(error).split())
        raise BadInput(f"mesh {path}: cannot be read ({reason}); use an OBJ, STL or DAE file") from error
    if len(triangles) == 0 or not np.isfinite(triangles).all():
        raise BadInput(f"mesh {path}: contains no triangles, or coordinates that are not finite")
    triangles.setflags(write=False)
    return triangles


def _unit_m(path: Path) -> float:
    """Return the unit of length [m] of a mesh file; only DAE files specify one."""
    unit = ElementTree.parse(path).find("{*}asset/{*}unit") if path.suffix.lower() == ".dae" else None
    return 1.0 if unit is None else float(unit.get("meter", "1"))
