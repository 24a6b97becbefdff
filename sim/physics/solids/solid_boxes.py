"""Which rays come near bodies of files, told from boxes: PyBullet need not be asked about the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.physics.solids.cast import entered_at
from peopleboy.sim.shapes.shapes import Vector

Array = NDArray[np.float64]
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
