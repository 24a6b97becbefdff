"""Things that are moved, in the physics world, and the hands that move them."""

from __future__ import annotations

from collections.abc import Sequence

from peopleboy.sim.people.person import Person
from peopleboy.sim.physics.physics import Physics
from peopleboy.sim.places.moving import Action, Mover, ThingState, ease
from peopleboy.sim.places.place import Place

REACH_S = 0.6  # for a hand to get to a thing, and back


class Handling:
    """Puts every thing that is moved where it is at an instant, and people's hands to it.

    Args:
        physics: the physics world, with all fixtures of the place.
        place: whose movers they are.
        people: who may move them.
    """

    def __init__(self, physics: Physics, place: Place, people: Sequence[Person]) -> None:
        self._physics = physics
        self._movers = place.movers
        self._people = {person.name: person for person in people}
        self._bodies = {
            mover.name: [f.name for f in place.fixtures if f.name.split("/")[0] == mover.name]
            for mover in place.movers
        }
        self._shown: dict[str, ThingState] = {}
        self._by = [(mover, action) for mover in place.movers for action in mover.actions if action.by]

    def show(self, time_s: float) -> None:
        """Put things and hands where they are at a time [s]."""
        for mover in self._movers:
            self._put(mover, mover.at(time_s))
        for name in dict.fromkeys(str(action.by) for _, action in self._by):
            self._reach(self._people[name], time_s)

    def _put(self, mover: Mover, state: ThingState) -> None:
        before = self._shown.get(mover.name)
        for body in self._bodies[mover.name]:
            if before is None or before.stance != state.stance:
                self._physics.set_pose(body, state.stance.position_m, state.stance.orientation)
            if before is None or before.is_there != state.is_there:
                self._physics.set_hidden(body, not state.is_there)
        self._shown[mover.name] = state

    def _reach(self, person: Person, time_s: float) -> None:
        """Let a person's hand be at the thing that it moves, be on the way there, or hang."""
        own = [(mover, action) for mover, action in self._by if action.by == person.name]
        mover, action = max(own, key=lambda one: (_share(one[1], time_s), one[1].at_s))
        share = _share(action, time_s)
        if share <= 0.0:
            person.let_go()
            return
        x, y = person.position.tolist()
        halfway = mover.grip(action, (action.at_s + action.ends_s) / 2.0, (x, y))
        person.reach_for(mover.grip(action, time_s, (x, y)), ease(share), halfway)


def _share(action: Action, time_s: float) -> float:
    """How far the hand is at the thing: 1 while the action lasts, less before and after it."""
    away_s = max(action.at_s - time_s, time_s - action.ends_s, 0.0)
    return max(1.0 - away_s / REACH_S, 0.0)
