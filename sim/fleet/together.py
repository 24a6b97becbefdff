"""Any worlds, stepped together as far as they can be."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

from peopleboy.sim.fleet.crew import Crew
from peopleboy.sim.fleet.fleet import Command, Fleet, kind_of_fleet
from peopleboy.sim.fleet.instant import Instant
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
            (Fleet([worlds[number] for number in group], crew), group) for group in kinds.values()
        ]

    def step(self, commands: Mapping[int, Command]) -> dict[int, Instant]:
        """Step some of the worlds, and perceive what is in them then.

        Args:
            commands: speeds [m/s, rad/s] by the number of the world.
        """
        found = {}
        for number in self._alone:
            if number in commands:
                self._worlds[number].step(*commands[number])
                found[number] = perceive(self._worlds[number])
        for fleet, group in self._fleets:
            inside = {k: commands[number] for k, number in enumerate(group) if number in commands}
            if inside:
                fleet.step(inside)
                found |= {
                    group[k]: instant for k, instant in zip(inside, fleet.look(list(inside)), strict=True)
                }
        return found


def perceive(world: World) -> Instant:
    """Sense once in one world, images included where there are any."""
    return Instant(world.observe() if world.has_images else world.sense(), world.scene())
