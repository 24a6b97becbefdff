"""What there is to be seen in many worlds, one world after the other in arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.surfaces import MaterialTable
from peopleboy.sim.shapes.joined_tables import JoinedTables, Numbers, ends, join_tables
from peopleboy.sim.shapes.shape_table import ShapeTable

Array = NDArray[np.float64]


class Looks(NamedTuple):
    """How parts look, as in `MaterialTable`; those of plain detail have neither finishes nor paintings."""

    thermal: Array
    colour: Array
    kind: Numbers
    period: Array
    phase: Array
    finish: Array
    texels: NDArray[np.int16]
    paint: Array
    paint_texels: NDArray[np.int16]


class Scenery(NamedTuple):
    """B worlds; numbers within them are those of each world by itself.

    Attributes:
        tables: visible shapes of all worlds.
        looks: of their parts.
        part: (B + 1,) where each world's parts begin, and where the last end.
    """

    tables: JoinedTables
    looks: Looks
    part: Numbers


def join_scenery(tables: Sequence[ShapeTable], materials: Sequence[MaterialTable]) -> Scenery:
    """Copy tables and looks of worlds of plain detail into arrays of all of them."""
    own = [(each.thermal, each.colour, each.kind, each.period, each.phase) for each in materials]
    first = materials[0]
    without = first.finish, first.texels, first.paint, first.paint_texels
    looks = Looks._make([*map(np.concatenate, zip(*own, strict=True)), *without])
    return Scenery(join_tables(tables), looks, ends([len(each.thermal) for each in materials]))


@njit(cache=True, nogil=True)
def looks_of(scenery: Scenery, world: int) -> Looks:
    """How the parts of one of the worlds look."""
    looks, p, p_end = scenery.looks, scenery.part[world], scenery.part[world + 1]
    return Looks(
        looks.thermal[p:p_end],
        looks.colour[p:p_end],
        looks.kind[p:p_end],
        looks.period[p:p_end],
        looks.phase[p:p_end],
        looks.finish,
        looks.texels,
        looks.paint,
        looks.paint_texels,
    )
