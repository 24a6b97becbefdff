"""What becomes of things: that they were moved, from where to where and by whom, appeared or vanished."""

from __future__ import annotations

import math
from dataclasses import dataclass

from peopleboy.sim.shapes.shapes import Vector
from peopleboy.sim.truth.things import ThingTruth
from peopleboy.sim.truth.truth import Truth

STANDS_S = 0.5  # a thing that has stood for so long has been moved; what follows sooner belongs to it
_SOON_S = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """What a thing did between two rests.

    Attributes:
        from_s, to_s: [s] when it set off and when it came to rest.
        from_m, to_m: (x, y, z) [m] of its frame then, world frame.
        distance_m: [m] between the two, as the crow flies.
        turned_deg: [deg] how far it was turned meanwhile, at most 180; positive to the left.
    """

    from_s: float
    to_s: float
    from_m: Vector
    to_m: Vector
    distance_m: float
    turned_deg: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ThingEvent:
    """Something worth a line in the log.

    Attributes:
        time_s: [s] since the start.
        kind: "thing moved", "thing appeared" or "thing vanished".
        thing: which.
        by: the person who did it; empty for nobody.
        move: of what was moved; None otherwise.
    """

    time_s: float
    kind: str
    thing: str
    by: str = ""
    move: Move | None = None


class ThingLog:
    """Turns a sequence of truths into events, each told once: of a move, when the thing stands again."""

    def __init__(self) -> None:
        self._watched: dict[str, _Watch] = {}

    def update(self, truth: Truth) -> list[ThingEvent]:
        """Compare with the truths before, and return what is new."""
        found = []
        for thing in truth.things:
            watch = self._watched.setdefault(thing.name, _Watch(thing, truth.time_s))
            event = watch.look(thing, truth.time_s)
            found += [event] if event is not None else []
        return found


class _Watch:
    """Remembers where one thing stood last."""

    def __init__(self, thing: ThingTruth, time_s: float) -> None:
        self._rest = thing
        self._was_there = thing.is_there
        self._moved: ThingTruth | None = None
        self._off_s = self._still_s = time_s

    def look(self, thing: ThingTruth, time_s: float) -> ThingEvent | None:
        if thing.is_there != self._was_there:
            self._was_there = thing.is_there
            self._settle(thing)
            kind = "thing appeared" if thing.is_there else "thing vanished"
            return ThingEvent(time_s=time_s, kind=kind, thing=thing.name, by=thing.moved_by or "")
        if thing.is_moving:
            self._off_s = time_s if self._moved is None else self._off_s
            self._moved, self._still_s = thing, time_s
        elif self._moved is None:
            self._settle(thing)
        else:
            return self._maybe_moved(thing, time_s)
        return None

    def _maybe_moved(self, thing: ThingTruth, time_s: float) -> ThingEvent | None:
        if self._moved is not None and self._moved.is_moving:
            self._moved, self._still_s = thing, time_s
        if time_s < self._still_s + STANDS_S - _SOON_S:
            return None
        move = _move(self._rest, self._off_s, thing, self._still_s)
        self._settle(thing)
        by = thing.moved_by or ""
        return ThingEvent(time_s=time_s, kind="thing moved", thing=thing.name, by=by, move=move)

    def _settle(self, thing: ThingTruth) -> None:
        self._rest, self._moved = thing, None


def _move(before: ThingTruth, from_s: float, after: ThingTruth, to_s: float) -> Move:
    turn = math.remainder(after.heading_rad - before.heading_rad, math.tau)
    return Move(
        from_s=from_s,
        to_s=to_s,
        from_m=_rounded(before.position_m),
        to_m=_rounded(after.position_m),
        distance_m=round(math.dist(before.position_m, after.position_m), 4),
        turned_deg=round(math.degrees(turn), 2),
    )


def _rounded(place: Vector) -> Vector:
    x, y, z = (round(coordinate, 4) for coordinate in place)
    return x, y, z
