"""What a person makes of the robot and of its group, put together instant by instant."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import accumulate, pairwise
from typing import Final

from peopleboy.sim.people.conducts import (
    Blocking,
    Conduct,
    ConductSituation,
    Curious,
    Encounter,
    Ignoring,
    Leading,
    MakingWay,
    Surprised,
    Wary,
)
from peopleboy.sim.people.reaction import Lead, Reaction, Way
from peopleboy.sim.people.walking.surroundings import AS_PLANNED, Wish

Point = tuple[float, float]

_EASY_M: Final = 0.4  # up to which nobody cares who is ahead
_WAITS_M: Final = 1.5  # ahead of the last of the group, where one waits


def pace_among(points: Sequence[Point], progress: float, company: Iterable[float]) -> float:
    """Return what share of its planned speed a person walks at, so as not to leave its group behind.

    Args:
        points: [m] of the person's own path.
        progress: how far it has got: waypoints reached and the share of the way to the next one.
        company: the same of the others of the group, whose paths have as many points.

    Returns:
        1 up to 0.4 m ahead of the last of the group, 0 from 1.5 m on, linear between.
    """
    last = min(company, default=progress)
    ahead_m = _along(points, progress) - _along(points, last)
    return min(max((_WAITS_M - ahead_m) / (_WAITS_M - _EASY_M), 0.0), 1.0)


def _along(points: Sequence[Point], progress: float) -> float:
    """How far along a path [m] a progress is."""
    ways = [0.0, *accumulate(math.dist(a, b) for a, b in pairwise(points))]
    index = min(int(progress), len(ways) - 1)
    if index == len(ways) - 1:
        return ways[-1]
    return ways[index] + (progress - index) * (ways[index + 1] - ways[index])


_CONDUCTS: Final[Mapping[Way, Callable[[Reaction], Conduct]]] = {
    "ignores": lambda _: Ignoring(),
    "makes_way": MakingWay,
    "curious": Curious,
    "wary": Wary,
    "blocks": Blocking,
    "surprised": Surprised,
}


class Mind:
    """Decides how a person changes its script; one that has nothing to decide never does.

    Args:
        points: [m] of its path.
        reacts: how it takes to the robot; None for no way in particular.
        leads: how it leads the robot; None if it does not.
    """

    def __init__(self, points: Sequence[Point], reacts: Reaction | None, leads: Lead | None) -> None:
        self._points = tuple(points)
        self._reaction = reacts
        self._leading = None if leads is None else Leading(leads)
        self._encounter = None if reacts is None else Encounter(reacts.begins_m)
        self._conduct: Conduct | None = None

    def wish(
        self, dt_s: float, now: ConductSituation | None, progress: float, company: Iterable[float]
    ) -> Wish:
        """Return what the person would rather do than its script.

        Args:
            dt_s: [s] length of the control step.
            now: where person and robot are; None if there is no robot.
            progress: how far along its path the person is, as `pace_among` has it.
            company: the same of the others of its group.
        """
        wish = AS_PLANNED if now is None else self._take_to_robot(dt_s, now)
        pace = pace_among(self._points, progress, company)
        return wish if pace == 1.0 else replace(wish, pace=pace)

    def _take_to_robot(self, dt_s: float, now: ConductSituation) -> Wish:
        if self._leading is not None:
            return self._leading.wish(dt_s, now)
        if self._reaction is None or self._encounter is None:
            return AS_PLANNED
        if self._reaction.way != "ignores" and not self._encounter.update(now):
            self._conduct = None
            return AS_PLANNED
        if self._conduct is None:
            self._conduct = _CONDUCTS[self._reaction.way](self._reaction)
        return self._conduct.wish(dt_s, now)
