"""Conversions for PyBullet: shapes, camera matrices, depth images, and suppressed output."""

import contextlib
import ctypes
import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole, invert_pose
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
        # Otherwise a mesh is replaced by its convex hull, such as a table's space between the legs.
        arguments["planeNormals"] = [(0.0, 0.0, 1.0)] * len(shapes)  # otherwise planes do not collide
        arguments["flags"] = [_CONCAVE if shape.kind == ShapeKind.MESH else 0 for shape in shapes]
    return arguments


def visual_shape(row: Sequence[Any], part: int) -> VisualShape:
    """Read one row of PyBullet's getVisualShapeData."""
    kind = _KIND[row[2]]
    mesh = Path(row[4].decode()) if kind == ShapeKind.MESH else None
    return VisualShape(part, kind, tuple(row[3]), pose_matrices(row[5], row[6]), mesh)


# OpenGL's camera looks along -z with y up, the optical frame along z with y down.
_EYE_FROM_OPTICAL = np.diag([1.0, -1.0, -1.0, 1.0])


def view_matrix(world_from_camera: Matrix) -> list[float]:
    """16 numbers, column by column: eye from world."""
    return (_EYE_FROM_OPTICAL @ invert_pose(world_from_camera)).ravel(order="F").tolist()


def projection_matrix(camera: Pinhole, near_m: float, far_m: float) -> list[float]:
    """16 numbers, column by column: clip space from eye.

    TinyRenderer samples pixel (u, v) at -1 + 2 u / width, 1 - 2 (v + 1) / height: half a pixel left of and
    below the pixel's centre. The image is shifted by the same amount, so that it is sampled at the centres.
    """
    width, height = camera.width, camera.height
    matrix = np.zeros((4, 4))
    matrix[0, 0] = 2.0 * camera.focal_px / width
    matrix[1, 1] = 2.0 * camera.focal_px / height
    matrix[0, 2] = 1.0 / width
    matrix[1, 2] = 1.0 / height
    matrix[2, 2] = -(far_m + near_m) / (far_m - near_m)
    matrix[2, 3] = -2.0 * far_m * near_m / (far_m - near_m)
    matrix[3, 2] = -1.0
    return matrix.ravel(order="F").tolist()


def metric_depth(buffer: NDArray[np.float32], near_m: float, far_m: float) -> Matrix:
    """Depth along the optical axis [m] from a depth buffer that runs from 0 (near) to 1 (far)."""
    return far_m * near_m / (far_m - (far_m - near_m) * buffer.astype(np.float64))


# PyBullet's C code writes straight to the file descriptors, past `sys.stdout`.
_LIBC = ctypes.CDLL(None)


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Send everything written to file descriptors 1 and 2 inside the block to the null device.

    Descriptors that are closed stay closed; what was buffered before the block still appears.
    """
    _flush()
    with contextlib.ExitStack() as stack:
        for descriptor in (1, 2):
            stack.enter_context(_muted(descriptor))
        yield
        # Otherwise C's buffers would be flushed after the descriptors are restored.
        _flush()


@contextlib.contextmanager
def _muted(descriptor: int) -> Iterator[None]:
    try:
        saved = os.dup(descriptor)
    except OSError:
        yield
        return
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, descriptor)
    os.close(null)
    try:
        yield
    finally:
        os.dup2(saved, descriptor)
        os.close(saved)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            with contextlib.suppress(OSError, ValueError):
                stream.flush()
    _LIBC.fflush(None)
