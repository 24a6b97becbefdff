"""The people of many worlds, walking together where scripts and who is in the way alone guide them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from peopleboy.sim.people.scripted.script import WALK, Records, Script, Scripts, join_records, join_scripts
from peopleboy.sim.people.scripted.walk_scripts import walk_on
from peopleboy.sim.physics.solid_shapes import Array
from peopleboy.sim.shapes.joined_tables import Numbers, ends
from peopleboy.sim.world import World

_TWO = 2.0  # see `walk_on`
_NO_SCRIPT = Script.nothing()


class Walks:
    """Everybody in B worlds; those of worlds in which not all are scripted walk by themselves.

    Attributes:
        first: (B + 1,) where the people of each world begin.
        world: (Q,) where everybody is.
        is_scripted: (B,) in which worlds all are.
        makes_way: (B,) in which of these somebody makes way.
        records: (Q,) WALK of everybody; of those who walk by themselves only where they are, how they move,
            and whether they are there.
    """

    def __init__(self, worlds: Sequence[World]) -> None:
        self._crowds = [world.crowd for world in worlds]
        counts = [len(crowd.people) for crowd in self._crowds]
        self.first, self.world = ends(counts), np.repeat(np.arange(len(counts)), counts)
        own = [world.crowd.follow_scripts(has_begun=world.time_s > 0.0) for world in worlds]
        self.is_scripted = np.array([each is not None for each in own], np.bool_)
        scripts: list[Script] = []
        records: list[Records] = []
        walls = [np.empty((0, 4)) if each is None else each.walls for each in own]
        self._walls = np.concatenate([np.empty((0, 4)), *walls])
        self._first_wall = ends([len(each) for each in walls])
        for each, count in zip(own, counts, strict=True):
            scripts += [_NO_SCRIPT] * count if each is None else each.scripts
            records.append(np.zeros(count, WALK) if each is None else each.records)
        self._scripts = join_scripts(scripts)
        self.records = join_records(records, WALK)
        self.makes_way = np.array([each is not None and bool(each.records["yields"].any()) for each in own])
        for crowd, each, first, end in zip(self._crowds, own, self.first, self.first[1:], strict=False):
            if each is not None:
                crowd.lay_into(self.records[first:end])
        self._follow(np.arange(len(worlds)))

    def step(self, going: Numbers, times_s: Array, dt_s: float, robots: Array) -> None:
        """Let all walk on who are guided by scripts; the others have just walked.

        Args:
            going: (G,) numbers of the worlds.
            times_s: (G,) [s] in each of them at the start of the step.
            dt_s: [s] length of the step.
            robots: (G, 5) their robots, as of `RobotMotion`; velocities count where somebody makes way.
        """
        _walk_worlds(
            going, self.is_scripted, self.first, self.records, self._scripts, times_s, dt_s,
            robots, self._walls, self._first_wall, _TWO,
        )  # fmt: skip
        records = self.records
        headings, present = records["heading"].tolist(), records["is_present"].tolist()
        postures = records["posture"].tolist()
        borders = self.first.tolist()
        for number in going[self.is_scripted[going]].tolist():
            first, end = borders[number], borders[number + 1]
            self._crowds[number].take_over(headings[first:end], present[first:end], postures[first:end])
        self._follow(going)

    def _follow(self, going: Numbers) -> None:
        """Write down where those are now who walk by themselves."""
        for number in going[~self.is_scripted[going]].tolist():
            own = self.records[self.first[number] : self.first[number + 1]]
            for record, person in zip(own, self._crowds[number].people, strict=True):
                record["position"], record["velocity"] = person.position, person.velocity
                record["heading"], record["is_present"] = person.heading, person.present


@njit(cache=True, nogil=True)
def _walk_worlds(
    going: Numbers,
    is_scripted: NDArray[np.bool_],
    first: Numbers,
    walks: Records,
    scripts: Scripts,
    times_s: Array,
    dt_s: float,
    robots: Array,
    walls: Array,
    first_wall: Numbers,
    two: float,
) -> None:
    for row in range(len(going)):
        world = going[row]
        if is_scripted[world]:
            robot = (robots[row, 0], robots[row, 1], robots[row, 2], robots[row, 3], robots[row, 4])
            own = walls[first_wall[world] : first_wall[world + 1]]
            walk_on(first[world], first[world + 1], walks, scripts, times_s[row], dt_s, robot, own, two)
