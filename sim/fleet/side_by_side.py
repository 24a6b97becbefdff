"""The states of many kinematic worlds in arrays of which each world keeps looking at its own part."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.physics.kinematic.solids import Placements, Solids
from peopleboy.sim.physics.kinematic.state import Motion, State
from peopleboy.sim.shapes.shape_table import ShapeTable

Numbers = NDArray[np.int64]


class Firsts(NamedTuple):
    """(B + 1,) where the bodies, parts, solids and triangles of each world begin, and where the last end."""

    body: Numbers
    part: Numbers
    solid: Numbers
    triangle: Numbers


class Joined(NamedTuple):
    """B worlds; numbers within them are those of each world by itself.

    Attributes:
        bodies: of all worlds, one world after the other.
        solids: likewise.
        motion: of each world's vehicle, one row each.
        own: (B,) number of the vehicle's body.
        firsts: where each world's begin.
    """

    bodies: Placements
    solids: Solids
    motion: Motion
    own: Numbers
    firsts: Firsts


def lay_side_by_side(states: Sequence[State]) -> tuple[Joined, list[State]]:
    """Copy the states of worlds into arrays of all of them.

    Returns:
        The arrays, and each world's state anew, which lies in them.
    """
    firsts = Firsts(
        body=_ends([len(state.bodies.places) for state in states]),
        part=_ends([len(state.bodies.of_part) for state in states]),
        solid=_ends([len(state.solids.boxes) for state in states]),
        triangle=_ends([len(state.solids.table.triangles) for state in states]),
    )
    bodies = Placements(*map(np.concatenate, zip(*(state.bodies for state in states), strict=True)))
    solids = Solids(
        table=ShapeTable(*map(_fixed, zip(*(state.solids.table for state in states), strict=True))),
        poses=np.concatenate([state.solids.poses for state in states]),
        boxes=np.concatenate([state.solids.boxes for state in states]),
    )
    motion = Motion(*map(np.stack, zip(*(state.motion for state in states), strict=True)))
    own = np.array([state.own for state in states], np.int64)
    joined = Joined(bodies, solids, motion, own, firsts)
    return joined, [_state_in(joined, number, state) for number, state in enumerate(states)]


def _state_in(joined: Joined, number: int, before: State) -> State:
    bodies, solids = world_in.py_func(joined, number)
    motion = Motion(*(array[number] for array in joined.motion))
    return before._replace(bodies=bodies, solids=solids._replace(table=before.solids.table), motion=motion)


@njit(cache=True)
def world_in(joined: Joined, number: int) -> tuple[Placements, Solids]:
    """Bodies and solids of one of the worlds; its table goes without surfaces, which nobody asks for."""
    firsts, table = joined.firsts, joined.solids.table
    b, b_end = firsts.body[number], firsts.body[number + 1]
    p, p_end = firsts.part[number], firsts.part[number + 1]
    s, s_end = firsts.solid[number], firsts.solid[number + 1]
    t, t_end = firsts.triangle[number], firsts.triangle[number + 1]
    bodies = Placements(
        joined.bodies.places[b:b_end],
        joined.bodies.hidden[b:b_end],
        joined.bodies.stale[b:b_end],
        joined.bodies.of_part[p:p_end],
        joined.bodies.base_from_part[p:p_end],
        joined.bodies.poses[p:p_end],
    )
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
        table.surface_part[:0],
        table.surface_shape[:0],
    )
    return bodies, Solids(own, joined.solids.poses[s:s_end], joined.solids.boxes[s:s_end])


def _ends(counts: list[int]) -> Numbers:
    return np.cumsum([0, *counts]).astype(np.int64)


def _fixed(arrays: Sequence[NDArray[Any]]) -> NDArray[Any]:
    joined = np.concatenate(arrays)
    joined.setflags(write=False)
    return joined
