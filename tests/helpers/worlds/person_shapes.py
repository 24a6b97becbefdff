"""How deep points lie within a person's shapes, computed one shape at a time."""

import numpy as np
from scipy.spatial.transform import Rotation

from peopleboy.sim.shapes.shapes import Shape, ShapeKind


def depth_inside(shape: Shape, points: np.ndarray) -> np.ndarray:
    """(N,) [m] depth of points of the part's frame below the shape's surface; negative outside."""
    local = Rotation.from_quat(shape.orientation).inv().apply(points - np.array(shape.position))
    if shape.kind == ShapeKind.SPHERE:
        return shape.size[0] - np.linalg.norm(local, axis=-1)
    if shape.kind == ShapeKind.CAPSULE:
        length, radius, _ = shape.size
        local[:, 2] -= np.clip(local[:, 2], -length / 2, length / 2)
        return radius - np.linalg.norm(local, axis=-1)
    if shape.kind == ShapeKind.CYLINDER:
        length, radius, _ = shape.size
        return np.minimum(length / 2 - np.abs(local[:, 2]), radius - np.linalg.norm(local[:, :2], axis=-1))
    assert shape.kind == ShapeKind.BOX
    return (np.array(shape.size) / 2 - np.abs(local)).min(axis=-1)


def person_depth(person, points, parts=None):
    """(N,) [m] depth of world points in the deepest of a person's shapes."""
    depths = []
    for part, pose in zip(person.model.parts, person.poses(), strict=True):
        if parts is None or part.name in parts:
            local = (points - pose[:3, 3]) @ pose[:3, :3]
            depths += [depth_inside(shape, local) for shape in part.shapes]
    return np.max(depths, axis=0)


def surface_points(shape: Shape, count: int = 12) -> np.ndarray:
    """(N, 3) [m] points on the surface of a sphere, capsule, cylinder or box, in the part's frame."""
    angles = np.linspace(0, 2 * np.pi, 2 * count, endpoint=False)
    heights = np.linspace(-1, 1, 2 * count + 1)
    a, z = (g.ravel() for g in np.meshgrid(angles, heights))
    ball = np.stack([np.sqrt(1 - z**2) * np.cos(a), np.sqrt(1 - z**2) * np.sin(a), z], axis=-1)
    if shape.kind == ShapeKind.BOX:
        local = ball / np.abs(ball).max(axis=1, keepdims=True) * np.array(shape.size) / 2
    elif shape.kind == ShapeKind.SPHERE:
        local = ball * shape.size[0]
    else:
        length, radius, _ = shape.size
        caps = ball * radius + np.array([0, 0, 1]) * np.where(z > 0, length / 2, -length / 2)[:, None]
        tube = np.stack([radius * np.cos(a), radius * np.sin(a), z * length / 2], axis=-1)
        local = tube if shape.kind == ShapeKind.CYLINDER else np.concatenate([caps, tube])
    return Rotation.from_quat(shape.orientation).apply(local) + np.array(shape.position)


def person_points(person, parts=None):
    """(N, 3) [m] points all over a person's surface, in the world frame."""
    clouds = []
    for part, pose in zip(person.model.parts, person.poses(), strict=True):
        if parts is None or part.name in parts:
            clouds += [surface_points(s) @ pose[:3, :3].T + pose[:3, 3] for s in part.shapes]
    return np.concatenate(clouds)
