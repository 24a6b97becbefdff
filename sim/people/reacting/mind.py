"""What a person makes of the robot and of its group, put together instant by instant."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Final

from peopleboy.sim.people.reacting.conducts import (
    Blocking,
    Conduct,
    Curious,
    Ignoring,
    MakingWay,
    Surprised,
    Wary,
)
from peopleboy.sim.people.reacting.encounter import Encounter, Situation
from peopleboy.sim.people.reacting.keeping_together import Point, pace_among
from peopleboy.sim.people.reacting.leading import Leading
from peopleboy.sim.people.reacting.reaction import Lead, Reaction, Way
from peopleboy.sim.people.walking.wish import AS_PLANNED, Wish

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
        self._encounter = None if reacts is None else Encounter(reacts.from_m)
        self._conduct: Conduct | None = None

    def wish(self, dt_s: float, now: Situation | None, progress: float, company: Iterable[float]) -> Wish:
        """Tell what the person would rather do than its script.

        Args:
            dt_s: [s] length of the control step.
            now: where person and robot are; None if there is no robot.
            progress: how far along its path the person is, as `pace_among` has it.
            company: the same of the others of its group.
        """
        wish = AS_PLANNED if now is None else self._take_to_robot(dt_s, now)
        pace = pace_among(self._points, progress, company)
        return wish if pace == 1.0 else replace(wish, pace=pace)

    def _take_to_robot(self, dt_s: float, now: Situation) -> Wish:
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
