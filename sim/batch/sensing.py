"""What many robots sense together: their sonars, and how much of people they could see."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numba import njit

from peopleboy.sim.batch.batch_people import BatchWalks
from peopleboy.sim.batch.joined_worlds import JoinedWorlds, slice_world
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.physics.solid_shapes import Array, cast_into
from peopleboy.sim.robot.sonar import read_rings
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.truth.scenes import BYSTANDER, Records
from peopleboy.sim.truth.visibility import known_people, look_at_people
from peopleboy.sim.world import World


class BatchSonar:
    """The sonar rings of B worlds, all of one kind.

    Args:
        worlds: of a batch.
        joined: where all is that they hear.
    """

    def __init__(self, worlds: Sequence[World], joined: JoinedWorlds) -> None:
        self._rings = [world.robot.ring for world in worlds]
        self._joined = joined

    def read(self, active: Numbers, poses: Matrix) -> Matrix:
        """(G, 16) [m] readings in some worlds (G,), which are up to date, of robots at poses (G, 4, 4)."""
        rings = [self._rings[number] for number in active.tolist()]
        return read_rings(rings, poses, partial(_cast, self._joined, active))


class PeopleVisibility:
    """The people of B worlds before the thermal cameras of their robots, all of one kind.

    Args:
        worlds: of a batch.
        walks: where everybody goes.
        joined: where all is that may hide them.
    """

    def __init__(self, worlds: Sequence[World], walks: BatchWalks, joined: JoinedWorlds) -> None:
        self._walks, self._joined = walks, joined
        self._camera = flat_geometry(worlds[0].config.robot.cameras, "thermal")
        self._known = np.concatenate(
            [np.zeros(0, BYSTANDER), *(known_people(world.crowd.people) for world in worlds)]
        )

    def look(self, active: Numbers, poses: Matrix, robots: Matrix) -> tuple[Records, Numbers]:
        """Return where all are who are present in some worlds, and how much of them could be seen.

        Args:
            active: (G,) numbers of the worlds, rising, which are up to date.
            poses: (G, 4, 4) of their robots.
            robots: (G, 3) [m, m, rad] the same.

        Returns:
            (Q,) records BYSTANDER of all of them, and (G + 1,) where those of each world begin.
        """
        walks, records = self._walks, self._walks.records
        row = np.full(len(walks.is_scripted), -1)
        row[active] = np.arange(len(active))
        present = np.flatnonzero(records["is_present"] & (row[walks.world] >= 0))
        row = row[walks.world[present]]
        found, walking = self._known[present], records[present]
        found["position_m"], found["velocity_m_s"] = walking["position"], walking["velocity"]
        found["heading_rad"] = walking["heading"]

        def cast(looked: Numbers, starts: Matrix, ends: Matrix) -> Matrix:
            return _cast(self._joined, active[row[looked]], starts, ends)

        cameras = (poses @ self._camera.robot_from_camera)[row]
        look_at_people(found, robots[row], self._camera, cameras, cast)
        return found, np.searchsorted(row, np.arange(len(active) + 1))


def _cast(joined: JoinedWorlds, worlds: Numbers, starts: Matrix, ends: Matrix) -> Matrix:
    """(G, R) shares of their ways at which rays (G, R, 3) in worlds (G,) hit something besides the robots."""
    fraction = np.ones(starts.shape[:2])
    _cast_rays(worlds, joined, starts, ends, fraction)
    return fraction


@njit(cache=True, nogil=True)
def _cast_rays(worlds: Numbers, joined: JoinedWorlds, starts: Array, ends: Array, fraction: Array) -> None:
    part = np.empty(starts.shape[1], np.int64)
    for row in range(len(worlds)):
        bodies, solids = slice_world(joined, worlds[row])
        cast_into(starts[row], ends[row], bodies, solids, joined.own[worlds[row]], fraction[row], part)
