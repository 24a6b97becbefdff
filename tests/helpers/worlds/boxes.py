"""Faces of boxes, by brute force: a second look at places, which knows nothing of how they are built."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from peopleboy.sim.places.extent import fixture_extent
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.shapes import ShapeKind

_CLOSE_M = 2e-4


@dataclass(frozen=True)
class Box:
    name: str
    low: np.ndarray
    high: np.ndarray

    def holds(self, point: np.ndarray) -> bool:
        return bool(np.all(point > self.low) and np.all(point < self.high))


def world_boxes(fixtures: tuple[Fixture, ...]) -> list[Box]:
    """One box per fixture, world frame."""
    return [Box(f.name, *fixture_extent(f)) for f in fixtures]


def upright_boxes(fixtures: tuple[Fixture, ...]) -> list[Box]:
    """One box per box-shaped piece that stands square to the axes, world frame."""
    square = [f for f in fixtures if abs(np.sin(4.0 * np.arctan2(f.orientation[2], f.orientation[3]))) < 1e-6]
    singles = [
        replace(f, name=f"{f.name}#{i}", part=replace(f.part, shapes=(shape,)))
        for f in square
        if f.part is not None
        for i, shape in enumerate(f.part.shapes)
        if shape.kind == ShapeKind.BOX
    ]
    return world_boxes(tuple(singles))


def piece_boxes(fixtures: tuple[Fixture, ...]) -> list[Box]:
    """One box per box-shaped piece, in the frame of the thing."""
    return [
        Box(
            f"{f.name}#{i}",
            np.subtract(s.position, np.divide(s.size, 2)),
            np.add(s.position, np.divide(s.size, 2)),
        )
        for f in fixtures
        if f.part is not None
        for i, s in enumerate(f.part.shapes)
        if s.kind == ShapeKind.BOX
    ]


def fighting_faces(boxes: list[Box]) -> list[tuple[str, str]]:
    """Pairs of boxes with faces that look the same way, lie in one plane, overlap, and can be seen."""
    fights = []
    for a, b in itertools.combinations(boxes, 2):
        low, high = np.maximum(a.low, b.low), np.minimum(a.high, b.high)
        for axis, side in itertools.product(range(3), (-1, 1)):
            face_a, face_b = (a.low, b.low) if side < 0 else (a.high, b.high)
            across = [i for i in range(3) if i != axis]
            if abs(face_a[axis] - face_b[axis]) > _CLOSE_M or np.any(high[across] - low[across] < 1e-6):
                continue
            spot = (low + high) / 2.0
            spot[axis] = face_a[axis] + side * 1e-3
            if not any(box.holds(spot) for box in boxes):
                fights.append((a.name, b.name))
    return fights


def first_hit(boxes: list[Box], origin: np.ndarray, direction: np.ndarray) -> float:
    """Distance to the nearest box along a ray; infinity if there is none."""
    nearest = np.inf
    for box in boxes:
        with np.errstate(divide="ignore"):
            t = np.stack([(box.low - origin) / direction, (box.high - origin) / direction])
        near, far = t.min(axis=0).max(), t.max(axis=0).min()
        if near < far and far > 0.0:
            nearest = min(nearest, max(near, 0.0))
    return nearest
