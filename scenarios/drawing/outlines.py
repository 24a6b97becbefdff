"""What a thing covers on the floor, seen from above."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.places.extent import fixture_extent, shape_extent
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.shapes import Shape, ShapeKind

Polygon = NDArray[np.float64]  # (N, 2) [m] corners, world frame

_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)


def outlines(fixture: Fixture) -> list[Polygon]:
    """Outline every shape of a fixture from above; furniture from a file by the box around it."""
    if fixture.part is None:
        low, high = fixture_extent(fixture)[:, :2]
        return [np.array([low, [high[0], low[1]], high, [low[0], high[1]]])]
    world = pose_matrices(fixture.position, fixture.orientation)
    return [_hull(_surface_points(shape) @ world[:3, :3].T + world[:3, 3]) for shape in fixture.part.shapes]


def _surface_points(shape: Shape) -> NDArray[np.float64]:
    """Points (N, 3) of a shape's surface in its part's frame, whose hull is the shape or nearly so."""
    low, high = shape_extent(shape)
    points = low + _CORNERS * (high - low)
    if shape.kind in (ShapeKind.CYLINDER, ShapeKind.SPHERE, ShapeKind.CAPSULE):
        ring = np.stack(
            [high[0] * np.cos(_CIRCLE), high[1] * np.sin(_CIRCLE), np.zeros_like(_CIRCLE)], axis=1
        )
        heights = (0.0,) if shape.kind == ShapeKind.SPHERE else (low[2], high[2])
        points = np.concatenate([ring + np.array([0.0, 0.0, z]) for z in heights])
    pose = pose_matrices(shape.position, shape.orientation)
    return np.asarray(points @ pose[:3, :3].T + pose[:3, 3])


def _hull(points: NDArray[np.float64]) -> Polygon:
    flat = np.unique(np.round(points[:, :2], 6), axis=0)
    return np.asarray(flat[ConvexHull(flat).vertices])
