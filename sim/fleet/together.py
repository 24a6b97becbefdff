"""Any worlds, stepped together as far as they can be."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from peopleboy.sim.fleet.crew import Crew
from peopleboy.sim.fleet.fleet import Fleet, kind_of_fleet
from peopleboy.sim.fleet.instants import Instants, perceive
from peopleboy.sim.physics.solid_shapes import Array
from peopleboy.sim.shapes.joined_tables import Numbers
from peopleboy.sim.world import World


class Together:
    """Worlds by number: kinematic ones in a fleet for each kind, others each by itself."""

    def __init__(self, worlds: Sequence[World], crew: Crew) -> None:
        self._worlds = tuple(worlds)
        kinds: dict[object, list[int]] = defaultdict(list)
        for number, world in enumerate(worlds):
            kinds[kind_of_fleet(world)].append(number)
        self._alone = kinds.pop(None, [])
        self._fleets = [
            (Fleet([worlds[number] for number in group], crew), np.array(group, np.int64))
            for group in kinds.values()
        ]

    def step(self, going: Numbers, commands: Array) -> list[Instants]:
        """Step some of the worlds, and perceive what is in them then.

        Args:
            going: (G,) numbers of the worlds, rising.
            commands: (G, 2) speeds [m/s, rad/s].

        Returns:
            What is perceived in all of them, as many worlds at a time as are stepped together.

        Raises:
            BadInput: a command is not finite.
        """
        found = []
        for number in self._alone:
            for k in np.flatnonzero(going == number).tolist():
                world = self._worlds[number]
                world.step(*commands[k].tolist())
                found.append(perceive(world)._replace(numbers=going[k : k + 1]))
        row = np.full(len(self._worlds), -1)
        row[going] = np.arange(len(going))
        for fleet, group in self._fleets:
            own = np.flatnonzero(row[group] >= 0)
            if len(own):
                fleet.step(own, commands[row[group[own]]])
                found.append(fleet.look(own)._replace(numbers=group[own]))
        return found
