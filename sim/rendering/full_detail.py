"""Extras for images of full detail: anti-aliased edges, mirrors, and contact shadows."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.geometry.pinhole import Matrix, Pinhole
from peopleboy.sim.geometry.vectors import compose
from peopleboy.sim.rendering.edges import smooth
from peopleboy.sim.rendering.reflections import Reflection, find_reflections
from peopleboy.sim.rendering.renderer import RenderPass
from peopleboy.sim.shapes.shape_table import ShapeTable
from peopleboy.sim.shapes.shapes import ShapeKind

# What stands on a floor or near above it: for the soft shadows where things touch it.

Array = NDArray[np.float64]

REACH_M = 0.4  # beyond this distance from an object the floor is fully lit
_HIGHEST_M = 0.3  # higher objects cast no contact shadow
_FLAT_M = 0.01  # shapes that end lower belong to the floor
_LEAST_M = 0.03  # flatter objects cast none either

_SPHERE = int(ShapeKind.SPHERE)
_CAPSULE = int(ShapeKind.CAPSULE)
_CYLINDER = int(ShapeKind.CYLINDER)
_BOX = int(ShapeKind.BOX)
_PLANE = int(ShapeKind.PLANE)


@dataclass(frozen=True, slots=True, eq=False)
class Contacts:
    """Footprints of the objects on the floor.

    Attributes:
        prints: (K, 9) [m] each a rounded rectangle: middle x and y, its axis x and y, half its length, half
            its width, the radius by which it is wider all round, and how high it begins and ends.
        is_floor: (P,) parts that lie flat on the ground.
    """

    prints: Array
    is_floor: NDArray[np.bool_]


def find_contacts(table: ShapeTable, world_from_part: Matrix, hidden: NDArray[np.bool_]) -> Contacts:
    """Find the footprints of all shapes that begin less than 0.3 m above the floor and rise above it."""
    return Contacts(*_find_prints(table, world_from_part, hidden))


@njit(cache=True, error_model="numpy")
def _find_prints(
    table: ShapeTable, world_from_part: Array, hidden: NDArray[np.bool_]
) -> tuple[Array, NDArray[np.bool_]]:
    prints, pose, found = np.empty((len(table.kind), 9)), np.empty((3, 4)), 0
    is_floor = np.zeros(len(hidden), np.bool_)
    for shape in range(len(table.kind)):
        part, kind, size = table.part[shape], table.kind[shape], table.size[shape]
        if hidden[part]:
            continue
        compose(world_from_part[part], table.part_from_shape[shape], pose)
        row = prints[found]
        row[0], row[1], z = pose[0, 3], pose[1, 3], pose[2, 3]
        row[2], row[3], row[4], row[5], row[6] = 1.0, 0.0, 0.0, 0.0, 0.0
        if kind == _SPHERE:
            row[6], up = size[0], size[0]
        elif kind in (_CAPSULE, _CYLINDER):
            level = math.hypot(pose[0, 2], pose[1, 2])
            if level > 1e-6:
                row[2], row[3] = pose[0, 2] / level, pose[1, 2] / level
            row[4], row[6] = level * size[0] / 2.0, size[1]
            round_end = 1.0 if kind == _CAPSULE else level
            up = abs(pose[2, 2]) * size[0] / 2.0 + round_end * size[1]
        elif kind == _BOX:
            up = _print_box(pose, size, row)
        else:
            is_floor[part] |= kind == _PLANE
            continue
        row[7], row[8] = z - up, z + up
        is_floor[part] |= abs(row[8]) <= _FLAT_M
        if row[7] < _HIGHEST_M and row[8] > _LEAST_M:
            found += 1
    return prints[:found].copy(), is_floor


@njit(cache=True, error_model="numpy")
def _print_box(pose: Array, size: Array, row: Array) -> float:
    """Set direction and halves of a box's footprint (9,); returns how far the box rises from its middle."""
    longest, up = 0.0, 0.0
    for i in range(3):
        # The longest edge that is not upright gives the direction.
        level = math.hypot(pose[0, i], pose[1, i]) * size[i]
        if level > longest:
            longest = level
            row[2], row[3] = pose[0, i] * size[i] / level, pose[1, i] * size[i] / level
    for i in range(3):
        row[4] += abs(pose[0, i] * row[2] + pose[1, i] * row[3]) * size[i] / 2.0
        row[5] += abs(pose[1, i] * row[2] - pose[0, i] * row[3]) * size[i] / 2.0
        up += abs(pose[2, i]) * size[i] / 2.0
    return up


@njit(cache=True, fastmath=True)
def gap(row: Array, x: float, y: float) -> float:
    """Distance [m] from a place on the floor to a footprint (9,), 0 below it."""
    dx, dy = x - row[0], y - row[1]
    along = max(abs(dx * row[2] + dy * row[3]) - row[4], 0.0)
    across = max(abs(dy * row[2] - dx * row[3]) - row[5], 0.0)
    away: float = max(math.sqrt(along * along + across * across) - row[6], 0.0)
    return away


class FullDetail:
    """Extras of a pinhole view beyond one sample per pixel, computed on first access.

    Args:
        seen: what it sees.
        camera: its geometry.
        is_shiny: (P,) parts that mirror.
        is_mirrored: (P,) parts that are seen in mirrors.
    """

    def __init__(
        self, seen: RenderPass, camera: Pinhole, is_shiny: NDArray[np.bool_], is_mirrored: NDArray[np.bool_]
    ) -> None:
        self._seen, self._camera = seen, camera
        self._is_shiny, self._is_mirrored = is_shiny, is_mirrored

    def smooth(self, image: NDArray[np.float32], contrast: float) -> None:
        """Anti-alias the edges of an (H, W, C) image of this view in place; see `edges.smooth`."""
        smooth(image, contrast, self._seen, self._camera)

    @cached_property
    def reflections(self) -> tuple[Reflection, ...]:
        """The reflections in this view."""
        return find_reflections(self._seen, self._camera, self._is_shiny, self._is_mirrored)

    @cached_property
    def contacts(self) -> Contacts:
        """The footprints of objects on the floor."""
        scene = self._seen.scene
        return find_contacts(scene.table, scene.world_from_part, scene.hidden)
