"""The sonars of many robots, heard together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from peopleboy.sim.batch.joined_worlds import JoinedWorlds, cast_eyes, hear_worlds
from peopleboy.sim.batch.people import BatchWalks
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.robot.sonar import read_echoes
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.truth.scenes import BYSTANDER, Records
from peopleboy.sim.truth.visibility import look_at, stand_before
from peopleboy.sim.world import World


class Ears:
    """The sonar rings of B worlds, all of one kind.

    Args:
        worlds: of a fleet.
        joined: where all is that they hear.
    """

    def __init__(self, worlds: Sequence[World], joined: JoinedWorlds) -> None:
        self._rings = [world.robot.ring for world in worlds]
        self._joined = joined

    def hear(self, going: Numbers, poses: Matrix) -> Matrix:
        """(G, 16) [m] readings in worlds of some numbers (G,), which are up to date.

        Args:
            going: numbers of the worlds.
            poses: (G, 4, 4) of their robots.
        """
        ring = self._rings[0]
        turns, shifts = poses[:, :3, :3].transpose(0, 2, 1), poses[:, None, :3, 3]
        starts, ends = ring.starts @ turns + shifts, ring.ends @ turns + shifts
        nearest_m, noise, chance = np.empty((3, len(going), len(ring.starts)))
        hear_worlds(going, self._joined, starts, ends, ring.reach, nearest_m)
        for row, number in enumerate(going.tolist()):
            self._rings[number].draw_noise(noise[row], chance[row])
        return read_echoes(nearest_m, noise, chance, ring.config)


# Who could be seen from many robots, told together.


class PeopleVisibility:
    """Everybody in B worlds, before the thermal cameras of their robots, all of one kind.

    Args:
        worlds: of a fleet.
        walks: where everybody goes.
        joined: where all is that may hide them.
    """

    def __init__(self, worlds: Sequence[World], walks: BatchWalks, joined: JoinedWorlds) -> None:
        self._walks, self._joined = walks, joined
        self._camera = flat_geometry(worlds[0].config.robot.cameras, "thermal")
        counts = [len(world.crowd.people) for world in worlds]
        people = [person for world in worlds for person in world.crowd.people]
        self._known = np.zeros(len(people), BYSTANDER)
        self._known["id"] = [number for count in counts for number in range(1, count + 1)]
        self._known["height_m"] = [person.config.height_m for person in people]
        self._known["radius_m"] = [person.radius_m for person in people]

    def see(self, going: Numbers, poses: Matrix, robots: Matrix) -> tuple[Records, Numbers]:
        """Tell of everybody who is present in some worlds, as `bystanders` does of one.

        Args:
            going: (G,) numbers of the worlds, rising, which are up to date.
            poses: (G, 4, 4) of their robots.
            robots: (G, 3) [m, m, rad] the same.

        Returns:
            (Q,) records BYSTANDER of all of them, and (G + 1,) where those of each world begin.
        """
        walks, records = self._walks, self._walks.records
        row = np.full(len(walks.is_scripted), -1)
        row[going] = np.arange(len(going))
        who = np.flatnonzero(records["is_present"] & (row[walks.world] >= 0))
        row = row[walks.world[who]]
        first = np.searchsorted(row, np.arange(len(going) + 1))
        found = self._known[who]
        if len(who) == 0:
            return found, first
        present = records[who]
        found["position_m"], found["velocity_m_s"] = present["position"], present["velocity"]
        found["heading_rad"] = present["heading"]
        cameras = (poses @ self._camera.robot_from_camera)[row]
        uprights = stand_before(
            found["position_m"], found["height_m"], found["radius_m"], self._camera, cameras
        )
        fraction = np.ones(uprights.points.shape[:2])
        looked = np.flatnonzero(uprights.reaches_in)
        cast_eyes(looked, going[row], self._joined, uprights.eyes, uprights.points, fraction)
        look_at(found, robots[row], uprights, fraction)
        return found, first
