"""What rays meet without asking PyBullet: bodies of given shapes, and boxes round the rest."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.bullet_bodies import Place, as_unit, as_units
from peopleboy.sim.physics.solid_shapes import (
    Array,
    Placements,
    Solids,
    cast,
    entered_at,
    make_solids,
    refresh,
)
from peopleboy.sim.shapes.shape_table import VisualShape, as_given
from peopleboy.sim.shapes.shapes import Quaternion, Shape, Vector

_NONE: Final = -1


class GivenBodies:
    """Bodies by name, which are put somewhere from outside; rays meet them by the shapes' own geometry."""

    def __init__(self) -> None:
        self._rows: dict[str, int] = {}
        self._part_of_row = np.zeros(0, np.int64)
        self._solid: list[VisualShape] = []
        self._solid_rows: list[int] = []
        self._places = np.zeros((0, 7))
        self._has_moved = np.zeros(0, np.bool_)  # since `moved_poses`
        self._stale = np.zeros(0, np.bool_)  # since rays were cast
        self._packed: tuple[Placements, Solids] | None = None

    def add(self, name: str, part: int, solid: Sequence[Shape]) -> None:
        """Take in a body, the number that its part has in the world, and what of it is solid."""
        row = self._rows[name] = len(self._rows)
        self._part_of_row = np.append(self._part_of_row, part)
        if solid:
            self._solid += [as_given(shape, len(self._solid_rows)) for shape in solid]
            self._solid_rows.append(row)
        self._places = np.concatenate([self._places, np.zeros((1, 7))])
        self._has_moved, self._stale = (np.append(flags, True) for flags in (self._has_moved, self._stale))
        self._packed = None

    def put(self, name: str, position: Vector, orientation: Quaternion) -> None:
        """Put a body's frame at a position [m] and a quaternion, of any length, in the world."""
        row = self._rows[name]
        self._places[row] = (*position, *as_unit(orientation))
        self._has_moved[row] = self._stale[row] = True

    def put_all(self, names: Sequence[str], positions: ArrayLike, orientations: ArrayLike) -> None:
        """Do that with N bodies, at (N, 3) and (N, 4)."""
        rows = list(map(self._rows.__getitem__, names))
        self._places[rows, :3], self._places[rows, 3:] = positions, as_units(orientations)
        self._has_moved[rows] = self._stale[rows] = True

    def place(self, name: str) -> Place:
        """Position [m] and unit quaternion of a body's frame in the world."""
        x, y, z, i, j, k, w = self._places[self._rows[name]].tolist()
        return (x, y, z), (i, j, k, w)

    def moved_poses(self) -> tuple[NDArray[np.int64], Array]:
        """Numbers (M,) of the parts that were put somewhere since the last call, and poses (M, 4, 4)."""
        rows = np.flatnonzero(self._has_moved)
        self._has_moved[rows] = False
        return self._part_of_row[rows], pose_matrices(self._places[rows, :3], self._places[rows, 3:])

    def cast_rays(self, starts: Array, ends: Array, ignore: str | None) -> tuple[Array, NDArray[np.int64]]:
        """Find the nearest of these along rays; shapes are met from outside, triangles from both sides.

        Args:
            starts: (R, 3) [m] world frame.
            ends: (R, 3) [m].
            ignore: name of a body, of these or not, that rays pass through; None for none.

        Returns:
            fraction: (R,) of the way at which a ray hits, 1 where it hits nothing.
            part: (R,) number of the part that is hit, -1 where none.
        """
        if self._packed is None:
            self._packed = self._pack()
        bodies, solids = self._packed
        if self._stale.any():
            refresh(bodies, solids)
        passed = _NONE if ignore is None else self._rows.get(ignore, _NONE)
        fraction, solid = cast(starts, ends, bodies, solids, passed)
        return fraction, np.append(self._part_of_row[bodies.of_part], _NONE)[solid]

    def _pack(self) -> tuple[Placements, Solids]:
        count = len(self._solid_rows)
        self._stale[:] = True
        bodies = Placements(
            places=self._places,
            hidden=np.zeros(len(self._rows), np.bool_),
            stale=self._stale,
            of_part=np.array(self._solid_rows, np.int64),
            base_from_part=np.tile(np.eye(4), (count, 1, 1)),
            poses=np.zeros((count, 4, 4)),
        )
        return bodies, make_solids(self._solid)


Link = tuple[int, int]


class SolidBoxes:
    """Upright boxes around the solid links of bodies, brought up to date when rays are cast.

    Args:
        box_of: gives the least and the greatest corner [m] of the box around a body's link, world frame.
    """

    def __init__(self, box_of: Callable[[int, int], tuple[Vector, Vector]]) -> None:
        self._box_of = box_of
        self._boxes = np.zeros((0, 2, 3))
        self._links: dict[str, Sequence[Link]] = {}
        self._rows: dict[str, tuple[int, int]] = {}
        self._stale: set[str] = set()

    def add(self, name: str, links: Sequence[Link]) -> None:
        """Take in a body and the links of it that are solid."""
        first = len(self._boxes)
        self._boxes = np.concatenate([self._boxes, np.zeros((len(links), 2, 3))])
        self._links[name] = links
        self._rows[name] = (first, first + len(links))
        self._stale.add(name)

    def forget(self, name: str) -> None:
        """Look anew at a body, which has moved, when rays are cast next."""
        self._stale.add(name)

    def find_near(self, starts: Array, ends: Array, ignore: str | None) -> NDArray[np.int64]:
        """Numbers of all rays that come within 1 mm of the box of one of these bodies other than `ignore`.

        Args:
            starts: (R, 3) [m] world frame.
            ends: (R, 3) [m].
            ignore: name of a body, or None.
        """
        for name in self._stale - {ignore}:
            first, _ = self._rows[name]
            for row, link in enumerate(self._links[name], first):
                self._boxes[row] = self._box_of(*link)
        self._stale &= {ignore}
        passed = (0, 0) if ignore is None else self._rows.get(ignore, (0, 0))
        return np.flatnonzero(_reach(starts, ends, self._boxes, passed))


@njit(cache=True)
def _reach(starts: Array, ends: Array, boxes: Array, passed: tuple[int, int]) -> NDArray[np.bool_]:
    """(R,) whether each ray reaches a box, those of the rows `passed` aside."""
    found = np.zeros(len(starts), np.bool_)
    for ray in range(len(starts)):
        for row in range(len(boxes)):
            if not passed[0] <= row < passed[1] and entered_at(starts[ray], ends[ray], boxes[row]) <= 1.0:
                found[ray] = True
                break
    return found
