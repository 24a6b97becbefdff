"""Bodies of shapes that are given, each of one part: where they are, and where rays meet them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.bodies import Place, as_unit, as_units
from peopleboy.sim.physics.solids.cast import cast
from peopleboy.sim.physics.solids.solids import Array, Placements, Solids, make_solids, refresh
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
