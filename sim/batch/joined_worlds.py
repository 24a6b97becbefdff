"""The states of many kinematic worlds, joined in arrays of which each world keeps using its own slice."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from peopleboy.sim.physics.solid_shapes import Array, Placements, Solids, refresh
from peopleboy.sim.physics.vehicle import VehicleMotion, VehicleState
from peopleboy.sim.shapes.joined_tables import JoinedTables, Numbers, ends, join_tables, table_of


class JoinedWorlds(NamedTuple):
    """B worlds; numbers within them are those of each world by itself.

    Attributes:
        bodies: of all worlds, one world after the other.
        tables: of their solids.
        poses, boxes: of all solids, as in `Solids`.
        motion: of each world's vehicle, one row each.
        own: (B,) number of the vehicle's body.
        first_body, first_part: (B + 1,) where those of each world begin, and where the last end.
    """

    bodies: Placements
    tables: JoinedTables
    poses: Array
    boxes: Array
    motion: VehicleMotion
    own: Numbers
    first_body: Numbers
    first_part: Numbers


def join_worlds(states: Sequence[VehicleState]) -> tuple[JoinedWorlds, list[VehicleState]]:
    """Copy the states of worlds into arrays of all of them.

    Returns:
        The arrays, and each world's state anew, which lies in them.
    """
    joined = JoinedWorlds(
        bodies=Placements(*map(np.concatenate, zip(*(state.bodies for state in states), strict=True))),
        tables=join_tables([state.solids.table for state in states]),
        poses=np.concatenate([state.solids.poses for state in states]),
        boxes=np.concatenate([state.solids.boxes for state in states]),
        motion=VehicleMotion(*map(np.stack, zip(*(state.motion for state in states), strict=True))),
        own=np.array([state.own for state in states], np.int64),
        first_body=ends([len(state.bodies.places) for state in states]),
        first_part=ends([len(state.bodies.of_part) for state in states]),
    )
    return joined, [_state_in(joined, number, state) for number, state in enumerate(states)]


def _state_in(joined: JoinedWorlds, number: int, before: VehicleState) -> VehicleState:
    bodies, solids = slice_world.py_func(joined, number)
    motion = VehicleMotion(*(array[number] for array in joined.motion))
    return before._replace(bodies=bodies, solids=solids._replace(table=before.solids.table), motion=motion)


@njit(cache=True, nogil=True)
def slice_world(joined: JoinedWorlds, number: int) -> tuple[Placements, Solids]:
    """Bodies and solids of one of the worlds."""
    b, b_end = joined.first_body[number], joined.first_body[number + 1]
    p, p_end = joined.first_part[number], joined.first_part[number + 1]
    s, s_end = joined.tables.shape[number], joined.tables.shape[number + 1]
    bodies = Placements(
        joined.bodies.places[b:b_end],
        joined.bodies.hidden[b:b_end],
        joined.bodies.stale[b:b_end],
        joined.bodies.of_part[p:p_end],
        joined.bodies.base_from_part[p:p_end],
        joined.bodies.poses[p:p_end],
    )
    return bodies, Solids(table_of(joined.tables, number), joined.poses[s:s_end], joined.boxes[s:s_end])


@njit(cache=True, nogil=True)
def refresh_worlds(active: Numbers, joined: JoinedWorlds) -> None:
    """Bring some of the worlds up to date, as `refresh` does with one."""
    for number in active:
        bodies, solids = slice_world(joined, number)
        refresh(bodies, solids)
