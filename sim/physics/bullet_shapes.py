"""Shapes as PyBullet's functions take them and give them back."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.shapes.shape_table import VisualShape
from peopleboy.sim.shapes.shapes import Shape, ShapeKind

# PyBullet's GEOM_ numbers.
_GEOMETRY = {
    ShapeKind.SPHERE: 2,
    ShapeKind.BOX: 3,
    ShapeKind.CYLINDER: 4,
    ShapeKind.MESH: 5,
    ShapeKind.PLANE: 6,
    ShapeKind.CAPSULE: 7,
}
_KIND = {geometry: kind for kind, geometry in _GEOMETRY.items()}
_CONCAVE = 1  # GEOM_FORCE_CONCAVE_TRIMESH


def shape_arguments(shapes: Sequence[Shape], prefix: str) -> dict[str, list[Any]]:
    """Arguments of PyBullet's createVisualShapeArray and createCollisionShapeArray."""
    round_along_z = (ShapeKind.CAPSULE, ShapeKind.CYLINDER)
    arguments: dict[str, list[Any]] = {
        "shapeTypes": [_GEOMETRY[shape.kind] for shape in shapes],
        "radii": [shape.size[shape.kind in round_along_z] for shape in shapes],
        "lengths": [shape.size[0] for shape in shapes],
        "halfExtents": [[extent / 2.0 for extent in shape.size] for shape in shapes],
        "fileNames": [str(shape.mesh) if shape.mesh else "" for shape in shapes],
        "meshScales": [shape.size for shape in shapes],
        f"{prefix}FramePositions": [shape.position for shape in shapes],
        f"{prefix}FrameOrientations": [shape.orientation for shape in shapes],
    }
    if prefix == "collision":
        # Without this a mesh would be solid in all its hollows, such as a table's between the legs.
        arguments["planeNormals"] = [(0.0, 0.0, 1.0)] * len(shapes)  # or planes are met by nothing
        arguments["flags"] = [_CONCAVE if shape.kind == ShapeKind.MESH else 0 for shape in shapes]
    return arguments


def visual_shape(row: Sequence[Any], part: int) -> VisualShape:
    """Read one row of PyBullet's getVisualShapeData."""
    kind = _KIND[row[2]]
    mesh = Path(row[4].decode()) if kind == ShapeKind.MESH else None
    return VisualShape(part, kind, tuple(row[3]), pose_matrices(row[5], row[6]), mesh)
