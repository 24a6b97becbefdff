"""The shape tables of many worlds in arrays of all of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.shapes.shape_table import ShapeTable

Numbers = NDArray[np.int64]


class JoinedTables(NamedTuple):
    """B tables, one after the other; numbers within them are those of each by itself.

    Attributes:
        arrays: of all of them, which cannot be written to.
        shape, surface, triangle: (B + 1,) where those of each begin, and where the last end.
    """

    arrays: ShapeTable
    shape: Numbers
    surface: Numbers
    triangle: Numbers


def join_tables(tables: Sequence[ShapeTable]) -> JoinedTables:
    """Copy tables into arrays of all of them."""
    return JoinedTables(
        arrays=ShapeTable(*map(_fixed, zip(*tables, strict=True))),
        shape=ends([len(table.kind) for table in tables]),
        surface=ends([len(table.surface_part) for table in tables]),
        triangle=ends([len(table.triangles) for table in tables]),
    )


@njit(cache=True, nogil=True)
def table_of(joined: JoinedTables, number: int) -> ShapeTable:
    """One of the tables, which lies in those arrays."""
    arrays = joined.arrays
    s, s_end = joined.shape[number], joined.shape[number + 1]
    m, m_end = joined.surface[number], joined.surface[number + 1]
    t, t_end = joined.triangle[number], joined.triangle[number + 1]
    return ShapeTable(
        arrays.kind[s:s_end],
        arrays.size[s:s_end],
        arrays.part[s:s_end],
        arrays.part_from_shape[s:s_end],
        arrays.triangle_range[s:s_end],
        arrays.triangles[t:t_end],
        arrays.extent[s:s_end],
        arrays.reach[s:s_end],
        arrays.first_surface[s:s_end],
        arrays.surface_part[m:m_end],
        arrays.surface_shape[m:m_end],
    )


def ends(counts: Sequence[int]) -> Numbers:
    """(B + 1,) where the items of each of B begin that are so many, and where the last end."""
    return np.cumsum([0, *counts]).astype(np.int64)


def _fixed(arrays: Sequence[NDArray[Any]]) -> NDArray[Any]:
    joined = np.concatenate(arrays)
    joined.setflags(write=False)
    return joined
