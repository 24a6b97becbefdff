"""The sonars of many robots, heard together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from peopleboy.sim.fleet.cast_worlds import hear_worlds
from peopleboy.sim.fleet.side_by_side import Joined
from peopleboy.sim.geometry.pinhole import Matrix
from peopleboy.sim.robot.sonar import read_echoes
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.world import World


class Ears:
    """The sonar rings of B worlds, all of one kind.

    Args:
        worlds: of a fleet.
        joined: where all is that they hear.
    """

    def __init__(self, worlds: Sequence[World], joined: Joined) -> None:
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
