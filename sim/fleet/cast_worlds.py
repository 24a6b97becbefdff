"""Rays in many worlds (numba kernels)."""

from __future__ import annotations

import numpy as np
from numba import njit

from peopleboy.sim.fleet.side_by_side import Joined, Numbers, world_in
from peopleboy.sim.physics.kinematic.cast import cast_into
from peopleboy.sim.physics.kinematic.solids import Array, refresh


@njit(cache=True, nogil=True)
def cast_worlds(going: Numbers, joined: Joined, starts: Array, ends: Array, fraction: Array) -> None:
    """Do as `cast` in some of the worlds, for rays that pass through their robots.

    Args:
        going: (G,) numbers of the worlds.
        joined: is brought up to date in them.
        starts: (G, R, 3) [m] world frame.
        ends: (G, R, 3) [m].
        fraction: (G, R) 1 at first, gets the share of its way at which a ray hits something.
    """
    part = np.empty(starts.shape[1], np.int64)
    for row in range(len(going)):
        bodies, solids = world_in(joined, going[row])
        refresh(bodies, solids)
        cast_into(starts[row], ends[row], bodies, solids, joined.own[going[row]], fraction[row], part)


@njit(cache=True, nogil=True)
def cast_eyes(
    looked: Numbers, world: Numbers, joined: Joined, eyes: Array, points: Array, fraction: Array
) -> None:
    """Do the same from one eye to several points for each of Q people.

    Args:
        looked: numbers of the people who are looked for.
        world: (Q,) where they are.
        joined: up to date.
        eyes: (Q, 3) [m] world frame.
        points: (Q, N, 3) [m].
        fraction: (Q, N) as in `cast_worlds`.
    """
    count = points.shape[1]
    starts, part = np.empty((count, 3)), np.empty(count, np.int64)
    for person in looked:
        bodies, solids = world_in(joined, world[person])
        starts[:] = eyes[person]
        own = joined.own[world[person]]
        cast_into(starts, points[person], bodies, solids, own, fraction[person], part)
