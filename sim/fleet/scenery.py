"""What there is to be seen in many worlds, one world after the other in arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.cameras.surfaces import MaterialTable
from peopleboy.sim.fleet.side_by_side import Numbers
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
        table: visible shapes of all worlds.
        looks: of their parts.
        shape, surface, triangle, part: (B + 1,) where each world's begin, and where the last end.
    """

    table: ShapeTable
    looks: Looks
    shape: Numbers
    surface: Numbers
    triangle: Numbers
    part: Numbers


def join_scenery(tables: Sequence[ShapeTable], materials: Sequence[MaterialTable]) -> Scenery:
    """Copy tables and looks of worlds of plain detail into arrays of all of them."""
    own = [(each.thermal, each.colour, each.kind, each.period, each.phase) for each in materials]
    first = materials[0]
    without = first.finish, first.texels, first.paint, first.paint_texels
    return Scenery(
        table=ShapeTable(*map(np.concatenate, zip(*tables, strict=True))),
        looks=Looks._make([*map(np.concatenate, zip(*own, strict=True)), *without]),
        shape=_ends([len(each.kind) for each in tables]),
        surface=_ends([len(each.surface_part) for each in tables]),
        triangle=_ends([len(each.triangles) for each in tables]),
        part=_ends([len(each.thermal) for each in materials]),
    )


@njit(cache=True, nogil=True)
def scenery_of(scenery: Scenery, world: int) -> tuple[ShapeTable, Looks]:
    """What is to be seen in one of the worlds."""
    table, looks = scenery.table, scenery.looks
    s, s_end = scenery.shape[world], scenery.shape[world + 1]
    m, m_end = scenery.surface[world], scenery.surface[world + 1]
    t, t_end = scenery.triangle[world], scenery.triangle[world + 1]
    p, p_end = scenery.part[world], scenery.part[world + 1]
    own = ShapeTable(
        table.kind[s:s_end],
        table.size[s:s_end],
        table.part[s:s_end],
        table.part_from_shape[s:s_end],
        table.triangle_range[s:s_end],
        table.triangles[t:t_end],
        table.extent[s:s_end],
        table.reach[s:s_end],
        table.first_surface[s:s_end],
        table.surface_part[m:m_end],
        table.surface_shape[m:m_end],
    )
    return own, Looks(
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


def _ends(counts: list[int]) -> Numbers:
    return np.cumsum([0, *counts]).astype(np.int64)
