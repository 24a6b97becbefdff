"""Solid bodies of shapes that are given, each of one part, and the rays that meet them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.geometry.poses import pose_matrices
from peopleboy.sim.physics.solids.cast import cast
from peopleboy.sim.physics.solids.solids import Array, Placements, Solids, refresh
from peopleboy.sim.shapes.shape_table import VisualShape, make_shape_table
from peopleboy.sim.shapes.shapes import Quaternion, Shape, Vector

_NONE = -1


class GivenSolids:
    """Bodies by name, which are put somewhere from outside and met by rays by the shapes' own geometry."""

    def __init__(self) -> None:
        self._rows: dict[str, int] = {}
        self._part_of_row: list[int] = []
        self._shapes: list[VisualShape] = []
        self._places = np.zeros((0, 7))
        self._packed: tuple[Placements, Solids] | None = None
        self._is_stale = False

    def add(self, name: str, part: int, shapes: Sequence[Shape]) -> None:
        """Take in a body, and the number that its part has in the world."""
        row = self._rows[name] = len(self._rows)
        self._part_of_row.append(part)
        self._shapes += [
            VisualShape(row, one.kind, one.size, pose_matrices(one.position, one.orientation), one.mesh)
            for one in shapes
        ]
        self._places = np.concatenate([self._places, np.zeros((1, 7))])
        self._packed = None

    def __contains__(self, name: str) -> bool:
        return name in self._rows

    def put(self, name: str, position: Vector, orientation: Quaternion) -> None:
        """Put a body's frame at `position` [m] and `orientation`, a unit quaternion, in the world."""
        row = self._rows[name]
        self._places[row] = (*position, *orientation)
        if self._packed is not None:
            self._packed[0].stale[row] = self._is_stale = True

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
            self._packed, self._is_stale = self._pack(), True
        if self._is_stale:
            refresh(*self._packed)
            self._is_stale = False
        passed = _NONE if ignore is None else self._rows.get(ignore, _NONE)
        fraction, row = cast(starts, ends, *self._packed, passed)
        return fraction, np.array([*self._part_of_row, _NONE])[row]

    def _pack(self) -> tuple[Placements, Solids]:
        count, table = len(self._rows), make_shape_table(self._shapes)
        bodies = Placements(
            places=self._places,
            hidden=np.zeros(count, np.bool_),
            stale=np.ones(count, np.bool_),
            of_part=np.arange(count),
            base_from_part=np.tile(np.eye(4), (count, 1, 1)),
            poses=np.zeros((count, 4, 4)),
        )
        return bodies, Solids(table, np.zeros((len(table.kind), 4, 4)), np.zeros((len(table.kind), 2, 3)))
