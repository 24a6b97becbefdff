"""Rays in many worlds (numba kernels)."""

from __future__ import annotations

import numpy as np
from numba import njit

from peopleboy.sim.fleet.side_by_side import Joined, world_in
from peopleboy.sim.physics.solid_shapes import Array, cast_into, refresh
from peopleboy.sim.shapes.joined_tables import Numbers


@njit(cache=True, nogil=True)
def refresh_worlds(going: Numbers, joined: Joined) -> None:
    """Bring some of the worlds up to date, as `refresh` does with one."""
    for number in going:
        bodies, solids = world_in(joined, number)
        refresh(bodies, solids)


@njit(cache=True, nogil=True)
def hear_worlds(
    going: Numbers, joined: Joined, starts: Array, ends: Array, reach_m: Array, nearest_m: Array
) -> None:
    """Find the nearest solid in the cones of sonars in some of the worlds, as `SonarRing.read` does in one.

    Args:
        going: (G,) numbers of the worlds.
        joined: up to date.
        starts: (G, S, 3) [m] of the sonars, world frame.
        ends: (G, S * N, 3) [m] of their rays, one sonar's after the other's.
        reach_m: (S, N) lengths of the rays.
        nearest_m: (G, S) gets the distances, inf for nothing.
    """
    sonars, rays = reach_m.shape
    begin, part = np.empty((sonars * rays, 3)), np.empty(sonars * rays, np.int64)
    fraction = np.empty(sonars * rays)
    for row in range(len(going)):
        bodies, solids = world_in(joined, going[row])
        for ray in range(sonars * rays):
            for i in range(3):
                begin[ray, i] = starts[row, ray // rays, i]
        fraction[:] = 1.0
        cast_into(begin, ends[row], bodies, solids, joined.own[going[row]], fraction, part)
        for sonar in range(sonars):
            nearest_m[row, sonar] = np.inf
            for k in range(rays):
                share = fraction[sonar * rays + k]
                if share < 1.0:
                    nearest_m[row, sonar] = min(nearest_m[row, sonar], share * reach_m[sonar, k])


@njit(cache=True, nogil=True)
def cast_eyes(
    looked: Numbers, world: Numbers, joined: Joined, eyes: Array, points: Array, fraction: Array
) -> None:
    """Do as `cast` from one eye to several points for each of Q people, through robots.

    Args:
        looked: numbers of the people who are looked for.
        world: (Q,) where they are.
        joined: up to date.
        eyes: (Q, 3) [m] world frame.
        points: (Q, N, 3) [m].
        fraction: (Q, N) 1 at first, gets the share of its way at which a ray hits something.
    """
    count = points.shape[1]
    starts, part = np.empty((count, 3)), np.empty(count, np.int64)
    for person in looked:
        bodies, solids = world_in(joined, world[person])
        for n in range(count):
            for i in range(3):
                starts[n, i] = eyes[person, i]
        own = joined.own[world[person]]
        cast_into(starts, points[person], bodies, solids, own, fraction[person], part)
